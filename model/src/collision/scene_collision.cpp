#include "fringe/scene_collision.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "collision/bounding_volume.hpp"
#include "collision/convex_pieces.hpp"
#include "collision/convex_shape_data.hpp"
#include "geometry/link_motion.hpp"
#include "geometry/surface_mesh.hpp"

namespace fringe {
namespace {

using detail::BoxTree;
using detail::ConvexPieces;
using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Relative margin of box comparisons: ten times 1e-9, the accuracy to which poses must be rotations.
constexpr double margin_of_boxes = 1e-8;

OrientedBox moved(const OrientedBox& box, const Isometry3d& pose) {
  return {pose * box.centre, box.axes * pose.linear().transpose(), box.half_widths};
}

OrientedBox moved(const AlignedBox3d& box, const Isometry3d& pose) {
  return {pose * box.center(), pose.linear().transpose(), box.sizes() / 2};
}

AlignedBox3d enclosing(const OrientedBox& box) {
  // Relative margin, larger than the rounding errors of the centre and of the sum.
  constexpr double rounding = 1e-14;
  const Vector3d reach = box.axes.cwiseAbs().transpose() * box.half_widths;
  const Vector3d margin = rounding * (box.centre.cwiseAbs() + reach);
  return {box.centre - reach - margin, box.centre + reach + margin};
}

/// Tests whether an object touches one of the link above because the links are joined there.
bool is_joined(const std::vector<Link>& links, const Object& below, const Object& above) {
  return !below.collides_with_parent && below.link && above.link && links[*below.link].parent == above.link;
}

/// An object that can collide with another one.
struct Body {
  std::size_t index;  ///< index of the object in the scene
  Object object;
  BoundingSphere ball = {};                  ///< for a mesh: around its box, in its frame
  std::optional<OrientedBox> own_box = {};   ///< in its frame; a mesh's is computed when needed
  std::optional<ConvexPieces> pieces = {};   ///< computed when needed
  Isometry3d pose = Isometry3d::Identity();  ///< in the world
  OrientedBox box = {};                      ///< in the world, if own_box is known
};

Body body_of(std::size_t index, const Object& object) {
  Body body{index, object};
  if (const Mesh* mesh = std::get_if<Mesh>(&object.shape))
    body.ball = detail::ball_around_box(*mesh);
  else
    body.own_box = detail::enclosing_box(object.shape);
  return body;
}

/// Returns an axis-aligned box around the body in the world: around its oriented box if that is known,
/// otherwise around its ball.
AlignedBox3d enclosing(const Body& body) {
  if (body.own_box)
    return enclosing(body.box);
  return enclosing(OrientedBox{body.pose * body.ball.centre, Eigen::Matrix3d::Identity(),
                               Vector3d::Constant(body.ball.radius)});
}

/// The narrow phase: tests whether two bodies have a point in common by testing the pairs of convex pieces
/// whose boxes overlap. Both bodies must have been divided into pieces.
class NarrowPhase {
 public:
  NarrowPhase(const Body& a, const Body& b, CollisionTests& tests)
      : a_(a), b_(b), pieces_a_(*a.pieces), pieces_b_(*b.pieces), tests_(tests) {}

  bool meet() {
    return !pieces_a_.tree.empty() && !pieces_b_.tree.empty() &&
           (meet_below_roots() || is_within(a_, b_) || is_within(b_, a_));
  }

 private:
  /// Tests the pieces, starting from the roots of both hierarchies.
  bool meet_below_roots() {
    const BoxTree::Node& a = pieces_a_.tree.root();
    const BoxTree::Node& b = pieces_b_.tree.root();
    // The boxes of two single pieces have been compared already.
    return a.is_leaf() && b.is_leaf() ? meet(a, b) : meet_within(a, b);
  }

  /// Tests whether `inner` lies inside `outer`, given that their surfaces do not meet.
  bool is_within(const Body& inner, const Body& outer) {
    if (!outer.pieces->bounds_volume)
      return false;
    ++tests_.narrow;
    const detail::ConvexPiece& piece = inner.pieces->pieces.front();
    const Vector3d point = inner.pose * piece.pose * Vector3d(piece.shape.data().support.centre);
    return detail::is_in_polyhedron(std::get<Mesh>(outer.object.shape).triangles,
                                    outer.pose.inverse(Eigen::Isometry) * point);
  }

  bool meet(const BoxTree::Node& leaf_a, const BoxTree::Node& leaf_b) {
    ++tests_.narrow;
    const detail::ConvexPiece& a = pieces_a_.pieces[pieces_a_.tree.item(leaf_a)];
    const detail::ConvexPiece& b = pieces_b_.pieces[pieces_b_.tree.item(leaf_b)];
    return intersect(a.shape, a_.pose * a.pose, b.shape, b_.pose * b.pose);
  }

  /// Traverses both hierarchies at once, opening the node with the larger box.
  bool meet_within(const BoxTree::Node& a, const BoxTree::Node& b) {
    ++tests_.broad;
    if (!detail::overlap_within(moved(a.box, a_.pose), moved(b.box, b_.pose), margin_of_boxes))
      return false;
    if (a.is_leaf() && b.is_leaf())
      return meet(a, b);
    const bool open_a = b.is_leaf() || (!a.is_leaf() && a.box.diagonal().norm() >= b.box.diagonal().norm());
    if (open_a)
      return meet_within(pieces_a_.tree.left(a), b) || meet_within(pieces_a_.tree.right(a), b);
    return meet_within(a, pieces_b_.tree.left(b)) || meet_within(a, pieces_b_.tree.right(b));
  }

  const Body& a_;
  const Body& b_;
  const ConvexPieces& pieces_a_;
  const ConvexPieces& pieces_b_;
  CollisionTests& tests_;
};

}  // namespace

std::string_view to_string(PairStatus status) {
  switch (status) {
  case PairStatus::clear:
    return "clear";
  case PairStatus::bounds:
    return "bounds";
  case PairStatus::collision:
    break;
  }
  return "collision";
}

bool can_collide(const std::vector<Link>& links, const Object& a, const Object& b) {
  return a.collides && b.collides && (!a.link || a.link != b.link) && !is_joined(links, a, b) &&
         !is_joined(links, b, a);
}

std::vector<ObjectPair> all_pairs(const SceneCollision& answer, const Scene& scene) {
  std::vector<ObjectPair> pairs;
  auto marked = answer.marked.begin();
  for (std::size_t a = 0; a < scene.objects.size(); ++a)
    for (std::size_t b = a + 1; b < scene.objects.size(); ++b) {
      if (!can_collide(scene.links, scene.objects[a], scene.objects[b]))
        continue;
      const bool is_marked = marked != answer.marked.end() && marked->a == a && marked->b == b;
      pairs.push_back(is_marked ? *marked++ : ObjectPair{a, b, PairStatus::clear});
    }
  return pairs;
}

class CollisionDetector::Implementation {
 public:
  Implementation(const Scene& scene, std::shared_ptr<detail::LinkPoses> poses)
      : links_(scene.links), motion_(std::move(poses)) {
    const std::vector<Object>& objects = scene.objects;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const auto is_partner = [&](const Object& other) {
        return &other != &objects[i] && can_collide(links_, objects[i], other);
      };
      if (std::any_of(objects.begin(), objects.end(), is_partner))
        bodies_.push_back(body_of(i, objects[i]));
    }
  }

  void set_pose(std::string_view link, const Isometry3d& pose) { motion_.set_pose(link, pose); }

  const SceneCollision& collide() {
    answer_.tests = {};
    motion_.update();
    const std::vector<std::size_t> moved = move_bodies();
    std::erase_if(marks_,
                  [&](const auto& mark) { return can_have_changed(mark.first.first, mark.first.second); });
    std::vector<bool> done(bodies_.size(), false);
    for (const std::size_t body : moved) {
      look_for_partners(body, tree_.root(), done);
      done[body] = true;
    }
    motion_.settle();
    is_first_ = false;
    write_marks();
    return answer_;
  }

 private:
  std::optional<std::size_t> link_of(std::size_t body) const { return bodies_[body].object.link; }

  /// Tests whether a pair's status may differ from that of the last answer.
  bool can_have_changed(std::size_t a, std::size_t b) const {
    return is_first_ || !motion_.rigid(link_of(a), link_of(b));
  }

  void place(Body& body) {
    body.pose = motion_.world_pose(body.object.link) * body.object.pose;
    if (body.own_box)
      body.box = ::fringe::moved(*body.own_box, body.pose);
  }

  /// Updates the poses and the tree, and returns the bodies that have moved; in the first call, all of them.
  std::vector<std::size_t> move_bodies() {
    std::vector<std::size_t> moved;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (!is_first_ && motion_.rigid(link_of(i), std::nullopt))
        continue;
      place(bodies_[i]);
      moved.push_back(i);
      if (!is_first_)
        tree_.move(i, enclosing(bodies_[i]));
    }
    // Ratio of the tree's cost to that when it was built; beyond it, nodes have grown so large that it is
    // rebuilt.
    constexpr double worth_building_anew = 1.5;
    if (is_first_ || tree_.cost() > worth_building_anew * cost_when_built_)
      build_tree();
    return moved;
  }

  void build_tree() {
    std::vector<AlignedBox3d> boxes;
    boxes.reserve(bodies_.size());
    for (const Body& body : bodies_)
      boxes.push_back(enclosing(body));
    tree_ = BoxTree(boxes);
    cost_when_built_ = tree_.cost();
  }

  /// Descends the tree, and tests the pairs of a body with the bodies below a node that are not done yet.
  void look_for_partners(std::size_t body, const BoxTree::Node& node, const std::vector<bool>& done) {
    ++answer_.tests.broad;
    if (!overlap(tree_.leaf_of(body).box, node.box))
      return;
    if (!node.is_leaf()) {
      look_for_partners(body, tree_.left(node), done);
      look_for_partners(body, tree_.right(node), done);
      return;
    }
    const std::size_t other = tree_.item(node);
    if (other != body && !done[other] && can_have_changed(body, other) &&
        can_collide(links_, bodies_[body].object, bodies_[other].object))
      look_at(std::min(body, other), std::max(body, other));
  }

  /// For two bodies whose boxes in the tree overlap, tests whether their oriented boxes do. Computes a mesh's
  /// oriented box when it is first needed.
  bool oriented_boxes_meet(std::size_t a, std::size_t b) {
    for (const std::size_t index : {a, b}) {
      Body& body = bodies_[index];
      if (body.own_box)
        continue;
      body.own_box = detail::enclosing_box(body.object.shape);
      place(body);
      tree_.move(index, enclosing(body));
      ++answer_.tests.broad;
      if (!overlap(tree_.leaf_of(a).box, tree_.leaf_of(b).box))
        return false;
    }
    ++answer_.tests.broad;
    return detail::overlap_within(bodies_[a].box, bodies_[b].box, margin_of_boxes);
  }

  /// Tests a pair of bodies, and records whether only their boxes or the bodies themselves overlap.
  void look_at(std::size_t a, std::size_t b) {
    if (!oriented_boxes_meet(a, b))
      return;
    for (Body* body : {&bodies_[a], &bodies_[b]})
      if (!body->pieces)
        body->pieces = detail::convex_pieces(body->object.shape);
    const bool meet = NarrowPhase(bodies_[a], bodies_[b], answer_.tests).meet();
    marks_[{a, b}] = meet ? PairStatus::collision : PairStatus::bounds;
  }

  /// Writes the marked pairs into the answer.
  void write_marks() {
    answer_.marked.clear();
    for (const auto& [pair, status] : marks_)
      answer_.marked.push_back({bodies_[pair.first].index, bodies_[pair.second].index, status});
  }

  std::vector<Link> links_;
  detail::LinkMotion motion_;
  std::vector<Body> bodies_;
  BoxTree tree_;  ///< bounding volume hierarchy over the bodies' boxes in the world
  double cost_when_built_ = 0;
  std::map<std::pair<std::size_t, std::size_t>, PairStatus> marks_;  ///< by the indices of the two bodies
  bool is_first_ = true;
  SceneCollision answer_;
};

CollisionDetector::CollisionDetector(const Scene& scene)
    : CollisionDetector(scene, std::make_shared<detail::LinkPoses>(scene.links)) {}
CollisionDetector::CollisionDetector(const Scene& scene, std::shared_ptr<detail::LinkPoses> poses)
    : implementation_(std::make_unique<Implementation>(scene, std::move(poses))) {}
CollisionDetector::~CollisionDetector() = default;
CollisionDetector::CollisionDetector(CollisionDetector&&) noexcept = default;
CollisionDetector& CollisionDetector::operator=(CollisionDetector&&) noexcept = default;

void CollisionDetector::set_pose(std::string_view link, const Isometry3d& pose) {
  implementation_->set_pose(link, pose);
}

const SceneCollision& CollisionDetector::collide() {
  return implementation_->collide();
}

SceneCollision collide(const Scene& scene) {
  return CollisionDetector(scene).collide();
}

}  // namespace fringe
