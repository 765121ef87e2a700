#include "reduced/insulated_body.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bem/adaptive.hpp"
#include "bem/group_densities.hpp"
#include "bem/insulated_system.hpp"
#include "fringe/error.hpp"
#include "numeric/cholesky.hpp"
#include "reduced/single_body_system.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The panels that carry the charges, with their single-layer matrix as it is and with one density on each
/// group.
struct Outermost {
  std::vector<Index> panels;
  std::vector<Index> groups;  ///< of each panel, among those that have any
  VectorXd shares;            ///< of each panel, of its group's area
  Index group_count = 0;
  Cholesky factor;
  Cholesky coarse;

  MatrixXd at(const MatrixXd& rows) const { return rows(panels, Eigen::all); }

  /// Averages rows over the groups.
  MatrixXd means(const MatrixXd& rows) const {
    MatrixXd result = MatrixXd::Zero(group_count, rows.cols());
    for (std::size_t k = 0; k < panels.size(); ++k)
      result.row(groups[k]) += shares[index_of(k)] * rows.row(index_of(k));
    return result;
  }
};

Outermost outermost_of(const InsulatedSystem& system) {
  Outermost result;
  result.panels = system.outermost_panels();
  const std::vector<Panel>& all = system.mesh().panels();
  std::vector<Index> group_of(all.size());
  const auto& groups = system.mesh().groups();
  for (std::size_t g = 0; g < groups.size(); ++g)
    std::fill_n(group_of.begin() + index_of(groups[g].first), groups[g].count, index_of(g));
  std::vector<Index> place(groups.size(), -1);
  std::vector<double> areas;
  for (const Index panel : result.panels) {
    const auto at = static_cast<std::size_t>(panel);
    Index& own = place[static_cast<std::size_t>(group_of[at])];
    if (own < 0) {
      own = result.group_count++;
      areas.push_back(0);
    }
    result.groups.push_back(own);
    areas[static_cast<std::size_t>(own)] += all[at].area;
  }
  result.shares.resize(index_of(result.panels.size()));
  for (std::size_t k = 0; k < result.panels.size(); ++k)
    result.shares[index_of(k)] = all[static_cast<std::size_t>(result.panels[k])].area /
                                 areas[static_cast<std::size_t>(result.groups[k])];
  const MatrixXd matrix = system.single_layer(result.panels);
  result.coarse = Cholesky(result.means(result.means(matrix).transpose()));
  result.factor = Cholesky(matrix);
  if (!result.factor.is_positive_definite() || !result.coarse.is_positive_definite())
    throw InputError("its surfaces and those of its insulators overlap");
  return result;
}

/// Writes responses and energies.
void answer(const InsulatedResponse& response, const Outermost& outermost, const MatrixXd& potentials,
            InsulatedBody& body) {
  const MatrixXd outer = outermost.at(potentials);
  body.responses = outermost.factor.solve(outer - outermost.at(response.potentials));
  const MatrixXd coarse =
      outermost.coarse.solve(outermost.means(outer - outermost.at(response.coarse_potentials)));
  body.energies = symmetric(outer.transpose() * body.responses);
  body.coarse_energies = symmetric(outermost.means(outer).transpose() * coarse);
}

/// Returns a body on whose surface nothing changes, as one of the medium's permittivity: it answers nothing.
InsulatedBody without_response(const InsulatedBodies& bodies, const OuterPotentials& potentials) {
  InsulatedBody body;
  for (const Insulator& insulator : bodies.insulators)
    for (const Triangle& triangle : insulator.surface)
      body.panels.push_back(make_panel(triangle));
  const Index columns = potentials(body.panels).cols() + 1;
  body.responses = MatrixXd::Zero(index_of(body.panels.size()), columns);
  body.energies = body.coarse_energies = body.facet_effects = MatrixXd::Zero(columns, columns);
  body.free_charges = MatrixXd::Zero(0, columns);
  return body;
}

/// Returns what the facets of round shapes may add to the energies, between all columns.
MatrixXd facet_effects(const InsulatedBodies& bodies, const InsulatedSystem& system,
                       const Outermost& outermost, const InsulatedResponse& response,
                       const MatrixXd& responses) {
  const std::vector<Panel>& panels = system.mesh().panels();
  const std::size_t conductors = bodies.conductors.bodies.size();
  std::vector<Index> place(panels.size(), -1);
  for (std::size_t k = 0; k < outermost.panels.size(); ++k)
    place[static_cast<std::size_t>(outermost.panels[k])] = index_of(k);
  MatrixXd result = MatrixXd::Zero(responses.cols(), responses.cols());
  const auto add = [&](double factor, const Eigen::RowVectorXd& charge) {
    result += factor * charge.transpose() * charge;
  };
  for (const PanelGroup& group : system.mesh().groups())
    for (std::size_t k = group.first; k < group.first + group.count; ++k) {
      if (group.body < conductors) {
        const RoundShape* const round = round_shape_of(bodies.conductors.bodies[group.body].surface);
        if (round != nullptr)
          add(round->lack_per_squared_charge(panels[k]),
              place[k] < 0 ? Eigen::RowVectorXd(response.charges.row(index_of(k)))
                           : Eigen::RowVectorXd(responses.row(place[k])));
        continue;
      }
      const Insulator& insulator = bodies.insulators[group.body - conductors];
      // Of a ball in a uniform field, an interface that moves adds this times what a conductor with the same
      // charges would add; less in other fields.
      if (insulator.round && place[k] >= 0 && insulator.ratio != 1)
        add((insulator.ratio + 2) / std::abs(insulator.ratio - 1) *
                insulator.round->lack_per_squared_charge(panels[k]),
            responses.row(place[k]));
    }
  return result;
}

/// The charges that potentials of degree 0 and 1 induce on conductors and the insulators fixed to them.
class InsulatedBodyProblem : public AdaptiveProblem {
 public:
  InsulatedBodyProblem(InsulatedSystem& system, bool has_conductors, double accuracy, std::size_t most_panels)
      : system_(system), has_conductors_(has_conductors), accuracy_(accuracy), most_panels_(most_panels) {}

  const std::vector<PanelGroup>& groups() const override { return system_.groups(); }

  Assessment solve() override {
    /// Ratio of the matrix elements' quadrature tolerance to the accuracy of the energies.
    constexpr double tolerance_per_accuracy = 0.02;
    system_.evaluate(tolerance_per_accuracy * accuracy_);
    outermost = outermost_of(system_);
    // Without conductors a constant potential moves no charge.
    const MatrixXd plain = plain_potentials(system_.mesh()).rightCols(has_conductors_ ? 4 : 3);
    const InsulatedResponse response = system_.respond(plain, VectorXd::Ones(plain.cols()));
    answer(response, outermost, plain, body);
    values_ = response.potentials + response.charges;
    const VectorXd own = counted_energies(body.energies.diagonal());
    // A body of almost the medium's permittivity may respond by rounding errors alone.
    if (!(own.maxCoeff() > 0))
      return {true, {}, 0, 0};
    const VectorXd change = body.energies.diagonal() - body.coarse_energies.diagonal();
    const double error = (change.array().abs() / own.array()).maxCoeff();
    const VectorXd indicators = response.energies / own.maxCoeff();
    return {error <= accuracy_ || system_.panels() >= most_panels_, indicators,
            indicators.sum() * accuracy_ / error, most_panels_ - std::min(most_panels_, system_.panels())};
  }

  bool refine(const std::vector<int>& steps) override {
    if (steps.empty())
      return false;
    system_.refine(steps, values_);
    return true;
  }

  InsulatedBody body;
  Outermost outermost;

 private:
  InsulatedSystem& system_;
  bool has_conductors_;
  double accuracy_;
  std::size_t most_panels_;
  MatrixXd values_;  ///< potentials and charges of the panels
};

}  // namespace

InsulatedBody solve_insulated_body(const InsulatedBodies& bodies, double accuracy, std::size_t most_panels,
                                   const OuterPotentials& potentials) {
  /// A-priori grading takes at most one in so many panels: the others are for refinement.
  constexpr std::size_t most_graded = 2;
  const bool has_conductors = !bodies.conductors.bodies.empty();
  InsulatedSystem system(bodies, {}, {grading_part * accuracy, most_panels / most_graded}, 0);
  if (system.panels() > most_panels)
    throw InputError("it has too many triangles with its insulators for the reduced method");
  if (system.panels() == 0)
    return without_response(bodies, potentials);
  InsulatedBodyProblem problem(system, has_conductors, accuracy, most_panels);
  solve_adaptively(problem);
  InsulatedBody& body = problem.body;
  const Outermost& outermost = problem.outermost;
  const std::vector<Panel>& all = system.mesh().panels();
  const MatrixXd others = potentials(all);
  MatrixXd outer(others.rows(), others.cols() + 1);
  outer << VectorXd::Ones(others.rows()), others;
  const InsulatedResponse response = system.respond(outer, VectorXd::Ones(outer.cols()));
  answer(response, outermost, outer, body);
  if (!has_conductors) {
    body.responses.col(0).setZero();
    for (MatrixXd* const energies : {&body.energies, &body.coarse_energies}) {
      energies->row(0).setZero();
      energies->col(0).setZero();
    }
  }
  for (const Index panel : outermost.panels)
    body.panels.push_back(all[static_cast<std::size_t>(panel)]);
  body.facet_effects = facet_effects(bodies, system, outermost, response, body.responses);
  body.free_charges = -net_charges(system.mesh(), response.charges, bodies.conductors.bodies.size());
  return std::move(body);
}

}  // namespace fringe::detail
