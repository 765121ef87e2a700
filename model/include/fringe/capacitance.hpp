#pragma once

#include <string>
#include <vector>

#include "fringe/method.hpp"
#include "fringe/scene.hpp"

namespace fringe {

/// Permittivity of empty space in F/m (CODATA 2018, 8.854 187 8128(13)e-12).
constexpr double vacuum_permittivity = 8.8541878128e-12;

struct CapacitanceOptions {
  Method method = Exact{};
};

/// What one object adds to a sensor.
struct ObjectCapacitance {
  std::string name;
  double capacitance;  ///< F; +infinity on contact. Estimates the charge on the grounded object per volt on
                       ///< the sensor.
  double bound;        ///< F; what the evaluation left out on purpose, at most. 0: nothing was.
  bool skipped;        ///< whether the object was left out altogether
};

/// What one sensor feels.
struct SensorCapacitance {
  std::string name;
  double total;          ///< F, the sum over the objects
  double voltage;        ///< V, the divider's output; 0 on contact
  double delta_voltage;  ///< V, the output without any object minus the output
  bool contact;          ///< the total is infinite: an object touches the sensor
  std::vector<ObjectCapacitance> objects;
};

/// The triangle-integral model (thesis 5.3): for each sensor and object ε₀·ε_r·Σ∫dA/d over the sensor's
/// plates and the object's triangles, and the voltage that the sum leaves (thesis 5.3.5). Throws InputError
/// when an object is not a grounded conductor: the model knows no other.
std::vector<SensorCapacitance> capacitance(const Scene& scene, const CapacitanceOptions& options = {});

/// The output of the voltage divider (thesis 5.3.5): C_c/(C_c + total)·input_voltage, 0 for an infinite
/// total.
double divider_voltage(const Sensor& sensor, double total);

}  // namespace fringe
