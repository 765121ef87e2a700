#include "bem/single_layer_face_panel.hpp"

#include <algorithm>
#include <vector>

#include "bem/panel_quadrature.hpp"
#include "bem/single_layer_faces.hpp"

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

MatrixXd panel_coupling(const ChargedFace& face, FaceFunctions functions, std::span<const Panel> panels,
                        double tolerance) {
  const Vector3d u = face.half_u * face.axis_u, v = face.half_v * face.axis_v;
  const std::array<Vector3d, 4> corners{face.centre - u - v, face.centre + u - v, face.centre + u + v,
                                        face.centre - u + v};
  // The potential of a smooth charge is smooth beside it, except near its edges.
  const auto distance = [&](const Vector3d& point) {
    double least = segment_distance(point, corners[3], corners[0]);
    for (std::size_t k = 0; k < 3; ++k)
      least = std::min(least, segment_distance(point, corners[k], corners[k + 1]));
    return least;
  };
  std::vector<Vector3d> points;
  std::vector<double> weights;
  std::vector<std::size_t> ends;
  for (const Panel& panel : panels) {
    for_each_point(panel.corners, tolerance, distance, [&](const Vector3d& point, double weight) {
      points.push_back(point);
      weights.push_back(weight);
    });
    ends.push_back(points.size());
  }
  const MatrixXd potentials = face_potentials(face, functions, points, tolerance);
  MatrixXd result = MatrixXd::Zero(functions.count(), static_cast<Index>(panels.size()));
  std::size_t at = 0;
  for (std::size_t panel = 0; panel < panels.size(); ++panel)
    for (; at < ends[panel]; ++at)
      result.col(static_cast<Index>(panel)) += weights[at] * potentials.col(static_cast<Index>(at));
  return result;
}

}  // namespace fringe::detail
