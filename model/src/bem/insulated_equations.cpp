#include "bem/insulated_equations.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include <Eigen/LU>

#include "geometry/median_split.hpp"
#include "numeric/gmres.hpp"
#include "numeric/interruption.hpp"
#include "numeric/parallel.hpp"
#include "numeric/products.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

InsulatedUnknowns insulated_unknowns(const PanelMesh& mesh, const Surroundings& surroundings) {
  InsulatedUnknowns result;
  std::vector<double> areas, whole;
  for (const PanelGroup& group : mesh.groups()) {
    check_interruption();
    std::vector<std::pair<PartState, Index>> places;
    for (std::size_t panel = group.first; panel < group.first + group.count; ++panel) {
      const PartState state = surroundings.state(mesh.panels()[panel].corners, group.body);
      if (state.kind == PartKind::absent)
        continue;
      auto place =
          std::find_if(places.begin(), places.end(), [&](const auto& known) { return known.first == state; });
      if (place == places.end()) {
        place = places.insert(places.end(), {state, result.coarse_size++});
        whole.push_back(0);
      }
      result.panels.push_back(index_of(panel));
      result.states.push_back(state);
      result.coarse.push_back(place->second);
      result.body.push_back(index_of(group.body));
      areas.push_back(mesh.panels()[panel].area);
      whole[static_cast<std::size_t>(place->second)] += areas.back();
    }
  }
  result.shares.resize(result.size());
  for (Index k = 0; k < result.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    result.shares[k] = areas[at] / whole[static_cast<std::size_t>(result.coarse[at])];
  }
  return result;
}

/// Returns the sums of weighted rows that have the same place in the coarse space.
MatrixXd summed_rows(const InsulatedUnknowns& unknowns, const MatrixXd& rows, bool are_weighted) {
  MatrixXd result = MatrixXd::Zero(unknowns.coarse_size, rows.cols());
  for (Index column = 0; column < rows.cols(); ++column)
    for (Index k = 0; k < rows.rows(); ++k)
      result(unknowns.coarse[static_cast<std::size_t>(k)], column) +=
          (are_weighted ? unknowns.shares[k] : 1.0) * rows(k, column);
  return result;
}

/// The equations in the coarse space: one density, or one potential, on panels that are alike.
class CoarseCorrection {
 public:
  CoarseCorrection(const InsulatedUnknowns& unknowns, const MatrixXd& matrix)
      : unknowns_(unknowns), columns_(MatrixXd::Zero(matrix.rows(), unknowns.coarse_size)) {
    for (Index k = 0; k < unknowns.size(); ++k)
      columns_.col(unknowns.coarse[static_cast<std::size_t>(k)]) += share(k) * matrix.col(k);
    factor_.compute(summed_rows(unknowns, columns_, true));
  }

  /// Returns the product of the matrix and each density or potential of the coarse space.
  const MatrixXd& columns() const { return columns_; }

  /// Solves for the densities and potentials of the coarse space.
  MatrixXd solve(const MatrixXd& potentials) const {
    return factor_.solve(summed_rows(unknowns_, potentials, true));
  }

  /// Returns what each panel has of a solution of the coarse space.
  MatrixXd on_panels(const MatrixXd& solution) const {
    MatrixXd result(unknowns_.size(), solution.cols());
    for (Index k = 0; k < unknowns_.size(); ++k)
      result.row(k) = share(k) * solution.row(unknowns_.coarse[static_cast<std::size_t>(k)]);
    return result;
  }

 private:
  /// Returns what a panel has of a charge, or of a potential, of the coarse space.
  double share(Index k) const { return unknowns_.is_charge(k) ? unknowns_.shares[k] : 1; }

  const InsulatedUnknowns& unknowns_;
  MatrixXd columns_;
  Eigen::PartialPivLU<MatrixXd> factor_;
};

/// The inverses of the blocks of panels that are close to each other.
class NearbyPanels {
 public:
  NearbyPanels(const PanelMesh& mesh, const InsulatedUnknowns& unknowns, const MatrixXd& matrix) {
    std::vector<Index> order(unknowns.panels.size());
    for (std::size_t k = 0; k < order.size(); ++k)
      order[k] = index_of(k);
    divide(order, [&](Index k) -> const Eigen::Vector3d& {
      return mesh.panels()[static_cast<std::size_t>(unknowns.panels[static_cast<std::size_t>(k)])].centre;
    });
    for (const std::vector<Index>& block : blocks_)
      factors_.emplace_back(MatrixXd(matrix(block, block)));
  }

  MatrixXd solve(const MatrixXd& potentials) const {
    MatrixXd result(potentials.rows(), potentials.cols());
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      // Eigen's solver cannot work in selected rows.
      const MatrixXd own = potentials(blocks_[k], Eigen::all);
      const MatrixXd solution = factors_[k].solve(own);
      result(blocks_[k], Eigen::all) = solution;
    }
    return result;
  }

 private:
  template <class CentreOf>
  void divide(std::span<Index> part, const CentreOf& centre_of) {
    /// Largest number of panels in a block.
    constexpr std::size_t most = 96;
    if (part.size() <= most) {
      blocks_.emplace_back(part.begin(), part.end());
      return;
    }
    const std::size_t half = part.size() / 2;
    split_at_median(part, half, centre_of);
    divide(part.first(half), centre_of);
    divide(part.subspan(half), centre_of);
  }

  std::vector<std::vector<Index>> blocks_;
  std::vector<Eigen::PartialPivLU<MatrixXd>> factors_;
};

/// A large matrix for products with few columns, which take as long as its memory is read: in single
/// precision, and in tiles that lie in one piece each. The elements' quadratures are less accurate.
class TiledMatrix {
 public:
  TiledMatrix(const MatrixXd& matrix, std::size_t threads)
      : rows_(matrix.rows()), tiles_(count(rows_, tile_rows) * count(matrix.cols(), tile_columns)),
        threads_(threads) {
    const std::size_t across = count(matrix.cols(), tile_columns);
    parallel_for(tiles_.size(), threads, [&](std::size_t k) {
      const Index row = index_of(k / across) * tile_rows, column = index_of(k % across) * tile_columns;
      tiles_[k] = matrix
                      .block(row, column, std::min(tile_rows, rows_ - row),
                             std::min(tile_columns, matrix.cols() - column))
                      .cast<float>();
    });
  }

  MatrixXd times(const MatrixXd& columns) const {
    MatrixXd result = MatrixXd::Zero(rows_, columns.cols());
    const std::size_t down = count(rows_, tile_rows), across = tiles_.size() / std::max<std::size_t>(down, 1);
    parallel_for(down, threads_, [&](std::size_t k) {
      for (std::size_t l = 0; l < across; ++l) {
        const Eigen::MatrixXf& tile = tiles_[k * across + l];
        add_product(MatrixReference<float>(tile), columns.middleRows(index_of(l) * tile_columns, tile.cols()),
                    result.middleRows(index_of(k) * tile_rows, tile.rows()));
      }
    });
    return result;
  }

 private:
  static constexpr Index tile_rows = 256, tile_columns = 128;
  static std::size_t count(Index size, Index of_tile) {
    return static_cast<std::size_t>((size + of_tile - 1) / of_tile);
  }

  Index rows_;
  std::vector<Eigen::MatrixXf> tiles_;  ///< row by row
  std::size_t threads_;
};

/// Solves the equations of all panels: by factorisation if there are few, else by generalised minimal
/// residuals with the coarse space and the blocks of nearby panels as preconditioner.
MatrixXd solve_all(const PanelMesh& mesh, const InsulatedUnknowns& unknowns, const MatrixXd& matrix,
                   const CoarseCorrection& coarse, const MatrixXd& right_sides, std::size_t threads) {
  /// Least number of unknowns for each right side, and altogether, with which the iteration takes less time.
  constexpr Index least_per_column = 60, least_unknowns = 1200;
  /// Largest residual, relative to the right side: far below the accuracy that can be asked for.
  constexpr double residual = 1e-7;
  constexpr int most_steps = 150;
  if (unknowns.size() >= std::max(least_unknowns, least_per_column * right_sides.cols())) {
    const NearbyPanels nearby(mesh, unknowns, matrix);
    const TiledMatrix tiled(matrix, threads), tiled_columns(coarse.columns(), threads);
    const auto solution = gmres(
        [&](const MatrixXd& columns) {
          check_interruption();
          return tiled.times(columns);
        },
        [&](const MatrixXd& columns) {
          const MatrixXd first = coarse.solve(columns);
          return MatrixXd(coarse.on_panels(first) + nearby.solve(columns - tiled_columns.times(first)));
        },
        right_sides, residual, most_steps);
    if (solution)
      return *solution;
  }
  return matrix.partialPivLu().solve(right_sides);
}

/// Returns the films of a set of bodies, and adds them to the equations.
void add_films(const PanelMesh& mesh, const InsulatedBodies& bodies, const Surroundings& surroundings,
               InsulatedEquations& equations) {
  const InsulatedUnknowns& unknowns = equations.unknowns;
  const std::size_t conductors = bodies.conductors.bodies.size();
  std::vector<SheetPanel> panels;
  Eigen::AlignedBox3d box;
  for (Index k = 0; k < unknowns.size(); ++k) {
    if (unknowns.kind(k) != PartKind::film)
      continue;
    const auto at = static_cast<std::size_t>(k);
    const ThinFilm& film =
        bodies.films[static_cast<std::size_t>(unknowns.body[at]) - conductors - bodies.insulators.size()];
    panels.push_back({mesh.panels()[static_cast<std::size_t>(unknowns.panels[at])].corners,
                      film.thickness * (film.ratio - 1), film.thickness});
    equations.film_unknowns.push_back(k);
    box.extend(film.box);
  }
  if (panels.empty())
    return;
  equations.films.emplace(
      std::move(panels),
      [&](const Eigen::Vector3d& corner) { return surroundings.conductor_at(corner, box); }, conductors);
  const std::vector<Index>& own = equations.film_unknowns;
  equations.matrix(own, own) += equations.films->compliance();
  for (std::size_t body = 0; body < conductors; ++body)
    equations.potentials(own, index_of(bodies.conductors.bodies[body].conductor)) +=
        equations.films->lifts().col(index_of(body));
}

}  // namespace

AngleTarget InsulatedEquations::target(Index k) const {
  const auto at = static_cast<std::size_t>(k);
  const Ratios& ratios = unknowns.states[at].ratios;
  return {(ratios.behind + ratios.before) / 2, components[at]};
}

InsulatedEquations insulated_equations(const PanelMesh& mesh, const InsulatedBodies& bodies,
                                       const Surroundings& surroundings, const MatrixXd& single_layer,
                                       const MatrixXd& double_layer, std::size_t threads) {
  InsulatedEquations result;
  result.threads = threads;
  result.unknowns = insulated_unknowns(mesh, surroundings);
  const InsulatedUnknowns& unknowns = result.unknowns;
  const Index size = unknowns.size();
  const auto conductor_of = [&](Index k) {
    const Index body = unknowns.body[static_cast<std::size_t>(k)];
    return index_of(bodies.conductors.bodies[static_cast<std::size_t>(body)].conductor);
  };
  result.components = components_of(mesh, bodies, unknowns);
  std::vector<AngleTarget> targets;
  for (Index k = 0; k < size; ++k)
    targets.push_back(result.target(k));
  const AngleSums angles(unknowns, result.components, targets, [&](Index row, Index column) {
    return double_layer(unknowns.panels[static_cast<std::size_t>(row)],
                        unknowns.panels[static_cast<std::size_t>(column)]);
  });
  result.matrix.resize(size, size);
  result.potentials = MatrixXd::Zero(size, index_of(bodies.conductors.conductors.size()));
  /// Number of rows that one thread fills at a time.
  constexpr Index together = 256;
  parallel_for(static_cast<std::size_t>((size + together - 1) / together), threads, [&](std::size_t block) {
    const Index first = index_of(block) * together, rows = std::min(together, size - first);
    VectorXd layer(rows);
    for (Index column = 0; column < size; ++column) {
      const auto at = static_cast<std::size_t>(column);
      const Ratios& ratios = unknowns.states[at].ratios;
      const double jump = ratios.behind - ratios.before, mean = (ratios.behind + ratios.before) / 2;
      const Index source = unknowns.panels[at], own = column - first;
      const bool is_own = own >= 0 && own < rows;
      const auto panel = [&](Index row) { return unknowns.panels[static_cast<std::size_t>(first + row)]; };
      auto elements = result.matrix.col(column).segment(first, rows);
      if (jump != 0) {
        for (Index row = 0; row < rows; ++row)
          layer[row] = angles.corrected(first + row, column, double_layer(panel(row), source));
        if (is_own)
          layer[own] -= mean;
      }
      if (!unknowns.is_charge(column)) {
        elements = layer;
        continue;
      }
      for (Index row = 0; row < rows; ++row)
        elements[row] = single_layer(panel(row), source);
      if (unknowns.kind(column) == PartKind::film)
        continue;
      auto potentials = result.potentials.col(conductor_of(column)).segment(first, rows);
      if (jump != 0)
        potentials -= layer;
      else if (is_own)
        potentials[own] += mean;
    }
  });
  if (!bodies.films.empty())
    add_films(mesh, bodies, surroundings, result);
  return result;
}

InsulatedSolutions solved(const PanelMesh& mesh, const InsulatedEquations& equations,
                          const MatrixXd& right_sides, std::size_t threads) {
  const InsulatedUnknowns& unknowns = equations.unknowns;
  const CoarseCorrection coarse(unknowns, equations.matrix);
  InsulatedSolutions result;
  result.fine = solve_all(mesh, unknowns, equations.matrix, coarse, right_sides, threads);
  result.coarse = coarse.on_panels(coarse.solve(right_sides));
  result.details = result.fine;
  const MatrixXd means = summed_rows(unknowns, result.fine, false),
                 weighted = summed_rows(unknowns, result.fine, true);
  for (Index k = 0; k < unknowns.size(); ++k) {
    const auto place = unknowns.coarse[static_cast<std::size_t>(k)];
    if (unknowns.is_charge(k))
      result.details.row(k) -= unknowns.shares[k] * means.row(place);
    else
      result.details.row(k) -= weighted.row(place);
  }
  return result;
}

}  // namespace fringe::detail
