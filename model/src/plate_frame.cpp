#include "plate_frame.hpp"

#include "compensated.hpp"

namespace fringe::detail {

PlateFrame plate_frame(const Rectangle& plate) {
  PlateFrame frame;
  frame.corner = plate.corner;
  frame.length_u = plate.edge_u.stableNorm();
  frame.length_v = plate.edge_v.stableNorm();
  const Eigen::Vector3d along_u = plate.edge_u.stableNormalized();
  const Eigen::Vector3d normal = cross(along_u, plate.edge_v.stableNormalized()).normalized();
  frame.axes.row(0) = along_u;
  // From the normal, not from edge_v: the three axes are then orthogonal to rounding whatever the edges' own
  // error.
  frame.axes.row(1) = cross(normal, along_u);
  frame.axes.row(2) = normal;
  return frame;
}

LocalTriangle to_local(const PlateFrame& plate, const Triangle& triangle) {
  return {plate.axes * (triangle[0] - plate.corner), plate.axes * (triangle[1] - plate.corner),
          plate.axes * (triangle[2] - plate.corner)};
}

}  // namespace fringe::detail
