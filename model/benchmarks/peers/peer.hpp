#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

/// The same queries answered by other libraries, each called as its documentation shows for two convex
/// shapes, with everything prepared in advance that the library allows.
namespace fringe::benchmarks {

/// A shape that every library supports.
struct PeerShape {
  enum class Kind { cuboid, cylinder, cone, hull } kind;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< cuboid: its sides; cylinder and cone: radius, height
  std::vector<Eigen::Vector3d> vertices{};         ///< of a hull; a cuboid may have them, too
};

/// Two shapes, given by their indices, and their poses.
struct PeerPair {
  std::size_t a;
  std::size_t b;
  Eigen::Isometry3d pose_a;
  Eigen::Isometry3d pose_b;
};

/// A library, or one of its methods, with the shapes and pairs converted to its own types.
class Peer {
 public:
  Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  virtual ~Peer() = default;

  virtual std::string name() const = 0;

  /// Counts the pairs that intersect.
  virtual std::size_t count_intersecting() const = 0;
};

using PeerShapes = std::vector<PeerShape>;
using PeerPairs = std::vector<PeerPair>;

std::unique_ptr<Peer> fringe_peer(const PeerShapes& shapes, const PeerPairs& pairs);
/// Computes shortest distances; pairs at distance 0 count as intersecting.
std::unique_ptr<Peer> fringe_distance_peer(const PeerShapes& shapes, const PeerPairs& pairs);
/// Computes the same of hulls, whose vertices are moved in advance.
std::unique_ptr<Peer> fringe_vertex_distance_peer(const PeerShapes& shapes, const PeerPairs& pairs);
/// Tests oriented boxes by their separating axes alone; all shapes must be cuboids.
std::unique_ptr<Peer> fringe_box_peer(const PeerShapes& shapes, const PeerPairs& pairs);
std::unique_ptr<Peer> fcl_box_peer(const PeerShapes& shapes, const PeerPairs& pairs);

std::unique_ptr<Peer> fcl_peer(const PeerShapes& shapes, const PeerPairs& pairs);
std::unique_ptr<Peer> libccd_gjk_peer(const PeerShapes& shapes, const PeerPairs& pairs);
std::unique_ptr<Peer> libccd_mpr_peer(const PeerShapes& shapes, const PeerPairs& pairs);
std::unique_ptr<Peer> bullet_peer(const PeerShapes& shapes, const PeerPairs& pairs);

/// The surface of a convex hull.
struct HullFaces {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::vector<int>> faces;  ///< indices of vertices, anticlockwise from outside
};

/// Computes the hull by Bullet's hull computer; FCL needs the faces of a convex shape and cannot compute
/// them.
HullFaces hull_faces(const std::vector<Eigen::Vector3d>& points);

/// Moving objects in FCL's dynamic tree of axis-aligned boxes, with FCL's solver for pairs.
class FclScene {
 public:
  explicit FclScene(const PeerShapes& shapes);
  ~FclScene();
  FclScene(const FclScene&) = delete;
  FclScene& operator=(const FclScene&) = delete;

  /// Moves all objects and counts the pairs that collide.
  std::size_t collide(const std::vector<Eigen::Isometry3d>& poses);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace fringe::benchmarks
