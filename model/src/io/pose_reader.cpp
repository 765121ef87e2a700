#include "io/pose_reader.hpp"

#include <vector>

#include "fringe/pose.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

Eigen::Isometry3d read_quaternion(TableReader& table, const Vector3d& translation) {
  const std::vector<double> wxyz = table.numbers("quaternion", 4);
  const Eigen::Quaterniond quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (quaternion.coeffs().isZero(0))
    table.fail("quaternion", "must not be zero");
  return pose_from_quaternion(quaternion, translation);
}

}  // namespace

Eigen::Isometry3d read_pose(TableReader& table, const Eigen::Isometry3d& otherwise) {
  const Vector3d translation =
      table.has("translation") ? table.position("translation") : Vector3d(otherwise.translation());
  if (table.has("quaternion")) {
    if (table.has("rotation"))
      table.fail("quaternion", "cannot be combined with rotation");
    return read_quaternion(table, translation);
  }
  if (!table.has("rotation")) {
    Eigen::Isometry3d moved = otherwise;
    moved.translation() = translation;
    return moved;
  }
  TableReader rotation = table.table("rotation");
  // Before a key is missed: other forms of a rotation have other keys.
  rotation.allow_only({"axis", "degrees", "quaternion"});
  Eigen::Isometry3d pose;
  if (rotation.has("quaternion")) {
    pose = read_quaternion(rotation, translation);
  } else {
    const Vector3d axis = rotation.nonzero_vector("axis");
    pose = pose_from_axis(axis, rotation.number("degrees"), translation);
  }
  rotation.finish();
  return pose;
}

}  // namespace fringe::detail
