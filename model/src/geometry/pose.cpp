#include "fringe/pose.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "fringe/error.hpp"

namespace fringe {
namespace {

Eigen::Isometry3d isometry(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation;
  pose.translation() = translation;
  return pose;
}

/// Normalises a vector without overflow or underflow. Eigen's stableNormalized multiplies the length by the
/// largest component again, which rounds it to zero where numbers are denormal.
template <class Vector>
Vector unit(const Vector& vector) {
  return (vector / vector.cwiseAbs().maxCoeff()).normalized();
}

}  // namespace

Eigen::Isometry3d pose_from_axis(const Eigen::Vector3d& axis, double degrees,
                                 const Eigen::Vector3d& translation) {
  // Whole turns are subtracted in degrees, where this is exact.
  const Eigen::AngleAxisd rotation(std::remainder(degrees, 360.0) * std::numbers::pi / 180,
                                   unit<Eigen::Vector3d>(axis));
  return isometry(rotation.toRotationMatrix(), translation);
}

Eigen::Isometry3d pose_from_quaternion(const Eigen::Quaterniond& quaternion,
                                       const Eigen::Vector3d& translation) {
  Eigen::Quaterniond rotation = quaternion;
  rotation.coeffs() = unit<Eigen::Vector4d>(quaternion.coeffs());
  return isometry(rotation.toRotationMatrix(), translation);
}

Eigen::Isometry3d pose_from_matrix(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  /// Largest deviation of R·Rᵀ from the identity: as much as a rectangle's edges may deviate from a right
  /// angle.
  constexpr double tolerance = 1e-9;
  if (!rotation.allFinite() || !translation.allFinite())
    throw InputError("a pose must be finite");
  const double deviation =
      (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(deviation <= tolerance) || rotation.determinant() < 0)
    throw InputError("the rotation must be an orthonormal, right-handed matrix");
  return isometry(rotation, translation);
}

std::vector<Eigen::Isometry3d> world_poses(const std::vector<Link>& links) {
  std::vector<Eigen::Isometry3d> poses;
  poses.reserve(links.size());
  for (const Link& link : links) {
    Eigen::Isometry3d pose = link.pose;
    for (std::optional<std::size_t> parent = link.parent; parent; parent = links[*parent].parent)
      pose = links[*parent].pose * pose;
    poses.push_back(pose);
  }
  return poses;
}

Eigen::Isometry3d attachment_pose(const std::vector<Eigen::Isometry3d>& link_poses,
                                  std::optional<std::size_t> link) {
  return link ? link_poses[*link] : Eigen::Isometry3d::Identity();
}

std::size_t find_link(const std::vector<Link>& links, std::string_view name) {
  const auto found =
      std::find_if(links.begin(), links.end(), [=](const Link& link) { return link.name == name; });
  if (found == links.end())
    throw InputError(fmt::format("the scene has no link \"{}\"", name));
  return static_cast<std::size_t>(found - links.begin());
}

void set_pose(Scene& scene, std::string_view link_name, const Eigen::Isometry3d& pose) {
  scene.links[find_link(scene.links, link_name)].pose = pose;
}

Rectangle transformed(const Rectangle& rectangle, const Eigen::Isometry3d& pose) {
  return {pose * rectangle.corner, pose.linear() * rectangle.edge_u, pose.linear() * rectangle.edge_v};
}

Triangle transformed(const Triangle& triangle, const Eigen::Isometry3d& pose) {
  return {pose * triangle[0], pose * triangle[1], pose * triangle[2]};
}

}  // namespace fringe
