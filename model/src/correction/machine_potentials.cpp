#include "fringe/machine_potentials.hpp"

#include <utility>

#include <fmt/format.h>

#include "correction/company.hpp"
#include "correction/outside_potentials.hpp"
#include "fringe/error.hpp"
#include "fringe/reading.hpp"
#include "reduced/node_kernels.hpp"

namespace fringe {

using Eigen::Index;
using Eigen::MatrixXf;

struct MachinePotentials::Machine {
  Machine(const Scene& scene, const MachinePotentialsOptions& options)
      : rest(detail::charged_bodies(scene), fringe::readings(scene),
             {options.rtol, options.most_panels, options.functions, 0, options.threads}),
        potentials(rest.functions()) {
    for (const detail::MachineAtRest::OfReading& reading : rest.readings())
      readings.push_back(
          {static_cast<std::size_t>(reading.sense), static_cast<std::size_t>(reading.drive), reading.sign});
  }

  Values at(std::span<const Eigen::Vector3d> points, bool with_parts, const MatrixXf* charges,
            std::size_t threads) const {
    detail::OutsidePotentials::Values values = potentials.at(points, with_parts, charges, threads);
    return {std::move(values.of_given), std::move(values.of_functions)};
  }

  detail::MachineAtRest rest;
  detail::OutsidePotentials potentials;
  std::vector<OfReading> readings;
};

MachinePotentials::MachinePotentials(const Scene& scene, const MachinePotentialsOptions& options) {
  if (!(options.rtol >= 1e-4 && options.rtol <= 0.5))
    throw InputError(fmt::format("rtol {} must be from 0.0001 to 0.5", options.rtol));
  if (options.functions == 0)
    throw InputError("functions must be at least 1");
  if (scene.has_room)
    throw InputError("room: boundary elements compute only conductors in free space");
  if (fringe::readings(scene).empty())
    throw InputError("a machine without sensors or electrodes has no readings");
  machine_ = std::make_shared<const Machine>(scene, options);
}

const std::vector<MachinePotentials::OfReading>& MachinePotentials::readings() const {
  return machine_->readings;
}

Eigen::MatrixXd MachinePotentials::answers() const {
  const auto count = static_cast<Index>(machine_->rest.functions().count());
  const Eigen::Map<const MatrixXf> stored(machine_->rest.answers().data(), detail::whole_blocks(count),
                                          count);
  return stored.topRows(count).cast<double>();
}

double MachinePotentials::error() const {
  return machine_->rest.error();
}

std::size_t MachinePotentials::panels() const {
  return machine_->potentials.panels();
}

MachinePotentials::Values MachinePotentials::at(std::span<const Eigen::Vector3d> points, bool with_parts,
                                                std::size_t threads) const {
  return machine_->at(points, with_parts, nullptr, threads);
}

MachinePotentials::Values MachinePotentials::at(std::span<const Eigen::Vector3d> points,
                                                const MatrixXf& charges, std::size_t threads) const {
  if (const std::size_t parts = machine_->rest.functions().count();
      static_cast<std::size_t>(charges.rows()) != parts)
    throw InputError(fmt::format("charges have {} rows, but there are {} parts", charges.rows(), parts));
  return machine_->at(points, true, &charges, threads);
}

}  // namespace fringe
