#include "import/link_tree.hpp"

#include <utility>
#include <variant>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"

namespace fringe::cli {

NodePose split(const Eigen::Affine3d& affine) {
  NodePose pose;
  affine.computeRotationScaling(&pose.rotation, &pose.rest);
  pose.translation = affine.translation();
  return pose;
}

void transform(std::vector<Triangle>& triangles, const Eigen::Matrix3d& matrix) {
  const bool reflected = matrix.determinant() < 0;
  for (Triangle& triangle : triangles) {
    for (Eigen::Vector3d& vertex : triangle)
      vertex = matrix * vertex;
    if (reflected)
      std::swap(triangle[1], triangle[2]);
  }
}

std::vector<Triangle> triangles_in_world(const Scene& scene) {
  const std::vector<Eigen::Isometry3d> poses = world_poses(scene.links);
  std::vector<Triangle> all;
  for (const Object& object : scene.objects)
    for (const Triangle& triangle : std::get<Mesh>(object.shape).triangles)
      all.push_back(transformed(triangle, attachment_pose(poses, object.link) * object.pose));
  return all;
}

std::size_t LinkTree::add_link(const std::string& name, std::optional<std::size_t> parent,
                               const NodePose& pose) {
  const Eigen::Matrix3d above = parent ? rests_[*parent] : Eigen::Matrix3d::Identity();
  Link link{link_names_.take(name), parent};
  link.pose.linear() = pose.rotation;
  link.pose.translation() = above * pose.translation;
  // above·rotation·rest = rotation·(rotationᵀ·above·rotation·rest): the rest of the nodes above moves below
  // the rotation.
  rests_.push_back(above.isIdentity(0) ? pose.rest
                                       : pose.rotation.transpose() * above * pose.rotation * pose.rest);
  scene_.links.push_back(std::move(link));
  return scene_.links.size() - 1;
}

void LinkTree::add_object(const std::string& name, std::size_t link, std::vector<Triangle> triangles) {
  if (triangles.empty())
    return;
  if (!rests_[link].isIdentity(0))
    transform(triangles, rests_[link]);
  scene_.objects.push_back({object_names_.take(name), link, Mesh{{}, 1, std::move(triangles)}});
}

Scene LinkTree::take() {
  if (scene_.objects.empty())
    throw InputError("holds no triangles");
  return std::move(scene_);
}

}  // namespace fringe::cli
