#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/box_tree.hpp"
#include "surface/bodies.hpp"

namespace fringe::detail {

/// The parts of conductors' surfaces that certainly carry no charge, or whose charge another body's surface
/// carries, too (model/BOUNDARY_ELEMENTS.md, section 10). Only surfaces of triangles of the same conductor
/// are considered.
class HiddenSurface {
 public:
  explicit HiddenSurface(const ChargedBodies& bodies);

  /// Returns true if a part of a body's surface may be left out: both its sides are inside closed bodies of
  /// its conductor, or it lies on the surface of an earlier one. Returns false if in doubt.
  bool contains(const Triangle& part, std::size_t body) const;

 private:
  /// A body's surface. Inside is where the winding number of its closed shells is not zero; in a cavity their
  /// orientations cancel.
  struct Body {
    std::vector<Triangle> triangles;
    std::vector<Triangle> closed;
    BoxTree boxes;            ///< of `closed`
    Eigen::AlignedBox3d box;  ///< around `closed`
    bool is_target = false;
    bool is_round = false;  ///< whether parts that are divided move from `triangles` to a round shape
  };
  enum class Place { inside, outside, unknown };

  static Place place(const Triangle& shifted, const Body& body);
  std::array<Place, 2> places(const std::array<Triangle, 2>& sides, std::size_t of, std::size_t body) const;

  std::vector<Body> bodies_;
  std::vector<std::vector<std::size_t>> around_;  ///< for each body those that may hide parts of it
};

}  // namespace fringe::detail
