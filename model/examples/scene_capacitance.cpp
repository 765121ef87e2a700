// The capacitance of a scene file, by several methods.
//
// A scene file (geometries/SCENE.md) lists sensors and objects. For each pair of a sensor and an object the
// model estimates the mutual capacitance: the charge on the grounded object per volt on the sensor. The
// options choose how:
//
//   exact         the thesis' model, ε ∫ dA/d over all triangles, in closed form;
//   split:4       the same integral by splitting each triangle into 4^4 equal ones;
//   auto          the cheaper of reduced method and boundary elements that states an error of 1 %
//                 of what the sensor and each object feel.
//
// Run it:  build/examples/scene_capacitance model/examples/hand.toml
// Expect:  split:4 agrees with exact to 0.01 %, so the integral is right. It is nevertheless 31 %
// below the answer of "auto": the model itself, not its evaluation, is what is inaccurate.
//
// Output:
//   exact         front: 2.6755 pF, 1.629 V at the voltage divider
//   split:4       front: 2.6758 pF, 1.628 V at the voltage divider
//   auto          front: 3.8554 pF, 1.412 V at the voltage divider, answered by boundary-elements

#include <cstdio>
#include <string>

#include "fringe/live_scene.hpp"
#include "fringe/scene_reader.hpp"

namespace {

void print(const char* name, const fringe::Scene& scene) {
  fringe::EvaluationOptions options = fringe::with_method({}, name);
  if (!fringe::is_integral(*options.method))
    options.entries = fringe::Entries::of_sensors;
  const fringe::Evaluation answer = fringe::LiveScene(scene).evaluate(options);
  const std::string chosen = answer.answered_by == name ? "" : ", answered by " + answer.answered_by;
  for (const fringe::SensorCapacitance& sensor : answer.capacitance.sensors)
    std::printf("%-12s  %s: %.4f pF, %.3f V at the voltage divider%s\n", name, sensor.name.c_str(),
                1e12 * sensor.total, sensor.voltage, chosen.c_str());
}

}  // namespace

int main(int count, char** arguments) {
  const fringe::Scene scene = fringe::load_scene(count > 1 ? arguments[1] : "hand.toml");
  for (const char* method : {"exact", "split:4", "auto"})
    print(method, scene);
}
