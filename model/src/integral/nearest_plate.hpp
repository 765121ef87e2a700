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

/// Dividing a surface among the plates of a sensor, each point to the plate nearest to it
/// (model/NUMERICS.md, section 10).
namespace fringe::detail {

/// A plate that may be the nearest one somewhere on a fragment.
struct Candidate {
  std::size_t plate;         ///< index among the plates
  std::optional<Cell> cell;  ///< the plate's cell that holds the fragment, once it is cut so that one does
};

/// A triangle, or a part of one, with the plates that may be nearest to some point of it.
struct Fragment {
  Triangle triangle;
  std::vector<Candidate> candidates;
};

/// A fragment counted with its first candidate, although others may be nearer on some of it.
struct Undecided {
  Fragment fragment;
  double gap;  ///< m; ∫dA/min_k d_k over the fragment is at most this much above ∫dA/d of that candidate
};

/// Divides triangles among plates. Every point of a triangle is in the end counted with one plate, so that
/// the sum over the plates k of ∫dA/d_k over shares()[k] is ∫dA/min_k d_k, or less by at most bound().
class NearestPlates {
 public:
  explicit NearestPlates(std::span<const Rectangle> plates);

  /// Divides one triangle with an area among some of the plates.
  void add(const Triangle& triangle, std::span<const std::size_t> plates);

  /// Cuts what is undecided until bound() is at most the tolerance times a lower bound of the integral, or
  /// no more can be gained.
  void refine(double tolerance);

  /// For each plate the fragments counted with it, and those triangles that touch a plate.
  std::vector<std::vector<Triangle>> shares() const;

  /// m; what the sum over the shares is below the integral at most.
  double bound() const;

 private:
  /// Gives a fragment to its only candidate, or cuts it once and settles the parts.
  void settle(Fragment fragment);
  void cut_to_cells(const Fragment& fragment, std::size_t candidate);
  void cut_between_first_two(const Fragment& fragment);
  void leave_undecided(Fragment fragment);

  std::span<const Rectangle> plates_;
  std::vector<PlateFrame> frames_;
  std::vector<std::vector<Triangle>> decided_;
  std::vector<Undecided> undecided_;
  double least_integral_ = 0;  ///< m; ∫dA/min_k d_k over everything added is no less
};

}  // namespace fringe::detail
