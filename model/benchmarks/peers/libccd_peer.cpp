#include <cmath>
#include <utility>

#include <ccd/ccd.h>

#include "peer.hpp"

namespace fringe::benchmarks {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// The argument of the library's callbacks, which must apply the pose themselves.
struct Placed {
  const PeerShape* shape;
  const Isometry3d* pose;
};

Vector3d farthest(const PeerShape& shape, const Vector3d& d) {
  const double half = shape.size[1] / 2;
  switch (shape.kind) {
  case PeerShape::Kind::cuboid:
    return {std::copysign(shape.size.x() / 2, d.x()), std::copysign(shape.size.y() / 2, d.y()),
            std::copysign(shape.size.z() / 2, d.z())};
  case PeerShape::Kind::cylinder:
  case PeerShape::Kind::cone: {
    const double length = std::sqrt(d.x() * d.x() + d.y() * d.y());
    const double scale = length > 0 ? shape.size[0] / length : 0;
    if (shape.kind == PeerShape::Kind::cylinder)
      return {d.x() * scale, d.y() * scale, std::copysign(half, d.z())};
    if (half * d.z() > scale * length * length - half * d.z())
      return {0, 0, half};
    return {d.x() * scale, d.y() * scale, -half};
  }
  case PeerShape::Kind::hull:
    break;
  }
  const Vector3d* best = shape.vertices.data();
  double largest = best->dot(d);
  for (const Vector3d& vertex : shape.vertices) {
    const double product = vertex.dot(d);
    if (product > largest) {
      largest = product;
      best = &vertex;
    }
  }
  return *best;
}

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const auto& placed = *static_cast<const Placed*>(object);
  const Vector3d d = placed.pose->linear().transpose() * Vector3d(direction->v);
  const Vector3d p = *placed.pose * farthest(*placed.shape, d);
  ccdVec3Set(point, p.x(), p.y(), p.z());
}

void centre(const void* object, ccd_vec3_t* point) {
  const Vector3d p = static_cast<const Placed*>(object)->pose->translation();
  ccdVec3Set(point, p.x(), p.y(), p.z());
}

class LibccdPeer : public Peer {
 public:
  LibccdPeer(bool mpr, PeerShapes shapes, PeerPairs pairs)
      : mpr_(mpr), shapes_(std::move(shapes)), pairs_(std::move(pairs)) {
    // The library's documentation sets these four; its example uses a hundred iterations.
    CCD_INIT(&settings_);
    settings_.support1 = settings_.support2 = support;
    settings_.center1 = settings_.center2 = centre;
    settings_.max_iterations = 100;
  }

  std::string name() const override { return mpr_ ? "libccd MPR" : "libccd GJK"; }

  std::size_t count_intersecting() const override {
    std::size_t count = 0;
    for (const PeerPair& pair : pairs_) {
      const Placed a{&shapes_[pair.a], &pair.pose_a}, b{&shapes_[pair.b], &pair.pose_b};
      count += (mpr_ ? ccdMPRIntersect(&a, &b, &settings_) : ccdGJKIntersect(&a, &b, &settings_)) != 0;
    }
    return count;
  }

 private:
  bool mpr_;
  PeerShapes shapes_;
  PeerPairs pairs_;
  ccd_t settings_{};
};

}  // namespace

std::unique_ptr<Peer> libccd_gjk_peer(const PeerShapes& shapes, const PeerPairs& pairs) {
  return std::make_unique<LibccdPeer>(false, shapes, pairs);
}

std::unique_ptr<Peer> libccd_mpr_peer(const PeerShapes& shapes, const PeerPairs& pairs) {
  return std::make_unique<LibccdPeer>(true, shapes, pairs);
}

}  // namespace fringe::benchmarks
