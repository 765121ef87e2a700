#include "surface/face.hpp"

namespace fringe::detail {

std::array<ChargedFace, box_faces> faces_of_box(const Eigen::Vector3d& half_sides) {
  std::array<ChargedFace, box_faces> faces;
  for (std::size_t k = 0; k < box_faces; ++k) {
    const auto axis = static_cast<Eigen::Index>(k / 2);
    const Eigen::Index u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    faces[k] = {(k % 2 == 0 ? -half_sides[axis] : half_sides[axis]) * Eigen::Vector3d::Unit(axis),
                Eigen::Vector3d::Unit(u),
                Eigen::Vector3d::Unit(v),
                half_sides[u],
                half_sides[v],
                EdgeKind::right_angle};
  }
  return faces;
}

}  // namespace fringe::detail
