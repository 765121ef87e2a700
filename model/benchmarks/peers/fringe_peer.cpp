#include <utility>
#include <vector>

#include "fringe/bounding_volume.hpp"
#include "fringe/convex_shape.hpp"
#include "fringe/gjk.hpp"
#include "peer.hpp"

namespace fringe::benchmarks {
namespace {

ConvexShape made(const PeerShape& shape) {
  switch (shape.kind) {
  case PeerShape::Kind::cuboid:
    return ConvexShape::cuboid(shape.size);
  case PeerShape::Kind::cylinder:
    return ConvexShape::cylinder(shape.size[0], shape.size[1]);
  case PeerShape::Kind::cone:
    return ConvexShape::cone(shape.size[0], shape.size[1]);
  case PeerShape::Kind::hull:
    break;
  }
  return ConvexShape::hull(shape.vertices);
}

template <auto Meet>
class FringePeer : public Peer {
 public:
  FringePeer(const PeerShapes& shapes, PeerPairs pairs) : pairs_(std::move(pairs)) {
    for (const PeerShape& shape : shapes)
      shapes_.push_back(made(shape));
  }

  std::string name() const override { return "fringe"; }

  std::size_t count_intersecting() const override {
    std::size_t count = 0;
    for (const PeerPair& pair : pairs_)
      count += Meet(shapes_[pair.a], pair.pose_a, shapes_[pair.b], pair.pose_b) ? 1 : 0;
    return count;
  }

 private:
  std::vector<ConvexShape> shapes_;
  PeerPairs pairs_;
};

bool at_no_distance(const ConvexShape& a, const Eigen::Isometry3d& pose_a, const ConvexShape& b,
                    const Eigen::Isometry3d& pose_b) {
  return gjk_distance(a, pose_a, b, pose_b).distance == 0;
}

/// Distances of hulls that are given by their vertices, without preparation.
class FringeVertexPeer : public Peer {
 public:
  FringeVertexPeer(const PeerShapes& shapes, const PeerPairs& pairs) {
    const auto moved = [](std::vector<Eigen::Vector3d> vertices, const Eigen::Isometry3d& pose) {
      for (Eigen::Vector3d& vertex : vertices)
        vertex = pose * vertex;
      return vertices;
    };
    for (const PeerPair& pair : pairs)
      hulls_.emplace_back(moved(shapes[pair.a].vertices, pair.pose_a),
                          moved(shapes[pair.b].vertices, pair.pose_b));
  }

  std::string name() const override { return "fringe"; }

  std::size_t count_intersecting() const override {
    std::size_t count = 0;
    for (const auto& [a, b] : hulls_)
      count += gjk_distance(a, b).distance == 0 ? 1 : 0;
    return count;
  }

 private:
  std::vector<std::pair<std::vector<Eigen::Vector3d>, std::vector<Eigen::Vector3d>>> hulls_;
};

class FringeBoxPeer : public Peer {
 public:
  FringeBoxPeer(const PeerShapes& shapes, const PeerPairs& pairs) {
    const auto box = [&](std::size_t shape, const Eigen::Isometry3d& pose) {
      return OrientedBox{pose.translation(), pose.linear().transpose(), shapes[shape].size / 2};
    };
    for (const PeerPair& pair : pairs)
      boxes_.emplace_back(box(pair.a, pair.pose_a), box(pair.b, pair.pose_b));
  }

  std::string name() const override { return "fringe"; }

  std::size_t count_intersecting() const override {
    std::size_t count = 0;
    for (const auto& [a, b] : boxes_)
      count += overlap(a, b) ? 1 : 0;
    return count;
  }

 private:
  std::vector<std::pair<OrientedBox, OrientedBox>> boxes_;
};

}  // namespace

std::unique_ptr<Peer> fringe_box_peer(const PeerShapes& shapes, const PeerPairs& pairs) {
  return std::make_unique<FringeBoxPeer>(shapes, pairs);
}

std::unique_ptr<Peer> fringe_peer(const PeerShapes& shapes, const PeerPairs& pairs) {
  return std::make_unique<FringePeer<intersect>>(shapes, pairs);
}

std::unique_ptr<Peer> fringe_vertex_distance_peer(const PeerShapes& shapes, const PeerPairs& pairs) {
  return std::make_unique<FringeVertexPeer>(shapes, pairs);
}

std::unique_ptr<Peer> fringe_distance_peer(const PeerShapes& shapes, const PeerPairs& pairs) {
  return std::make_unique<FringePeer<at_no_distance>>(shapes, pairs);
}

}  // namespace fringe::benchmarks
