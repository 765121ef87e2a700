#include "integral/exact_integral.hpp"

#include "integral/kernel.hpp"
#include "integral/pieces.hpp"

namespace fringe::detail {

double exact_integral(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area) {
  using Eigen::Vector3d;
  double sum = 0;
  for_each_piece(plate, triangle,
                 [&](Cell cell, const Vector3d& a, const Vector3d& b, const Vector3d& c, double share) {
                   sum += share * kernel_from_plate(from_plate(plate, cell, a), from_plate(plate, cell, b),
                                                    from_plate(plate, cell, c));
                 });
  return twice_area * sum;
}

}  // namespace fringe::detail
