#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace fringe::detail {

/// The kind of an edge, by the exponent with which a conductor's charge density grows with the distance from
/// it.
enum class EdgeKind {
  thin,         ///< the edge of a plate: −1/2
  right_angle,  ///< the edge of a box: −1/3
};

/// A flat rectangle that carries charge: the points centre + x·half_u·axis_u + y·half_v·axis_v with x and y
/// in [−1, 1]. The charge per area is Σ c_ij·f_i(x)·f_j(y)/(half_u·half_v).
struct ChargedFace {
  Eigen::Vector3d centre;
  Eigen::Vector3d axis_u;  ///< of length 1, as axis_v, and orthogonal to it
  Eigen::Vector3d axis_v;
  double half_u;
  double half_v;
  EdgeKind edge;
};

/// Returns the corners in their order around the face.
inline std::array<Eigen::Vector3d, 4> corners_of(const ChargedFace& face) {
  const Eigen::Vector3d u = face.half_u * face.axis_u, v = face.half_v * face.axis_v;
  return {face.centre - u - v, face.centre + u - v, face.centre + u + v, face.centre - u + v};
}

constexpr std::size_t box_faces = 6;

/// Returns the faces of a box centred at the origin with its sides along the axes, in the order −x, +x, −y,
/// +y, −z, +z. The directions u and v are y and z on the faces of x, x and z on those of y, x and y on those
/// of z.
std::array<ChargedFace, box_faces> faces_of_box(const Eigen::Vector3d& half_sides);

}  // namespace fringe::detail
