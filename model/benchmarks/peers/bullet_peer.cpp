#include <memory>

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btConeShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>
#include <LinearMath/btConvexHullComputer.h>

#include "peer.hpp"

namespace fringe::benchmarks {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

btVector3 converted(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

btTransform converted(const Isometry3d& pose) {
  const Eigen::Matrix3d& r = pose.linear();
  return btTransform(
      btMatrix3x3(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)),
      converted(Vector3d(pose.translation())));
}

std::unique_ptr<btConvexShape> made(const PeerShape& shape) {
  std::unique_ptr<btConvexInternalShape> result;
  switch (shape.kind) {
  case PeerShape::Kind::cuboid:
    result = std::make_unique<btBoxShape>(converted(shape.size / 2));
    break;
  case PeerShape::Kind::cylinder:
    result = std::make_unique<btCylinderShapeZ>(btVector3(shape.size[0], shape.size[0], shape.size[1] / 2));
    break;
  case PeerShape::Kind::cone:
    result = std::make_unique<btConeShapeZ>(shape.size[0], shape.size[1]);
    break;
  case PeerShape::Kind::hull: {
    auto hull = std::make_unique<btConvexHullShape>();
    for (const Vector3d& vertex : shape.vertices)
      hull->addPoint(converted(vertex), false);
    hull->recalcLocalAabb();
    result = std::move(hull);
    break;
  }
  }
  result->setMargin(0);
  return result;
}

struct BulletPair {
  const btConvexShape* a;
  const btConvexShape* b;
  btTransform pose_a;
  btTransform pose_b;
};

class BulletPeer : public Peer {
 public:
  BulletPeer(const PeerShapes& shapes, const PeerPairs& pairs) {
    for (const PeerShape& shape : shapes)
      shapes_.push_back(made(shape));
    for (const PeerPair& pair : pairs)
      pairs_.push_back(
          {shapes_[pair.a].get(), shapes_[pair.b].get(), converted(pair.pose_a), converted(pair.pose_b)});
  }

  std::string name() const override { return "Bullet"; }

  std::size_t count_intersecting() const override {
    std::size_t count = 0;
    for (const BulletPair& pair : pairs_) {
      btGjkEpaSolver2::sResults results;
      const btVector3 guess = pair.pose_b.getOrigin() - pair.pose_a.getOrigin();
      count += btGjkEpaSolver2::Distance(pair.a, pair.pose_a, pair.b, pair.pose_b, guess, results) ? 0 : 1;
    }
    return count;
  }

 private:
  std::vector<std::unique_ptr<btConvexShape>> shapes_;
  std::vector<BulletPair> pairs_;
};

}  // namespace

std::unique_ptr<Peer> bullet_peer(const PeerShapes& shapes, const PeerPairs& pairs) {
  return std::make_unique<BulletPeer>(shapes, pairs);
}

HullFaces hull_faces(const std::vector<Vector3d>& points) {
  std::vector<double> coordinates;
  for (const Vector3d& point : points)
    coordinates.insert(coordinates.end(), point.begin(), point.end());
  btConvexHullComputer computer;
  computer.compute(coordinates.data(), 3 * sizeof(double), static_cast<int>(points.size()), 0, 0);
  HullFaces hull;
  for (int i = 0; i < computer.vertices.size(); ++i)
    hull.vertices.emplace_back(computer.vertices[i].x(), computer.vertices[i].y(), computer.vertices[i].z());
  for (int i = 0; i < computer.faces.size(); ++i) {
    std::vector<int>& face = hull.faces.emplace_back();
    const btConvexHullComputer::Edge* const first = &computer.edges[computer.faces[i]];
    const btConvexHullComputer::Edge* edge = first;
    do {
      face.push_back(edge->getSourceVertex());
      edge = edge->getNextEdgeOfFace();
    } while (edge != first);
  }
  return hull;
}

}  // namespace fringe::benchmarks
