#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "bem/charge_nodes.hpp"
#include "fringe/reading_answer.hpp"
#include "geometry/link_motion.hpp"
#include "geometry/wrench.hpp"

namespace fringe::detail {

/// The columns of charges from which the changes of readings follow. With the charges of background s, d and
/// those that the targets change δs, δd, for the sensed and the driven conductors, a change is
/// (s + δs, δd) + (δs, d); if sensed and driven are the same, (δ, 2s + δ).
struct FormColumns {
  std::vector<std::size_t> readings;  ///< of the energy between the columns 2k and 2k + 1
  Eigen::MatrixXd combination;        ///< the columns of ReadingCharges::all() (rows) in every column
};

FormColumns form_columns(const std::vector<ChargedReading>& readings);

/// Writes the derivatives of a reading's change with respect to the poses of all links, by what every pair of
/// bodies contributes, with estimates of their errors; none if the change is not known or infinite. The world
/// poses must be up to date.
void write_link_derivatives(const LinkPoses& poses, std::span<const PairWrench> pairs, ReadingAnswer& answer);

/// Returns what a pair contributes of which the forces are not known.
PairWrench unknown_wrench(std::optional<std::size_t> link, std::optional<std::size_t> other);

/// Adds to the readings (m) the derivatives of their changes with respect to the poses of all links, and
/// estimates of their errors (model/BOUNDARY_ELEMENTS.md, section 12). The world poses must be up to date.
/// Derivatives are NaN for a link that moves against a body which it touches or almost touches.
void write_derivatives(const ChargeNodes& nodes, const ChargedBodies& bodies, const LinkPoses& poses,
                       std::size_t threads, std::vector<ReadingAnswer>& answers);

}  // namespace fringe::detail
