// The Maxwell matrix by boundary elements.
//
// maxwell() solves the electrostatic problem of all conductors: entry (i, j) is the charge on conductor i per
// volt on conductor j while the others are grounded. Every entry comes with an estimate of its error, and
// refinement ends when all estimates are within rtol of their entries. Two quantities of the matrix matter
// for a sensor s and an object o:
//
//   mutual        -M(s, o), which the fast model estimates;
//   delta_self    M(s, s) less its value without the objects, which the sensor's electronics feel.
//
// Run it:  build/examples/boundary_elements model/examples/hand.toml
// Expect:  the answers of the three accuracies agree within their errors, and the errors are within
// rtol.
//
// Output:
//   rtol 1e-02: mutual 3.855 pF, delta_self 2.490 pF, accuracy reached
//   rtol 1e-03: mutual 3.857 pF, delta_self 2.491 pF, accuracy reached
//   rtol 1e-04: mutual 3.857 pF, delta_self 2.491 pF, accuracy reached

#include <cstdio>

#include "fringe/boundary_elements.hpp"
#include "fringe/scene_reader.hpp"

int main(int count, char** arguments) {
  const fringe::Scene scene = fringe::load_scene(count > 1 ? arguments[1] : "hand.toml");
  for (const double rtol : {1e-2, 1e-3, 1e-4}) {
    const fringe::MaxwellMatrix matrix = fringe::maxwell(scene, {.rtol = rtol});
    const double mutual = matrix.mutual(0, 1), error = matrix.errors(0, 1);
    std::printf("rtol %.0e: mutual %.3f pF, delta_self %.3f pF, %s\n", rtol, 1e12 * mutual,
                1e12 * matrix.delta_self(0),
                matrix.reached && error <= rtol * mutual ? "accuracy reached" : "accuracy not reached");
  }
}
