#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/scene.hpp"

namespace fringe {

namespace detail {
class LinkPoses;
}

/// The relation of two objects of a scene (the marks of thesis chapters 2 and 3).
enum class PairStatus {
  clear,     ///< their bounding boxes do not meet
  bounds,    ///< their bounding boxes meet but they themselves do not: the orange mark
  collision  ///< the objects have a point in common: the red mark
};

/// Returns "clear", "bounds" or "collision".
std::string_view to_string(PairStatus status);

/// Two objects by their index in the scene, the one with the smaller index first.
struct ObjectPair {
  std::size_t a;
  std::size_t b;
  PairStatus status;
};

/// The work done for one answer.
struct CollisionTests {
  std::size_t broad = 0;   ///< tests of two bounding boxes
  std::size_t narrow = 0;  ///< tests of two convex shapes
};

struct SceneCollision {
  CollisionTests tests;
  std::vector<ObjectPair> marked;  ///< all pairs that are not clear, in the order of their indices
};

/// Tests whether two objects on a scene's links are checked for collisions: both have `collides` set, they
/// are not fixed to the same link, and neither is on the link above that of the other, unless the lower one
/// has `collides_with_parent` set. Objects without a link count as separate bodies.
bool can_collide(const std::vector<Link>& links, const Object& a, const Object& b);

/// Returns all pairs of a scene's objects that can collide, clear ones included, in the order of their
/// indices.
std::vector<ObjectPair> all_pairs(const SceneCollision& answer, const Scene& scene);

/// Finds the colliding objects of a scene repeatedly while links move. Only pairs that can have changed are
/// tested, and of those only the ones whose boxes meet in a bounding volume hierarchy over all objects. The
/// data for closer tests of an object is computed when another object first comes close to it, which takes a
/// minute for millions of triangles; an object that cannot collide with any other costs nothing.
///
/// All shapes with `segments` are truly round here, whatever it says, except the inside of arcs: the inside
/// of an arc is flat between its segments. A mesh whose triangles bound a volume includes its inside; any
/// other mesh is its surface only. Between objects whose surfaces are flat the answer is exact for the poses
/// in the world as rounded (fringe/convex_shape.hpp states what holds for round ones). The bounding boxes are
/// oriented ones, the smallest that are known; they count as meeting if they are less than 1e-8 of their size
/// and distance apart.
class CollisionDetector {
 public:
  explicit CollisionDetector(const Scene& scene);
  /// Prepares the scene for a LiveScene, which owns the poses.
  CollisionDetector(const Scene& scene, std::shared_ptr<detail::LinkPoses> poses);
  ~CollisionDetector();
  CollisionDetector(CollisionDetector&&) noexcept;
  CollisionDetector& operator=(CollisionDetector&&) noexcept;
  CollisionDetector(const CollisionDetector&) = delete;
  CollisionDetector& operator=(const CollisionDetector&) = delete;

  /// Replaces a link's pose relative to its parent.
  /// @throws InputError when no link has the name.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose);

  /// Computes the answer for the current poses; valid until the next call. Its tests are the work of this
  /// call.
  const SceneCollision& collide();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Finds the collisions of a scene as it is.
SceneCollision collide(const Scene& scene);

}  // namespace fringe
