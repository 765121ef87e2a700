#include "reduced/charge_skeleton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "bem/panel_mesh.hpp"
#include "geometry/surface_mesh.hpp"
#include "numeric/interruption.hpp"
#include "reduced/outside_charges.hpp"
#include "simd/dispatch.hpp"
#include "surface/panel.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::Vector3d;

/// A skeleton has at most so many nodes.
constexpr Index most_skeleton_nodes = 8000;

/// Points that share the charges of places: panels, or nodes.
struct SharedPoints {
  std::vector<Vector3d> points;
  std::vector<Index> places;   ///< of every point
  std::vector<double> shares;  ///< part of the place's charge
  double ratio = 0;  ///< largest radius of the parts of panels that points stand for, over the distance
};

/// Returns points on all panels which are so fine that at a distance they have the panels' potentials.
SharedPoints fine_points(const PanelClusters& panels, double distance) {
  /// Ratio of a part's radius to the distance that is aimed at; it grows by a factor until there are at most
  /// so many points.
  constexpr double aim = 0.05, growth = 1.2;
  constexpr std::size_t most_points = 80'000;
  struct Source {
    Triangle triangle;
    double radius;
    Index place;
  };
  std::vector<Source> sources;
  for (const PanelCluster& cluster : panels.clusters)
    for (std::ptrdiff_t place = cluster.first; place < cluster.first + cluster.count; ++place) {
      if (panels.is_repeated[static_cast<std::size_t>(place)])
        continue;
      const auto at = [&](std::size_t fineness, std::ptrdiff_t k) {
        const auto& [x, y, z] = panels.points[fineness];
        const auto index = static_cast<std::size_t>(k);
        return Vector3d(x[index], y[index], z[index]);
      };
      const Vector3d centre = at(0, place);
      Source source{{}, 0, place};
      // The centre of the quarter at a corner is half way from the centre to the corner.
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const Vector3d to_corner =
            2 *
            (at(1, 4 * cluster.first + index_of(corner) * cluster.count + place - cluster.first) - centre);
        source.triangle[corner] = centre + to_corner;
        source.radius = std::max(source.radius, to_corner.norm());
      }
      sources.push_back(source);
    }
  const auto quarterings = [&](const Source& source, double ratio) {
    return std::max(static_cast<int>(std::ceil(std::log2(source.radius / (ratio * distance)))), 1);
  };
  double ratio = aim;
  const auto count = [&] {
    std::size_t sum = 0;
    for (const Source& source : sources)
      sum += std::size_t{1} << (2 * quarterings(source, ratio));
    return sum;
  };
  while (count() > std::max(most_points, 4 * sources.size()))
    ratio *= growth;
  SharedPoints result;
  for (const Source& source : sources) {
    const int times = quarterings(source, ratio);
    const std::size_t parts = std::size_t{1} << (2 * times);
    add_centres_of_parts(source.triangle, times, result.points);
    result.places.insert(result.places.end(), parts, source.place);
    result.shares.insert(result.shares.end(), parts, 1 / static_cast<double>(parts));
    result.ratio = std::max(result.ratio, source.radius / (1 << times) / distance);
  }
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

  /// Returns the potentials at the points (rows) of unit charges at so many places.
  MatrixXf potentials(const SharedPoints& charges, Index places) const {
    constexpr std::size_t at_once = 512;
    const NodePoints here{coordinates_[0].data(), coordinates_[1].data(), coordinates_[2].data(), count_};
    MatrixXf result = MatrixXf::Zero(count_, places), block(whole_blocks(count_), index_of(at_once));
    std::array<std::vector<float>, 3> from;
    for (std::size_t first = 0; first < charges.points.size(); first += at_once) {
      check_interruption();
      const std::size_t count = std::min(at_once, charges.points.size() - first);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        from[axis].clear();
        for (std::size_t k = first; k < first + count; ++k)
          from[axis].push_back(static_cast<float>(charges.points[k][static_cast<Index>(axis)]));
      }
      best_kernels<NodeKernels>().fill({from[0].data(), from[1].data(), from[2].data(), index_of(count)},
                                       here, block.data());
      for (std::size_t k = 0; k < count; ++k)
        result.col(charges.places[first + k]) +=
            static_cast<float>(charges.shares[first + k]) * block.col(index_of(k)).head(count_);
    }
    return result;
  }

 private:
  /// Returns points at a distance from the panels: those of a grid that are a little farther, moved towards
  /// the nearest point of the panels.
  static std::vector<Vector3d> candidates(const PanelClusters& panels, double distance, double apart) {
    /// Largest number of the grid's points, about.
    constexpr double most_in_grid = 5e4;
    Eigen::AlignedBox3d box;
    const auto& [on_x, on_y, on_z] = panels.points[PanelClusters::finest];
    for (std::size_t k = 0; k < on_x.size(); ++k)
      box.extend(Vector3d(on_x[k], on_y[k], on_z[k]));
    box.min().array() -= distance + apart;
    box.max().array() += distance + apart;
    const double step = std::max(apart, std::cbrt(box.volume() / most_in_grid));
    std::vector<Vector3d> result;
    for (double x = box.min().x(); x < box.max().x(); x += step)
      for (double y = box.min().y(); y < box.max().y(); y += step) {
        check_interruption();
        for (double z = box.min().z(); z < box.max().z(); z += step) {
          const Vector3d point(x, y, z);
          const Vector3d towards = point - nearest(panels, point, distance + 2 * step);
          const double away = towards.norm();
          if (away >= distance && away < distance + 2 * step)
            result.emplace_back(point - towards + distance / away * towards);
        }
      }
    return result;
  }

  /// Returns the point on the panels that is nearest to a point, if it is nearer than a distance.
  static Vector3d nearest(const PanelClusters& panels, const Vector3d& point, double distance) {
    double least = distance * distance;
    Vector3d result = Vector3d::Constant(std::numeric_limits<double>::infinity());
    for (const PanelCluster& cluster : panels.clusters) {
      if ((cluster.centre - point).norm() - cluster.radius > std::sqrt(least))
        continue;
      const MeshPart part{&cluster, PanelClusters::finest};
      const NodePoints on_panels = part.points(panels);
      for (std::ptrdiff_t k = 0; k < on_panels.count; ++k) {
        const Vector3d here(on_panels.x[k], on_panels.y[k], on_panels.z[k]);
        const double square = (here - point).squaredNorm();
        if (square < least) {
          least = square;
          result = here;
        }
      }
    }
    return result;
  }

  std::array<std::vector<float>, 3> coordinates_;
  std::ptrdiff_t count_ = 0;
};

/// The potentials of a body's functions (columns) around it.
struct Seen {
  SurroundingPoints points;
  MatrixXd functions;
};

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

/// Chooses points for charges one by one, each the one that lets the charges come nearest to the functions'
/// potentials (orthogonal matching pursuit). Stops at a root mean square error or at so many points. Columns
/// of `seen_charges`: the potentials of a unit charge in each point.
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
  while (index_of(chosen.size()) < most &&
         (chosen.empty() || left > error * error * static_cast<double>(rows))) {
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

/// Charges of a body's functions (columns) in points (rows).
struct FittedCharges {
  std::vector<Vector3d> points;
  MatrixXd charges;
};

/// Returns twice the root mean square of the errors of the potentials around a body, relative to the
/// potentials of charges of unit energy.
double error_of(const FittedCharges& fitted, const Seen& seen) {
  constexpr double safety = 2;
  const Index count = index_of(fitted.points.size());
  SharedPoints nodes{fitted.points, std::vector<Index>(fitted.points.size()),
                     std::vector<double>(fitted.points.size(), 1.0), 0};
  std::iota(nodes.places.begin(), nodes.places.end(), Index{0});
  const MatrixXd found = (seen.points.potentials(nodes, count) * fitted.charges.cast<float>()).cast<double>();
  return safety * std::sqrt(((found - seen.functions).rowwise().squaredNorm().array() /
                             seen.functions.rowwise().squaredNorm().array())
                                .mean());
}

/// Divides points into cells with sides of at most `side`.
void divide_into_cells(const std::vector<Vector3d>& points, std::span<Index> range, double side,
                       std::vector<std::span<Index>>& cells) {
  Eigen::AlignedBox3d box;
  for (const Index k : range)
    box.extend(points[static_cast<std::size_t>(k)]);
  Index axis = 0;
  const double longest = box.sizes().maxCoeff(&axis);
  if (longest <= side) {
    cells.push_back(range);
    return;
  }
  const double parts = std::ceil(longest / side);
  const double at = box.min()[axis] + longest * std::floor(parts / 2) / parts;
  const auto middle = std::partition(
      range.begin(), range.end(), [&](Index k) { return points[static_cast<std::size_t>(k)][axis] <= at; });
  const auto first = static_cast<std::size_t>(middle - range.begin());
  divide_into_cells(points, range.first(first), side, cells);
  divide_into_cells(points, range.subspan(first), side, cells);
}

/// Returns points all around a box at a distance, beside a grid of so many points along each of its sides.
std::vector<Vector3d> around_box(const Eigen::AlignedBox3d& box, double distance, int along) {
  const auto at = [](int k, int count) -> Vector3d {
    return Eigen::Vector3i(k % count, k / count % count, k / count / count).cast<double>() * 2 / (count - 1) -
           Vector3d::Ones();
  };
  std::vector<Vector3d> result;
  for (int on_grid = 0; on_grid < along * along * along; ++on_grid) {
    const Vector3d place = at(on_grid, along);
    for (int direction = 0; direction < 27; ++direction) {
      const Vector3d normal = at(direction, 3);
      if (!normal.isZero() && (normal.array() == 0 || normal.array() == place.array()).all())
        result.emplace_back(box.center() + place.cwiseProduct(box.sizes() / 2) +
                            distance * normal.normalized());
    }
  }
  return result;
}

/// Returns the potentials of unit charges at so many places (columns) at points, and below them a row with a
/// multiple of the charges themselves.
MatrixXd potentials_and_charges(const std::vector<Vector3d>& to, const SharedPoints& charges, Index places,
                                double multiple) {
  MatrixXd result = MatrixXd::Zero(index_of(to.size()) + 1, places);
  for (std::size_t k = 0; k < charges.points.size(); ++k) {
    auto column = result.col(charges.places[k]);
    for (std::size_t row = 0; row < to.size(); ++row)
      column[index_of(row)] += charges.shares[k] / (to[row] - charges.points[k]).norm();
    column[index_of(to.size())] += charges.shares[k] * multiple;
  }
  return result;
}

/// Finds charges in few of a cell's points whose potentials beyond a distance are those of all its charges,
/// to a root mean square error. `charges` are those of the cell's places (rows).
FittedCharges fitted_cell(const SharedPoints& cell, const MatrixXd& charges, double distance, double error) {
  /// Numbers of points along a cell's side and of candidates, for each distance of a side and its square.
  constexpr double along_per_side = 4.0 / 3, candidates_per_square = 12, least_sides = 3;
  /// Weight of a cell's net charge. If it were not kept, the errors of cells would not cancel far away.
  constexpr double charge_weight = 30;
  /// Rounding of single precision, some times of it: the charges are such that both, the errors that they
  /// leave and their own rounding, are small.
  constexpr double rounding = 5e-6;
  Eigen::AlignedBox3d box;
  for (const Vector3d& point : cell.points)
    box.extend(point);
  const double sides = std::max(box.sizes().maxCoeff() / distance, least_sides);
  const std::vector<Vector3d> around =
      around_box(box, distance, static_cast<int>(std::ceil(along_per_side * sides)) + 1);
  const std::vector<Vector3d> candidates = spread_out(
      cell.points, 0,
      std::min(static_cast<std::size_t>(candidates_per_square * sides * sides), cell.points.size()));
  const double multiple = charge_weight / distance;
  const MatrixXd wanted = potentials_and_charges(around, cell, charges.rows(), multiple) * charges;
  SharedPoints unit_charges{candidates, std::vector<Index>(candidates.size()),
                            std::vector<double>(candidates.size(), 1.0), 0};
  std::iota(unit_charges.places.begin(), unit_charges.places.end(), Index{0});
  const MatrixXd of_candidates =
      potentials_and_charges(around, unit_charges, index_of(candidates.size()), multiple);
  const std::vector<Index> chosen = chosen_points(
      of_candidates, wanted, error, std::min(index_of(candidates.size()), of_candidates.rows() / 2));
  const Index count = index_of(chosen.size()), rows = wanted.rows();
  FittedCharges result{{}, MatrixXd::Zero(count, wanted.cols())};
  if (count == 0)
    return result;
  for (const Index k : chosen)
    result.points.push_back(candidates[static_cast<std::size_t>(k)]);
  MatrixXd equations = MatrixXd::Zero(rows + count, count);
  equations.topRows(rows) = of_candidates(Eigen::all, chosen);
  equations.bottomRows(count).diagonal() = rounding * equations.colwise().norm();
  MatrixXd right_sides = MatrixXd::Zero(rows + count, wanted.cols());
  right_sides.topRows(rows) = wanted;
  result.charges = equations.householderQr().solve(right_sides);
  return result;
}

/// Fits charges cell by cell to the same error. `charges` are those of all places (rows).
FittedCharges fitted_cells(const SharedPoints& all, std::span<const std::span<Index>> cells,
                           const MatrixXd& charges, double distance, double error) {
  std::vector<MatrixXd> of_cells;
  FittedCharges result;
  for (const std::span<Index> range : cells) {
    check_interruption();
    SharedPoints cell;
    std::map<Index, Index> places;
    for (const Index k : range) {
      const auto at = static_cast<std::size_t>(k);
      cell.points.push_back(all.points[at]);
      cell.shares.push_back(all.shares[at]);
      cell.places.push_back(places.try_emplace(all.places[at], index_of(places.size())).first->second);
    }
    MatrixXd here(index_of(places.size()), charges.cols());
    for (const auto& [place, row] : places)
      here.row(row) = charges.row(place);
    const FittedCharges fitted = fitted_cell(cell, here, distance, error);
    result.points.insert(result.points.end(), fitted.points.begin(), fitted.points.end());
    of_cells.push_back(fitted.charges);
  }
  result.charges.resize(index_of(result.points.size()), charges.cols());
  Index first = 0;
  for (const MatrixXd& of_cell : of_cells) {
    result.charges.middleRows(first, of_cell.rows()) = of_cell;
    first += of_cell.rows();
  }
  return result;
}

/// Returns charges in points as nodes.
ChargedPanels as_nodes(const FittedCharges& fitted) {
  ChargedPanels result{one_cluster(fitted.points), {}};
  MatrixXf charges = MatrixXf::Zero(result.places(), fitted.charges.cols() + 1);
  charges.topLeftCorner(fitted.charges.rows(), fitted.charges.cols()) = fitted.charges.cast<float>();
  result.charges.assign(charges.data(), charges.data() + charges.size());
  return result;
}

}  // namespace

std::optional<ChargeSkeleton> charge_skeleton(const ChargedPanels& body, std::ptrdiff_t functions,
                                              std::span<const TriangleSurface> surfaces, double distance,
                                              double accuracy) {
  SurroundingPoints points(body, surfaces, distance);
  if (points.count() == 0)
    return std::nullopt;
  const SharedPoints all = fine_points(body.panels, distance);
  const MatrixXf charges =
      Eigen::Map<const MatrixXf>(body.charges.data(), body.places(), static_cast<Index>(functions));
  const MatrixXf potentials = points.potentials(all, body.places()) * charges;
  const Seen seen{std::move(points), potentials.cast<double>()};
  const double scale = std::sqrt(seen.functions.rowwise().squaredNorm().mean());
  /// Sides of cells in distances. Larger cells have fewer nodes, smaller ones are fitted more accurately.
  constexpr std::array<double, 3> sides{6, 3, 1.5};
  /// The error of cells in the first attempt, relative to the accuracy, for a single one and for several,
  /// whose errors add up. What a further attempt aims at.
  constexpr double single_part = 0.45, first_part = 0.23, aim = 0.85;
  constexpr int attempts = 2;
  std::vector<Index> order(all.points.size());
  std::iota(order.begin(), order.end(), Index{0});
  for (const double of_cells : sides) {
    std::vector<std::span<Index>> cells;
    divide_into_cells(all.points, order, of_cells * distance, cells);
    double part = (cells.size() == 1 ? single_part : first_part) * accuracy;
    for (int attempt = 0; attempt < attempts; ++attempt) {
      const FittedCharges fitted = fitted_cells(all, cells, charges.cast<double>(), distance, part * scale);
      const Index count = index_of(fitted.points.size());
      if (count == 0 || count > most_skeleton_nodes)
        return std::nullopt;
      const double error = error_of(fitted, seen);
      if (error <= accuracy)
        return ChargeSkeleton{as_nodes(fitted), error, all.ratio};
      part *= aim * accuracy / error;
    }
  }
  return std::nullopt;
}

}  // namespace fringe::detail
