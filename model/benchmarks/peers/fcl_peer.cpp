#include <utility>
#include <variant>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/math/bv/OBB.h>
#include <fcl/narrowphase/detail/gjk_solver_libccd.h>

#include "hull_faces.hpp"
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

}  // namespace fringe::benchmarks
