#include <cstdio>

#include "fringe/evaluation.hpp"
#include "fringe/scene_reader.hpp"
#include "fringe/version.hpp"

/// Prints the version and what the first sensor of a scene feels, in farad.
int main(int, char** arguments) {
  const fringe::Scene scene = fringe::load_scene(arguments[1]);
  std::printf("%s %.17g\n", fringe::version(), fringe::capacitance(scene).sensors.at(0).total);
}
