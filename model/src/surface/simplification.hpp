#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "surface/bodies.hpp"

namespace fringe::detail {

/// Surfaces of many triangles replaced by such of fewer, the coarser the farther they are from all other
/// conductors (model/BOUNDARY_ELEMENTS.md, section 10).
class Simplification {
 public:
  /// Total number of triangles up to which surfaces stay as they are. Their equations are solved in seconds.
  static constexpr std::size_t few_triangles = 5000;

  /// Simplifies the surfaces of a scene that has more than `few_triangles`, as far as its bodies are
  /// conductors with surfaces of triangles. Doubles the tolerance until no more than `most_triangles` are
  /// left, or as few as can be.
  ///
  /// @param tolerance distance between old and new surface, relative to the smallest of the size of the own
  ///   conductor, that of the body times `of_part`, the distance from another conductor and that from
  ///   `others`
  /// @param others boxes around bodies that are no conductors
  /// @param of_part more than 1 where all conductors are there: a small part of one, far from the others, may
  ///   then lose more of its shape
  Simplification(ChargedBodies bodies, double tolerance, std::size_t most_triangles,
                 std::vector<Eigen::AlignedBox3d> others = {}, double of_part = 1);

  /// Leaves all surfaces as they are.
  explicit Simplification(ChargedBodies bodies) : bodies_(std::move(bodies)) {}

  const ChargedBodies& bodies() const { return bodies_; }

  /// Tells whether a surface was replaced.
  bool is_changed() const { return !surfaces_.empty(); }

  /// Returns the number of triangles of all surfaces.
  std::size_t triangles() const;

  /// Tells whether all surfaces that differ lie within their bodies, so that capacitances are bounded from
  /// below.
  bool is_within() const;

  /// Returns the mean distance (m) between the old and the new surface of a body near a point of it.
  double deviation(std::size_t body, const Eigen::Vector3d& point) const;

 private:
  /// Divides a surface by the distance from other conductors: a zone is within half the distance of the next.
  class Zones {
   public:
    Zones(const ChargedBodies& bodies, std::size_t body, std::vector<Eigen::AlignedBox3d> others,
          double of_part);
    static constexpr std::size_t count = 10;
    std::size_t zone(const Eigen::Vector3d& point) const;
    double tolerance(std::size_t zone) const;  ///< relative to 1

   private:
    double size_;
    std::vector<Eigen::AlignedBox3d> others_;
  };

  /// A surface that was replaced; `zones` and `deviations` belong to its body.
  struct Surface {
    std::size_t body;
    Zones zones;
    std::vector<double> deviations;  ///< m, of each zone
  };

  void simplify(const ChargedBodies& original, double tolerance);

  ChargedBodies bodies_;
  std::vector<Eigen::AlignedBox3d> others_;
  double of_part_ = 1;
  std::vector<Surface> surfaces_;
};

}  // namespace fringe::detail
