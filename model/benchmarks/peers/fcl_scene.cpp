#include "fcl_scene.hpp"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/narrowphase/collision.h>

namespace fringe::benchmarks {
namespace {

std::shared_ptr<fcl::CollisionGeometryd> made(const PeerShape& shape) {
  switch (shape.kind) {
  case PeerShape::Kind::cylinder:
    return std::make_shared<fcl::Cylinderd>(shape.size[0], shape.size[1]);
  case PeerShape::Kind::cone:
    return std::make_shared<fcl::Coned>(shape.size[0], shape.size[1]);
  default:
    return std::make_shared<fcl::Boxd>(shape.size);
  }
}

bool count_pair(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* count) {
  const fcl::CollisionRequestd request;
  fcl::CollisionResultd result;
  if (fcl::collide(a, b, request, result) > 0)
    ++*static_cast<std::size_t*>(count);
  return false;
}

}  // namespace

class FclScene::Implementation {
 public:
  explicit Implementation(const PeerShapes& shapes) {
    for (const PeerShape& shape : shapes) {
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(made(shape)));
      manager_.registerObject(objects_.back().get());
    }
    manager_.setup();
  }

  std::size_t collide(const std::vector<Eigen::Isometry3d>& poses) {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      objects_[i]->setTransform(poses[i]);
      objects_[i]->computeAABB();
    }
    manager_.update();
    std::size_t count = 0;
    manager_.collide(&count, count_pair);
    return count;
  }

 private:
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  fcl::DynamicAABBTreeCollisionManagerd manager_;
};

FclScene::FclScene(const PeerShapes& shapes) : implementation_(std::make_unique<Implementation>(shapes)) {}
FclScene::~FclScene() = default;

std::size_t FclScene::collide(const std::vector<Eigen::Isometry3d>& poses) {
  return implementation_->collide(poses);
}

}  // namespace fringe::benchmarks
