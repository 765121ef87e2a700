#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/joint.hpp"
#include "fringe/rectangle.hpp"
#include "fringe/shape.hpp"

namespace fringe {

/// The medium that fills the space between the conductors.
struct Medium {
  double relative_permittivity = 1.0;
};

/// A node of the tree of links (thesis, appendix A).
struct Link {
  std::string name;
  std::optional<std::size_t> parent;                       ///< index among the links; none: a root
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< from this link's frame to its parent's
  std::optional<Joint> joint = std::nullopt;  ///< what moves it; `pose` is that at the joint's position
};

/// A capacitive sensor: one conductor made of one or more rectangles, read through a voltage divider
/// (thesis 5.3.5).
struct Sensor {
  std::string name;
  std::optional<std::size_t> link;      ///< index among the links; none: the world
  double input_voltage = 2.5;           ///< V
  double coupling_capacitance = 5e-12;  ///< F
  std::vector<Rectangle> plates;        ///< in the link's frame
};

/// A sensor that measures the distance of the closest point in a cone.
struct DistanceSensor {
  std::string name;
  std::optional<std::size_t> link;  ///< index among the links; none: the world
  Eigen::Vector3d apex;             ///< m, in the link's frame
  Eigen::Vector3d direction;        ///< in the link's frame, of any nonzero length
  double full_angle_degrees;        ///< in (0, 180]
  double range;                     ///< m
};

/// A conductor held at the potential of the ground.
struct Grounded {};

/// A conductor without net charge, or with no other than that of a capacitor between it and the ground.
struct Floating {
  double to_ground = 0;  ///< F, the capacitance of that capacitor; 0: insulated
};

/// A conductor that may be driven and sensed, as a sensor may.
struct Electrode {};

/// A body that polarises instead of conducting.
struct Dielectric {
  double relative_permittivity;
};

using ElectricalRole = std::variant<Grounded, Floating, Electrode, Dielectric>;

/// A body that the sensors detect.
struct Object {
  std::string name;
  std::optional<std::size_t> link;  ///< index among the links; none: the world
  Shape shape;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< from the shape's frame to the link's
  ElectricalRole role = Grounded{};
  bool collides = true;
  /// Name of the conductor whose bodies are all objects with this name; none: a conductor of its own. Of a
  /// dielectric object, the sensor whose cover it is.
  std::optional<std::string> conductor = std::nullopt;
  /// Marks an object that comes and goes, so that readings detect it; the other objects belong to the
  /// machine. If no object of a scene is marked, all are targets but electrodes and covers.
  bool target = false;
  /// Asks for collisions with the objects of the parent of its link, which are joined to it and left out
  /// otherwise.
  bool collides_with_parent = false;
};

/// Returns true for the cover of a sensor's plate, a layer of a dielectric. It is never a target.
inline bool is_cover(const Object& object) {
  return std::holds_alternative<Dielectric>(object.role) && object.conductor.has_value();
}

/// A measurement of the electronics: the charge on one conductor while some are driven at 1 V and all others
/// are grounded, but for floating ones.
struct Reading {
  std::string name;
  std::string sense;               ///< the sensor, or the conductor of an electrode, whose charge is measured
  std::vector<std::string> drive;  ///< the sensors and conductors of electrodes at 1 V
  std::optional<double> noise = std::nullopt;  ///< F, one standard deviation
  std::optional<double> threshold =
      std::nullopt;  ///< F of change that is noticed; none: five times the noise
};

/// The contents of a scene file, in the file's order.
struct Scene {
  Medium medium;
  bool has_room = false;  ///< whether grounded walls surround the scene
  std::vector<Link> links;
  std::vector<Sensor> sensors;
  std::vector<DistanceSensor> distance_sensors;
  std::vector<Object> objects;
  std::vector<Reading> readings = {};     ///< none: one for every sensor, which drives and senses it
  std::vector<std::string> changes = {};  ///< what the reader mended, in sentences
};

}  // namespace fringe
