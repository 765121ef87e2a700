#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fringe/method.hpp"
#include "fringe/scene.hpp"

namespace fringe {

/// Permittivity of empty space in F/m (CODATA 2018, 8.854 187 8128(13)e-12).
constexpr double vacuum_permittivity = 8.8541878128e-12;

/// The rule by which the plates of one sensor count a point of a surface.
enum class PlateRule {
  sum,     ///< each plate counts every point (thesis 5.3, read literally)
  nearest  ///< only the plate nearest to a point counts it: ∫dA/min_k d_k
};

/// The rule that selects the faces that count for a plate.
enum class FaceRule {
  all,  ///< every triangle (thesis 5.3.4)
  /// The triangles from whose outward side some point of the plate is seen, and those in contact. Of a shape
  /// without thickness, Plate, Disc and Polygon, the side counts that faces.
  facing
};

/// Returns the rule by which the triangles of a shape count: all of them for one of which some side always
/// faces, so that each of its points counts once.
FaceRule rule_for(const Shape& shape, FaceRule rule);

/// Returns the rule's name.
std::string to_string(PlateRule rule);
std::string to_string(FaceRule rule);

/// The contribution of one object to a sensor's capacitance.
struct ObjectCapacitance {
  std::string name;
  double capacitance;  ///< F; +infinity on contact. Estimates the charge on the grounded object per volt on
                       ///< the sensor.
  double bound;        ///< F; largest amount that the evaluation omitted on purpose. 0: nothing.
  bool skipped;        ///< whether the object was not integrated at all
  std::string answered_by = {};  ///< the method
  /// F; what the method states of the difference from the true capacitance. None: it states nothing, as the
  /// triangle integrals and the formula, except of contact, which is certain: 0.
  std::optional<double> error = {};
};

/// The capacitance and output of one sensor.
struct SensorCapacitance {
  std::string name;
  double total;          ///< F, the sum over the objects
  double voltage;        ///< V, the divider's output; 0 on contact
  double delta_voltage;  ///< V, the output without any object minus this output
  bool contact;          ///< the total is infinite: an object touches the sensor
  std::vector<ObjectCapacitance> objects;
};

/// The work done for an answer, summed over the sensors and their plates.
struct EvaluationCounts {
  std::size_t triangles_evaluated = 0;  ///< pairs of a triangle, or a part of one, and a plate
  std::size_t triangles_lumped = 0;     ///< pairs that were counted together with their neighbours
  std::size_t triangles_skipped = 0;    ///< pairs left out
  std::size_t triangles_reused = 0;     ///< pairs whose value was known
  std::size_t nodes_lumped = 0;         ///< groups of neighbours that were counted together
  std::size_t objects_evaluated = 0;    ///< pairs of an object and a sensor
  std::size_t objects_skipped = 0;      ///< pairs left out
  std::size_t objects_reused = 0;       ///< pairs whose value was known

  EvaluationCounts& operator+=(const EvaluationCounts& other);
};

/// The capacitance of every sensor of a scene, in the scene's order.
struct SceneCapacitance {
  std::vector<SensorCapacitance> sensors;
  EvaluationCounts counts;
};

/// Returns the output of the voltage divider (thesis 5.3.5): C_c/(C_c + total)·input_voltage, 0 for an
/// infinite total.
double divider_voltage(const Sensor& sensor, double total);

}  // namespace fringe
