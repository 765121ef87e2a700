#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fringe/scene.hpp"
#include "unique_names.hpp"

namespace fringe::cli {

/// The pose p ↦ rotation·rest·p + translation of a node, where `rest` is the scaling and shear that a rigid
/// link cannot have.
struct NodePose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d rest = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

/// Splits an affine transformation into rotation, rest and translation.
NodePose split(const Eigen::Affine3d& affine);

/// Multiplies all vertices by a matrix. A reflection also reverses the order of the vertices, so that
/// triangles keep their outward side.
void transform(std::vector<Triangle>& triangles, const Eigen::Matrix3d& matrix);

/// Returns the triangles of all meshes of a scene in the frame of the world.
std::vector<Triangle> triangles_in_world(const Scene& scene);

/// Makes the links of a scene of the nodes of a model. Links are rigid: scaling and shear of a node are
/// applied to the meshes of the node and of all nodes below it.
class LinkTree {
 public:
  /// Appends a link below `parent` and returns its index. A name that is taken gets a number.
  std::size_t add_link(const std::string& name, std::optional<std::size_t> parent, const NodePose& pose);

  /// Appends the triangles of a node as an object on its link; nothing if there are none.
  void add_object(const std::string& name, std::size_t link, std::vector<Triangle> triangles);

  const std::string& name_of(std::size_t link) const { return scene_.links[link].name; }

  /// Returns the scene; throws InputError if it has no objects.
  Scene take();

 private:
  Scene scene_;
  std::vector<Eigen::Matrix3d> rests_;
  UniqueNames link_names_;
  UniqueNames object_names_;
};

}  // namespace fringe::cli
