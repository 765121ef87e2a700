#include "reduced/charge_skeleton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "bem/panel_mesh.hpp"
#include "geometry/winding_number.hpp"
#include "numeric/interruption.hpp"
#include "reduced/outside_charges.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::RowVectorXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// A skeleton has at most so many nodes, which are chosen among so many.
constexpr Index most_skeleton_nodes = 600;
constexpr std::size_t most_candidates = 2000;

/// Returns the points on all panels.
std::vector<Vector3d> points_of(const PanelClusters& panels, int fineness) {
  const auto& [x, y, z] = panels.points[static_cast<std::size_t>(fineness)];
  std::vector<Vector3d> result;
  for (std::size_t k = 0; k < x.size(); ++k)
    result.emplace_back(x[k], y[k], z[k]);
  return result;
}

/// Points all around a body at the same distance from its panels. What is harmonic beyond and vanishes far
/// away is largest there.
class SurroundingPoints {
 public:
  SurroundingPoints(const ChargedPanels& body, std::span<const TriangleSurface> surfaces, double distance) {
    /// Distance between the points, relative to that from the panels, and their largest number.
    constexpr double apart = 0.2;
    constexpr std::size_t most = 2000;
    std::vector<Vector3d> points =
        spread_out(candidates(body.panels, distance, apart * distance), apart * distance, most);
    for (const TriangleSurface& surface : surfaces)
      if (is_closed(surface.triangles))
        std::erase_if(points,
                      [&](const Vector3d& point) { return is_in_polyhedron(surface.triangles, point); });
    count_ = static_cast<std::ptrdiff_t>(points.size());
    /// Coordinate of padding points.
    constexpr double far_away = 1e12;
    points.resize(static_cast<std::size_t>(whole_blocks(count_)), Vector3d::Constant(far_away));
    for (const Vector3d& point : points)
      for (std::size_t axis = 0; axis < 3; ++axis)
        coordinates_[axis].push_back(static_cast<float>(point[static_cast<Index>(axis)]));
  }

  Index count() const { return count_; }

  /// Returns the potentials at the points (rows) of unit charges at all places, spread over so many
  /// quarterings of their panels.
  MatrixXf potentials(const PanelClusters& panels, int fineness) const {
    const NodePoints points{coordinates_[0].data(), coordinates_[1].data(), coordinates_[2].data(), count_};
    MatrixXf result = MatrixXf::Zero(count_, static_cast<Index>(panels.panels.size()));
    MatrixXf block;
    for (const PanelCluster& cluster : panels.clusters) {
      check_interruption();
      const MeshPart part{&cluster, fineness};
      block.resize(whole_blocks(count_), part.count());
      best_kernels<NodeKernels>().fill(part.points(panels), points, block.data());
      for (std::ptrdiff_t repeat = 0; repeat < part.repeats(); ++repeat)
        result.middleCols(cluster.first, cluster.count) +=
            block.middleCols(repeat * cluster.count, cluster.count).topRows(count_) /
            static_cast<float>(part.repeats());
    }
    return result;
  }

 private:
  /// Returns points at a distance from the panels: those of a grid that are a little farther, moved towards
  /// the nearest point of the panels.
  static std::vector<Vector3d> candidates(const PanelClusters& panels, double distance, double apart) {
    /// Largest number of points on the panels and, about, of the grid.
    constexpr std::size_t most_on_panels = 2500;
    constexpr double most_in_grid = 5e4;
    const std::vector<Vector3d> on_panels =
        spread_out(points_of(panels, PanelClusters::finest), apart / 2, most_on_panels);
    Eigen::Matrix3Xf all(3, index_of(on_panels.size()));
    Eigen::AlignedBox3d box;
    for (std::size_t k = 0; k < on_panels.size(); ++k) {
      all.col(index_of(k)) = on_panels[k].cast<float>();
      box.extend(on_panels[k]);
    }
    box.min().array() -= distance + apart;
    box.max().array() += distance + apart;
    const double step = std::max(apart, std::cbrt(box.volume() / most_in_grid));
    std::vector<Vector3d> result;
    for (double x = box.min().x(); x < box.max().x(); x += step)
      for (double y = box.min().y(); y < box.max().y(); y += step) {
        check_interruption();
        for (double z = box.min().z(); z < box.max().z(); z += step) {
          Index nearest = 0;
          const Vector3d point(x, y, z);
          (all.colwise() - point.cast<float>()).colwise().squaredNorm().minCoeff(&nearest);
          const Vector3d& from = on_panels[static_cast<std::size_t>(nearest)];
          const Vector3d towards = point - from;
          const double away = towards.norm();
          if (away >= distance && away < distance + 2 * step)
            result.emplace_back(from + distance / away * towards);
        }
      }
    return result;
  }

  std::array<std::vector<float>, 3> coordinates_;
  std::ptrdiff_t count_ = 0;
};

/// The potentials of a body's functions (columns) around it, and of unit charges in its panels' centres.
struct Seen {
  SurroundingPoints points;
  MatrixXd functions;
};

Seen seen_at(const ChargedPanels& body, std::ptrdiff_t functions, std::span<const TriangleSurface> surfaces,
             double distance) {
  SurroundingPoints points(body, surfaces, distance);
  /// Distance beyond which four points on each panel suffice.
  constexpr double far_distance = 0.6;
  const MatrixXf potentials = points.potentials(body.panels, distance < far_distance ? 2 : 1);
  const auto charges =
      Eigen::Map<const MatrixXf>(body.charges.data(), body.places(), static_cast<Index>(functions));
  return {std::move(points), (potentials * charges).cast<double>()};
}

/// Returns points in whole blocks, the last one repeated, as the panels of one cluster.
PanelClusters one_cluster(std::vector<Vector3d> points) {
  PanelClusters result;
  const std::size_t count = points.size(), padded = static_cast<std::size_t>(whole_blocks(index_of(count)));
  points.resize(padded, points.back());
  for (std::size_t k = 0; k < padded; ++k) {
    result.panels.push_back(std::min(k, count - 1));
    result.is_repeated.push_back(k >= count);
    for (std::size_t axis = 0; axis < 3; ++axis)
      result.points[0][axis].push_back(static_cast<float>(points[k][static_cast<Index>(axis)]));
  }
  result.clusters.push_back({0, index_of(padded), Vector3d::Zero(), 0, 0, {}});
  return result;
}

/// Every so many points around the body are not fitted: they tell the error.
constexpr Index told_every = 4;

/// Returns twice the root mean square of the errors of a skeleton's potentials around a body, relative to the
/// potentials of charges of unit energy.
double error_of(const ChargeSkeleton& skeleton, const Seen& seen) {
  constexpr double safety = 2;
  const auto charges = Eigen::Map<const MatrixXf>(skeleton.nodes.charges.data(), skeleton.nodes.places(),
                                                  seen.functions.cols());
  const MatrixXd found = (seen.points.potentials(skeleton.nodes.panels, 0) * charges).cast<double>();
  const MatrixXd& wanted = seen.functions;
  double squares = 0;
  Index count = 0;
  for (Index row = told_every - 1; row < wanted.rows(); row += told_every, ++count)
    squares += (found.row(row) - wanted.row(row)).squaredNorm() / wanted.row(row).squaredNorm();
  return count > 0 ? safety * std::sqrt(squares / static_cast<double>(count))
                   : std::numeric_limits<double>::infinity();
}

/// Chooses points for charges one by one, each the one that lets the charges come nearest to the functions'
/// potentials (orthogonal matching pursuit). Stops at a root mean square error, relative to the potentials,
/// or at so many points. Columns of `seen_charges`: the potentials of a unit charge in each point.
std::vector<Index> chosen_points(const MatrixXd& seen_charges, const MatrixXd& wanted, double error,
                                 Index most) {
  /// Squared distance of a charge's potentials from the span of the chosen ones, relative to their own
  /// square, below which single precision does not tell them apart.
  constexpr double least_new = 1e-12;
  const Index rows = seen_charges.rows();
  MatrixXd basis(rows, most);
  Eigen::VectorXd squares = seen_charges.colwise().squaredNorm();
  const Eigen::VectorXd first_squares = squares;
  MatrixXd products = seen_charges.transpose() * wanted;
  double left = wanted.squaredNorm();
  std::vector<Index> chosen;
  while (index_of(chosen.size()) < most && left > error * error * static_cast<double>(rows)) {
    check_interruption();
    Index next = 0;
    const double gain = (squares.array() > least_new * first_squares.array())
                            .select(products.rowwise().squaredNorm().array() / squares.array(), 0)
                            .maxCoeff(&next);
    if (!(gain > 0))
      break;
    const auto before = basis.leftCols(index_of(chosen.size()));
    Eigen::VectorXd direction = seen_charges.col(next);
    for (int pass = 0; pass < 2; ++pass)
      direction -= before * (before.transpose() * direction);
    direction.normalize();
    const Eigen::VectorXd along = seen_charges.transpose() * direction;
    const Eigen::RowVectorXd part = direction.transpose() * wanted;
    squares -= along.cwiseAbs2();
    squares[next] = 0;
    products -= along * part;
    left -= part.squaredNorm();
    basis.col(index_of(chosen.size())) = direction;
    chosen.push_back(next);
  }
  return chosen;
}

/// Finds charges in as few points as have an error of at most `accuracy`.
std::optional<ChargeSkeleton> fitted_skeleton(const std::vector<Vector3d>& candidates, const Seen& seen,
                                              double accuracy) {
  std::vector<Index> fitted;
  for (Index row = 0; row < seen.functions.rows(); ++row)
    if (row % told_every != told_every - 1)
      fitted.push_back(row);
  const Index rows = index_of(fitted.size()), functions = seen.functions.cols();
  const MatrixXd wanted = seen.functions(fitted, Eigen::all);
  const VectorXd scale = wanted.rowwise().norm().cwiseInverse();
  const MatrixXd seen_charges =
      scale.asDiagonal() *
      seen.points.potentials(one_cluster(candidates), 0)(fitted, Eigen::seqN(0, index_of(candidates.size())))
          .cast<double>();
  /// Parts of the accuracy to which the sampled values are fitted, at most and at least: between them the
  /// error is larger.
  constexpr double fitted_part = 0.26, first_part = 0.45;
  // More points would let the charges fit the sampled values, and not the potential between the samples.
  const Index most = std::min({index_of(candidates.size()), rows / 2, most_skeleton_nodes});
  const std::vector<Index> chosen =
      chosen_points(seen_charges, scale.asDiagonal() * wanted, fitted_part * accuracy, most);
  if (chosen.empty())
    return std::nullopt;
  /// Rounding of single precision, some times of it: the charges are such that both, the errors that they
  /// leave and their own rounding, are small.
  constexpr double rounding = 5e-6;
  const Index all = index_of(chosen.size());
  MatrixXd equations = MatrixXd::Zero(rows + all, all), right_sides = MatrixXd::Zero(rows + all, functions);
  equations.topRows(rows) = seen_charges(Eigen::all, chosen);
  for (Index k = 0; k < all; ++k)
    equations(rows + k, k) = rounding * equations.col(k).norm();
  right_sides.topRows(rows) = scale.asDiagonal() * wanted;
  const Eigen::HouseholderQR<MatrixXd> factors(equations);
  const MatrixXd parts = factors.householderQ().adjoint() * right_sides;
  std::vector<Vector3d> points;
  points.reserve(chosen.size());
  for (const Index k : chosen)
    points.push_back(candidates[static_cast<std::size_t>(k)]);
  double left = parts.squaredNorm();
  for (Index count = 0; count < all;) {
    const Index next = std::min(count + node_block, all);
    left -= parts.middleRows(count, next - count).squaredNorm();
    count = next;
    if (std::sqrt(std::max(left, 0.0) / static_cast<double>(rows)) > first_part * accuracy)
      continue;
    ChargeSkeleton skeleton{{one_cluster({points.begin(), points.begin() + count}), {}}, 0};
    MatrixXf charges = MatrixXf::Zero(skeleton.nodes.places(), functions + 1);
    charges.topLeftCorner(count, functions) = factors.matrixQR()
                                                  .topLeftCorner(count, count)
                                                  .triangularView<Eigen::Upper>()
                                                  .solve(parts.topRows(count))
                                                  .cast<float>();
    skeleton.nodes.charges.assign(charges.data(), charges.data() + charges.size());
    skeleton.error = error_of(skeleton, seen);
    if (skeleton.error <= accuracy)
      return skeleton;
  }
  return std::nullopt;
}

}  // namespace

std::optional<ChargeSkeleton> charge_skeleton(const ChargedPanels& body, std::ptrdiff_t functions,
                                              std::span<const TriangleSurface> surfaces, double distance,
                                              double accuracy) {
  const std::vector<Vector3d> candidates = spread_out(points_of(body.panels, 0), 0, most_candidates);
  return fitted_skeleton(candidates, seen_at(body, functions, surfaces, distance), accuracy);
}

}  // namespace fringe::detail
