#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "formula/charged_surface.hpp"
#include "fringe/evaluation.hpp"
#include "fringe/reading_answer.hpp"
#include "fringe/scene.hpp"
#include "geometry/link_motion.hpp"
#include "integral/surface_integral.hpp"

namespace fringe {

/// Evaluates every sensor of a scene repeatedly while links move.
///
/// Only what can have changed is evaluated: a sensor and an object that have not moved relative to each other
/// keep their value. With a tolerance, an object whose contribution is within the tolerance is estimated from
/// its bounding sphere alone, and from the second answer on the others are integrated by a SurfaceTree, which
/// is built when first needed.
class SceneEvaluator {
 public:
  /// Prepares the scene.
  ///
  /// @throws InputError for the scenes that capacitance() refuses.
  explicit SceneEvaluator(const Scene& scene, const EvaluationOptions& options = {});
  /// Prepares the scene for a LiveScene, which owns the poses.
  SceneEvaluator(const Scene& scene, const EvaluationOptions& options,
                 const std::shared_ptr<detail::LinkPoses>& poses);
  /// Replaces a link's pose relative to its parent.
  /// @throws InputError when no link has the name.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose) { motion_.set_pose(link, pose); }

  /// Computes the answer for the current poses; valid until the next call. Its counts are the work of this
  /// call.
  const SceneCapacitance& capacitance();

  /// Computes the derivatives of an object's capacitance to a sensor as the object moves and the sensor
  /// stays, for the poses of the last capacitance(): in F/m along the world's axes, and in F/rad about those
  /// through the world's origin. For a sensor that moves and an object that stays they have the opposite
  /// sign. All are NaN in contact. Sensor and object are given by their places in the answer. A tolerance
  /// does not apply: every triangle that counts is integrated.
  /// @throws InputError for options other than the method exact without a correction.
  PoseDerivatives derivatives(std::size_t sensor, std::size_t object);

 private:
  /// A sensor's plates in the world.
  struct PlacedSensor {
    std::vector<Rectangle> plates;
    std::vector<detail::PlateFrame> frames;
  };

  /// An object's surface and its pose.
  struct PlacedObject {
    std::optional<std::size_t> link;
    Eigen::Isometry3d on_link;
    detail::Surface surface;
    FaceRule faces;
    Eigen::Isometry3d to_world = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d from_world = Eigen::Isometry3d::Identity();
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  };

  /// The cached integral of one sensor and one object.
  struct Pair {
    detail::Enclosure enclosure;
    detail::SurfaceIntegral integral;
    std::optional<detail::Wrench> wrench = std::nullopt;  ///< of the integral, in the object's frame
    bool known = false;
  };

  /// Moves a sensor's plates into the world. Throws InputError for an invalid plate.
  static PlacedSensor placed(const Sensor& sensor, const Eigen::Isometry3d& pose);

  /// Takes up the sensors and objects of a scene, all of which have capacitances.
  void prepare(const Scene& scene, const EvaluationOptions& options);
  bool has_moved(std::optional<std::size_t> link) const;
  /// Updates the world poses of the sensors and objects that moved.
  void place();
  /// Sets in_object_frame_ to plates in the frame of an object.
  void place_in_frame_of(const PlacedObject& object, std::span<const Rectangle> plates);
  /// Tells whether groups of triangles may be lumped and objects replaced by their enclosures.
  bool lumps() const { return options_.tolerance > 0 && options_.plates == PlateRule::sum; }
  void evaluate(std::size_t sensor);
  /// Returns the absolute error allowed for each object. Half of the tolerance applies to each object's own
  /// integral. The other half, taken of a lower bound of the total, is divided equally among the objects, so
  /// that the many that hardly matter need no accuracy of their own.
  double allowance_per_object(std::span<const Pair> pairs) const;
  /// Computes the integral of one pair, or keeps the known value if it is accurate enough, or estimates it
  /// by the object's enclosure.
  void integrate(Pair& pair, PlacedObject& object, std::span<const Rectangle> plates, double allowance);
  /// Computes the formula's value of one pair, or keeps the known one.
  void combine(Pair& pair, std::size_t sensor, std::size_t object);
  /// Writes the results of one sensor into the answer.
  void tell(std::size_t sensor, std::span<const Pair> pairs);

  detail::IntegralOptions options_;
  double permittivity_;
  detail::LinkMotion motion_;
  std::vector<Sensor> sensors_;
  std::vector<PlacedSensor> placed_sensors_;
  std::vector<PlacedObject> objects_;
  // The formula alone has charged surfaces; for triangle integrals there are none.
  std::vector<detail::ChargedSurface> charged_sensors_;  ///< in the frames of their links
  std::vector<detail::ChargedSurface> charged_objects_;  ///< in their own frames
  std::vector<Pair> pairs_;  ///< those of the first sensor with every object, then those of the second
  std::vector<Rectangle> in_object_frame_;
  SceneCapacitance answer_;
  std::size_t answers_ = 0;
};

}  // namespace fringe
