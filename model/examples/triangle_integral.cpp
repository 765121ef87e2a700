// The integral of one triangle.
//
// The model of the thesis adds, for every triangle T of a grounded object, the capacitance ε ∫_T dA/d, where
// d is the shortest distance from a point of the triangle to the sensor's plate. This program evaluates the
// integral for one triangle that starts above a square plate and ends beside it, by the three methods of the
// library:
//
//   exact     the closed form, accurate to rounding;
//   split:N   the thesis' own method: 4^N equal triangles, each with the distance of its centroid;
//   gauss:K   a product Gauss rule of K x K points.
//
// Run it:  build/examples/triangle_integral
// Expect:  each level of splitting divides the error by about four. Gauss rules converge slowly,
// because the triangle crosses the border above the plate's edge, where the distance has a kink.
//
// Output:
//   capacitance of the triangle: 0.9055 pF
//   split:4   relative error 8.9e-05
//   split:5   relative error 2.2e-05
//   split:6   relative error 5.5e-06
//   gauss:4   relative error 9.4e-05
//   gauss:8   relative error 2.4e-05
//   gauss:16  relative error 3.7e-06

#include <cmath>
#include <cstdio>

#include "fringe/capacitance.hpp"
#include "fringe/plate_integral.hpp"

int main() {
  // Lengths are in metres. The plate is the points corner + a edge_u + b edge_v, with a and b from 0 to 1.
  const fringe::Rectangle plate{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}};
  const fringe::Triangle triangle{{{0.05, 0.02, 0.03}, {0.16, 0.04, 0.03}, {0.06, 0.09, 0.05}}};

  const double exact = fringe::plate_integral(triangle, plate);
  std::printf("capacitance of the triangle: %.4f pF\n", 1e12 * fringe::vacuum_permittivity * exact);

  for (const char* name : {"split:4", "split:5", "split:6", "gauss:4", "gauss:8", "gauss:16"}) {
    const double approximate = fringe::plate_integral(triangle, plate, fringe::parse_method(name));
    std::printf("%-8s  relative error %.1e\n", name, std::abs(approximate / exact - 1));
  }
}
