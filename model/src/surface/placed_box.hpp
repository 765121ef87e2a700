#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "surface/bodies.hpp"

/// Boxes around bodies, and how near others come to them: parts of surfaces are the finer the nearer they are
/// to what is sensed or driven (model/CORRECTIONS.md, section 8).
namespace fringe::detail {

/// Returns the aligned box around a moved one.
Eigen::AlignedBox3d moved_box(const Eigen::AlignedBox3d& box, const Eigen::Isometry3d& pose);

/// A box around a body, along the sides of its first triangle.
struct PlacedBox {
  Eigen::Isometry3d to_box;  ///< to the frame in which the box is aligned
  Eigen::AlignedBox3d box;

  double distance(const Eigen::Vector3d& point) const { return box.exteriorDistance(to_box * point); }

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.to_box, self.box);
  }
};

/// Returns the box around some triangles.
PlacedBox placed_box(std::span<const Triangle> triangles);

/// Returns boxes around the sensed and driven bodies.
std::vector<PlacedBox> boxes_of_used(const ChargedBodies& bodies,
                                     const std::vector<ChargedReading>& readings);

/// Returns the size of a part of the machine relative to its distance from what is sensed and driven.
double relative_size(const Eigen::AlignedBox3d& part, const std::vector<PlacedBox>& used);

/// Where bodies come near boxes of others.
struct Approach {
  std::vector<PlacedBox> boxes;          ///< in a frame of their own
  std::vector<Eigen::Isometry3d> poses;  ///< from the frame of the bodies to that of the boxes

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.boxes, self.poses);
  }

  /// Returns the size of a part of the bodies relative to its distance, the largest one in the poses.
  double relative_size(const Eigen::AlignedBox3d& part) const;
};

}  // namespace fringe::detail
