#include "reduced/node_forces.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::Vector3d;

using RowMajorMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::MatrixX3f coordinates(const NodePoints& points) {
  Eigen::MatrixX3f result(points.count, 3);
  result << Eigen::Map<const Eigen::VectorXf>(points.x, points.count),
      Eigen::Map<const Eigen::VectorXf>(points.y, points.count),
      Eigen::Map<const Eigen::VectorXf>(points.z, points.count);
  return result;
}

}  // namespace

std::vector<Wrench> node_forces(const NodeMatrix& inverse_distances, const ChargedNodes& outer,
                                const ChargedNodes& inner) {
  const Index columns = outer.charges.cols();
  const Eigen::Map<const RowMajorMatrix, 0, Eigen::OuterStride<>> inverse(
      inverse_distances.values, inverse_distances.rows, inverse_distances.columns,
      Eigen::OuterStride<>(whole_blocks(inverse_distances.columns)));
  // The field of charges q at x is Σ q·(x − y)/r³: sums of q/r³ and of q·y/r³ for all rows at once.
  const Eigen::MatrixX3f to = coordinates(outer.points), from = coordinates(inner.points);
  MatrixXf sources(inner.charges.rows(), 4 * columns);
  sources.leftCols(columns) = inner.charges;
  for (Index axis = 0; axis < 3; ++axis)
    sources.middleCols((axis + 1) * columns, columns) =
        inner.charges.array().colwise() * from.col(axis).array();
  const RowMajorMatrix cubes = inverse.array().cube();
  const MatrixXf sums = cubes * sources;

  std::vector<Wrench> result;
  for (Index first = 0; first < columns; first += 2) {
    Eigen::MatrixX3f forces(to.rows(), 3);
    for (Index axis = 0; axis < 3; ++axis) {
      const auto field = [&](Index column) {
        return to.col(axis).array() * sums.col(column).array() -
               sums.col((axis + 1) * columns + column).array();
      };
      forces.col(axis) = outer.charges.col(first).array() * field(first + 1) +
                         outer.charges.col(first + 1).array() * field(first);
    }
    Wrench& wrench = result.emplace_back();
    wrench.force = forces.colwise().sum().cast<double>();
    for (Index axis = 0; axis < 3; ++axis) {
      const Index next = (axis + 1) % 3, last = (axis + 2) % 3;
      wrench.torque[axis] = to.col(next).dot(forces.col(last)) - to.col(last).dot(forces.col(next));
    }
  }
  return result;
}

}  // namespace fringe::detail
