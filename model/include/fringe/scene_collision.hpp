#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/scene.hpp"

namespace fringe {

/// How two objects of a scene stand to each other (the marks of thesis chapters 2 and 3).
enum class PairStatus {
  clear,     ///< not even their bounding boxes meet
  bounds,    ///< their bounding boxes meet, they themselves do not: the orange mark
  collision  ///< they have a point in common: the red mark
};

/// "clear", "bounds" or "collision".
std::string_view to_string(PairStatus status);

/// Two objects by their index in the scene, the one with the smaller index first.
struct ObjectPair {
  std::size_t a;
  std::size_t b;
  PairStatus status;
};

/// The work of one answer.
struct CollisionTests {
  std::size_t broad = 0;   ///< of two bounding boxes
  std::size_t narrow = 0;  ///< of two convex shapes
};

struct SceneCollision {
  CollisionTests tests;
  std::vector<ObjectPair> marked;  ///< all pairs that are not clear, in the order of their indices
};

/// Whether two objects of a scene are looked at for collisions: both collide, and they are not fixed to the
/// same link. Objects without a link are each on their own.
bool can_collide(const Object& a, const Object& b);

/// All pairs of a scene's objects that can collide, clear ones included, in the order of their indices.
std::vector<ObjectPair> all_pairs(const SceneCollision& answer, const Scene& scene);

/// Which objects of a scene collide, answered again and again while links move. Only pairs that can have
/// changed are looked at, and of those only the ones whose boxes in a tree over all objects meet. What
/// it takes to look closer is found when something comes close for the first time, which for millions of
/// triangles takes a minute; an object that none can collide with costs nothing.
///
/// Cylinders, cones, spheres and the outside of arcs are truly round here, whatever `segments` says; the
/// inside of an arc is flat between its segments. Of a mesh whose triangles bound a volume
/// the inside belongs to it; any other is its surface. Where all surfaces are flat the answer is exact for
/// the poses in the world, rounded as they are (fringe/convex_shape.hpp says what holds for round ones). The
/// bounding boxes are oriented ones, the smallest that are known; they meet when they are less than 1e-8 of
/// their size and distance apart.
class CollisionDetector {
 public:
  explicit CollisionDetector(const Scene& scene);
  ~CollisionDetector();
  CollisionDetector(CollisionDetector&&) noexcept;
  CollisionDetector& operator=(CollisionDetector&&) noexcept;
  CollisionDetector(const CollisionDetector&) = delete;
  CollisionDetector& operator=(const CollisionDetector&) = delete;

  /// Replaces a link's pose relative to its parent.
  /// @throws InputError when no link has the name.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose);

  /// The answer for the poses as they are; valid until the next call. Its tests are the work of this call.
  const SceneCollision& collide();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The answer for a scene as it is.
SceneCollision collide(const Scene& scene);

}  // namespace fringe
