#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "surface/panel.hpp"

/// The double-layer operator of panels with a constant dipole density (model/BOUNDARY_ELEMENTS.md, section
/// 13).
namespace fringe::detail {

/// Elements of the double-layer matrix, in columns for the panels that are sources.
struct DoubleLayer {
  Eigen::MatrixXd elements;
  std::vector<Eigen::Index> columns;  ///< of every panel; negative: it is no source

  /// Returns the element of a target and a panel; zero if the panel is no source.
  double operator()(Eigen::Index target, Eigen::Index panel) const {
    const Eigen::Index column = columns[static_cast<std::size_t>(panel)];
    return column < 0 ? 0 : elements(target, column);
  }

  /// Returns the elements of some targets and a panel; zeros if the panel is no source.
  Eigen::VectorXd column(const std::vector<Eigen::Index>& targets, Eigen::Index panel) const {
    const Eigen::Index own = columns[static_cast<std::size_t>(panel)];
    if (own < 0)
      return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(targets.size()));
    return elements.col(own)(targets);
  }
};

/// Elements that are known from another double layer: those between panels that have a place there. A
/// negative place, or no places, means that nothing is known.
struct KnownAngles {
  const DoubleLayer& matrix;
  std::span<const Eigen::Index> places;
};

/// Computes the mean over each target (rows) of the solid angle of each panel that is a source (columns),
/// over 4π, positive where the source's normal points away from the target. Targets may be parts of the
/// panels. The jump across a source counts with the mean of both sides. `tolerance` is the absolute error
/// aimed at; known elements are for targets that are the panels. Threads: 0 means as many as this process may
/// run at once.
DoubleLayer double_layer_of(std::span<const Panel> targets, std::span<const Panel> panels,
                            const std::vector<bool>& is_source, double tolerance, const KnownAngles& known,
                            std::size_t threads);

}  // namespace fringe::detail
