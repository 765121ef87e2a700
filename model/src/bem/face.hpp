#pragma once

#include <array>

#include <Eigen/Core>

#include "bem/jacobi_basis.hpp"

namespace fringe::detail {

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

/// The numbers of functions that a face has along its two directions.
struct FaceFunctions {
  int u;
  int v;
  int count() const { return u * v; }
  bool operator==(const FaceFunctions&) const = default;
};

}  // namespace fringe::detail
