#include "reduced/reduced_derivatives.hpp"

#include <cmath>

#include "bem/reading_derivatives.hpp"

namespace fringe::detail {
namespace {

using Eigen::MatrixXd;
using Eigen::MatrixXf;

/// Returns a wrench for lengths in metres of a quantity that keeps its unit.
Wrench in_metres(const Wrench& wrench, double unit) {
  return {wrench.force / unit, wrench.torque};
}

/// Returns a ball around a rigid body, whose shape has coordinates of 1 at most.
BodyBall ball_around(const Arrangement& bodies, std::size_t body) {
  return {bodies.unit() * bodies.placed(body).centre,
          std::sqrt(3) * bodies.unit() * bodies.rigid()[body].scale};
}

}  // namespace

void write_derivatives(ReducedSystem& system, const Arrangement& bodies,
                       const std::vector<ChargedReading>& readings, ReducedReadings& found) {
  const FormColumns columns = form_columns(readings);
  const MatrixXd combination = found.charges * columns.combination;
  const std::size_t count = bodies.rigid().size();
  std::vector<MatrixXf> charges;
  for (std::size_t body = 0; body < count; ++body)
    charges.push_back(system.charges_in_change(body, combination));
  std::vector<std::vector<PairWrench>> pairs(readings.size());
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = a + 1; b < count; ++b) {
      if (bodies.link(a) == bodies.link(b))
        continue;
      const std::vector<Wrench> forms = system.pair(a, b).forces(charges[a], charges[b]);
      const std::size_t smaller = bodies.rigid()[a].scale < bodies.rigid()[b].scale ? a : b;
      for (std::size_t form = 0; form < forms.size(); ++form)
        pairs[columns.readings[form]].push_back({bodies.link(a), bodies.link(b),
                                                 in_metres(forms[form], bodies.unit()),
                                                 ball_around(bodies, smaller)});
    }
  for (std::size_t body = 0; body < count; ++body)
    for (const std::size_t part : bodies.rigid()[body].parts)
      if (const auto link = bodies.bodies().bodies[part].link; link != bodies.link(body))
        for (std::vector<PairWrench>& of_reading : pairs)
          of_reading.push_back(unknown_wrench(bodies.link(body), link));
  for (std::size_t k = 0; k < readings.size(); ++k)
    write_link_derivatives(bodies.poses(), pairs[k], found.answers[k]);
}

}  // namespace fringe::detail
