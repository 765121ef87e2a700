#include <utility>
#include <variant>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/math/bv/OBB.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/detail/gjk_solver_libccd.h>

#include "peer.hpp"

namespace fringe::benchmarks {
namespace {

using FclShape = std::variant<fcl::Boxd, fcl::Cylinderd, fcl::Coned, fcl::Convexd>;

FclShape made(const PeerShape& shape) {
  switch (shape.kind) {
  case PeerShape::Kind::cuboid:
    return fcl::Boxd(shape.size);
  case PeerShape::Kind::cylinder:
    return fcl::Cylinderd(shape.size[0], shape.size[1]);
  case PeerShape::Kind::cone:
    return fcl::Coned(shape.size[0], shape.size[1]);
  case PeerShape::Kind::hull:
    break;
  }
  const HullFaces hull = hull_faces(shape.vertices);
  auto faces = std::make_shared<std::vector<int>>();
  for (const std::vector<int>& face : hull.faces) {
    faces->push_back(static_cast<int>(face.size()));
    faces->insert(faces->end(), face.begin(), face.end());
  }
  return fcl::Convexd(std::make_shared<const std::vector<Eigen::Vector3d>>(hull.vertices),
                      static_cast<int>(hull.faces.size()), faces);
}

class FclPeer : public Peer {
 public:
  FclPeer(const PeerShapes& shapes, PeerPairs pairs) : pairs_(std::move(pairs)) {
    for (const PeerShape& shape : shapes)
      shapes_.push_back(made(shape));
  }

  std::string name() const override { return "FCL"; }

  std::size_t count_intersecting() const override {
    std::size_t count = 0;
    for (const PeerPair& pair : pairs_)
      count += std::visit(
          [&](const auto& a, const auto& b) {
            return solver_.shapeIntersect(a, pair.pose_a, b, pair.pose_b, nullptr) ? 1U : 0U;
          },
          shapes_[pair.a], shapes_[pair.b]);
    return count;
  }

 private:
  std::vector<FclShape> shapes_;
  PeerPairs pairs_;
  fcl::detail::GJKSolver_libccd<double> solver_;
};

class FclBoxPeer : public Peer {
 public:
  FclBoxPeer(const PeerShapes& shapes, const PeerPairs& pairs) {
    const auto box = [&](std::size_t shape, const Eigen::Isometry3d& pose) {
      return fcl::OBBd(pose.linear(), pose.translation(), shapes[shape].size / 2);
    };
    for (const PeerPair& pair : pairs)
      boxes_.emplace_back(box(pair.a, pair.pose_a), box(pair.b, pair.pose_b));
  }

  std::string name() const override { return "FCL"; }

  std::size_t count_intersecting() const override {
    std::size_t count = 0;
    for (const auto& [a, b] : boxes_)
      count += a.overlap(b) ? 1 : 0;
    return count;
  }

 private:
  std::vector<std::pair<fcl::OBBd, fcl::OBBd>> boxes_;
};

}  // namespace

std::unique_ptr<Peer> fcl_box_peer(const PeerShapes& shapes, const PeerPairs& pairs) {
  return std::make_unique<FclBoxPeer>(shapes, pairs);
}

std::unique_ptr<Peer> fcl_peer(const PeerShapes& shapes, const PeerPairs& pairs) {
  return std::make_unique<FclPeer>(shapes, pairs);
}

namespace {

std::shared_ptr<fcl::CollisionGeometryd> geometry_of(const PeerShape& shape) {
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
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(geometry_of(shape)));
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
