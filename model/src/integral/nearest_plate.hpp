#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"
#include "geometry/clipping.hpp"
#include "geometry/plate_frame.hpp"

/// Division of a surface among the plates of a sensor: each point belongs to the plate nearest to it
/// (model/NUMERICS.md, section 10).
namespace fringe::detail {

/// A plate that may be nearest to some point of a fragment.
struct Candidate {
  std::size_t plate;         ///< index among the plates
  std::optional<Cell> cell;  ///< the plate's cell that contains the fragment, once it is cut
};

/// A triangle, or a part of one, with all plates that may be nearest to some point of it.
struct Fragment {
  Triangle triangle;
  std::vector<Candidate> candidates;
};

/// A fragment assigned to its first candidate, although other plates may be nearer on part of it.
struct Undecided {
  Fragment fragment;
  double gap;  ///< m; upper bound of ∫dA/min_k d_k − ∫dA/d of the first candidate, over the fragment
};

/// Divides triangles among plates. In the end every point of a triangle is assigned to one plate, so that the
/// sum over the plates k of ∫dA/d_k over shares()[k] equals ∫dA/min_k d_k, or falls below it by at most
/// bound().
class NearestPlates {
 public:
  explicit NearestPlates(std::span<const Rectangle> plates);

  /// Divides one triangle of positive area among the given plates.
  void add(const Triangle& triangle, std::span<const std::size_t> plates);

  /// Bisects undecided fragments until bound() is at most the tolerance times a lower bound of the integral,
  /// or until rounding prevents further progress.
  void refine(double tolerance);

  /// Returns, for each plate, the fragments assigned to it and the triangles that touch it.
  std::vector<std::vector<Triangle>> shares() const;

  /// Returns, in m, an upper bound of how far the sum over the shares falls below the integral.
  double bound() const;

 private:
  /// Assigns a fragment to its only candidate, or cuts it once and settles the parts.
  void settle(Fragment fragment);
  /// Cuts a fragment at the border planes of one candidate's plate and settles the parts.
  void cut_to_cells(const Fragment& fragment, std::size_t candidate);
  /// Cuts off the parts of a fragment on which the nearer of its first two candidates is certain and settles
  /// them. The remaining strip stays undecided.
  void cut_between_first_two(const Fragment& fragment);
  /// Records a fragment as undecided, with the bound of the error of assigning it to its first candidate.
  void leave_undecided(Fragment fragment);

  std::span<const Rectangle> plates_;
  std::vector<PlateFrame> frames_;
  std::vector<std::vector<Triangle>> decided_;
  std::vector<Undecided> undecided_;
  double least_integral_ = 0;  ///< m; lower bound of ∫dA/min_k d_k over all triangles added
};

}  // namespace fringe::detail
