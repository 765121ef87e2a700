#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/link_motion.hpp"
#include "reduced/node_pair.hpp"
#include "reduced/reduced_capacitance.hpp"
#include "reduced/rigid_bodies.hpp"
#include "surface/bodies.hpp"
#include "surface/contact.hpp"

namespace fringe::detail {

/// The rigid bodies of a scene whose links move: which bodies are joined, where they are, and how far from
/// each other. Bodies in contact at one potential are joined into one rigid body as long as they keep their
/// relative pose.
class Arrangement {
 public:
  /// Prepares the bodies; energies of those of triangles are within `accuracy`. Dielectric bodies are
  /// prepared with the conductor on their link that they touch, else by themselves. Throws InputError as
  /// bodies_on_links and rigid_bodies do, and for a dielectric body that touches several conductors.
  Arrangement(const Scene& scene, ReducedContacts contacts, double accuracy,
              std::shared_ptr<LinkPoses> poses);

  void set_pose(std::string_view link, const Eigen::Isometry3d& pose) { motion_.set_pose(link, pose); }

  /// Moves the bodies to the current poses, and joins them anew where contacts have changed. Throws
  /// InputError for contact between bodies that may not be joined.
  void update();

  /// Forgets all moves so far.
  void settle();

  /// Counts how often bodies were joined anew. Everything below belongs to the last time.
  std::size_t joinings() const { return joinings_; }

  /// Returns the conductors and their bodies, on their links; capacitances to the ground are in units of
  /// unit().
  const ChargedBodies& bodies() const { return bodies_; }

  /// Returns the rigid bodies, those of the sensors first, targets last; scales are in units of unit().
  const std::vector<RigidBody>& rigid() const { return rigid_; }

  /// Returns the number of rigid bodies that are not targets: they come first. None if a target is joined
  /// with a body that is none, so that they are one rigid body.
  std::optional<std::size_t> machine_bodies() const { return machine_bodies_; }

  /// Returns the unit of length, in metres.
  double unit() const { return unit_; }

  /// Returns whether two rigid bodies moved relative to each other since settle().
  bool has_moved(std::size_t a, std::size_t b) const {
    return !is_settled_ || !motion_.rigid(link(a), link(b));
  }

  /// Returns true if dielectric bodies touch a plate of a sensor.
  bool covers_sensors() const;

  const PlacedBody& placed(std::size_t body) const { return placed_[body]; }

  /// Returns the link that carries a rigid body: that of its first part, or of its dielectric bodies.
  std::optional<std::size_t> link(std::size_t body) const {
    const RigidBody& rigid = rigid_[body];
    return rigid.parts.empty() ? insulators_[rigid.insulators.front()].link
                               : on_links_.bodies[rigid.parts.front()].link;
  }

  /// Returns the poses of the links, as of the last update().
  const LinkPoses& poses() const { return motion_.poses(); }

  /// Returns a lower bound of the distance between two rigid bodies.
  double gap(std::size_t a, std::size_t b) const { return gaps_[pair(a, b)]; }

  /// Returns the smoothness on a body's faces that another body leaves.
  const BodySmoothness& smoothness(std::size_t body, std::size_t other) const {
    return smoothness_[pair(body, other)];
  }

 private:
  std::size_t pair(std::size_t a, std::size_t b) const { return a * rigid_.size() + b; }
  Eigen::Isometry3d relative_pose(std::size_t part, std::size_t first) const;
  bool may_join(std::size_t a, std::size_t b) const;
  ChargedBody in_world(std::size_t body) const;
  std::vector<Contact> contacts() const;
  bool joins_hold() const;
  void join();
  bool place();
  bool must_be_joined(std::size_t a, std::size_t b) const;
  ChargedBody insulator_in_world(std::size_t insulator) const;
  void refuse_contact_of_insulators(std::size_t a, std::size_t b) const;
  std::vector<BodyGroup> groups(const std::vector<Contact>& contacts) const;

  ReducedContacts allowed_;
  double accuracy_;
  LinkMotion motion_;
  std::vector<Object> objects_;
  ChargedBodies on_links_;  ///< none of them joined
  std::vector<LinkedInsulator> insulators_;
  SharedShapes shapes_;

  std::size_t joinings_ = 0;
  ChargedBodies bodies_;
  std::vector<RigidBody> rigid_;
  std::optional<std::size_t> machine_bodies_;
  std::vector<std::vector<Eigen::Isometry3d>> joined_at_;  ///< poses of the rigid bodies' parts to the first
  double unit_ = 1;
  std::vector<PlacedBody> placed_;
  std::vector<double> gaps_;
  std::vector<BodySmoothness> smoothness_;
  bool is_settled_ = false;  ///< false if bodies were joined since settle()
};

}  // namespace fringe::detail
