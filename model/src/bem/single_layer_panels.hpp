#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "bem/jacobi_basis.hpp"
#include "bem/panel_pair.hpp"
#include "numeric/quadrature_rules.hpp"
#include "surface/face.hpp"
#include "surface/panel.hpp"

namespace fringe::detail {

/// Panels as point charges at the points of a quadrature rule: they interact as the panels do if these are
/// far apart.
class PointCharges {
 public:
  PointCharges(std::span<const Panel> panels, int degree);

  /// Computes the means of 1/r between a panel and `count` of the panels from `first` on.
  void fill(const Panel& panel, std::size_t first, std::size_t count, double* means) const;

 private:
  std::size_t points() const { return static_cast<std::size_t>(rule_.points); }

  const TriangleRule& rule_;
  std::size_t stride_;
  std::vector<double> coordinates_;  ///< x, y, z of the panels' first points, then of their second …
};

/// Evaluates elements of the single-layer matrix ∫∫1/r of panels with unit charges. `tolerance` is the error
/// aimed at for each element (model/BOUNDARY_ELEMENTS.md, section 9).
class PanelElements {
 public:
  PanelElements(std::span<const Panel> panels, double tolerance);

  /// Returns the element for a panel of a column if it is known.
  using Known = std::function<std::optional<double>(std::size_t)>;

  /// Computes the interactions of a panel with `count` of the panels from `first` on, none of which is the
  /// panel itself. They are complete after sums.flush().
  void fill(const Panel& panel, std::size_t first, std::size_t count, PotentialSums& sums, const Known& known,
            double* row) const;

 private:
  /// Degree of the rule for panels that are far apart, of three points.
  static constexpr int far_degree = 2;
  bool is_far(const Panel& a, const Panel& b) const;

  std::span<const Panel> panels_;
  double tolerance_;
  double farthest_;
  PointCharges far_;
};

/// Elements that are known from another matrix: those between panels that have a place there. A negative
/// place, or no places, means that nothing is known.
struct KnownElements {
  const Eigen::MatrixXd& matrix;
  std::span<const Eigen::Index> places;
};

/// Computes the single-layer matrix ∫∫1/r of all pairs of panels with unit charges: its upper triangle,
/// nothing below it. `tolerance` is the error aimed at for each element (model/BOUNDARY_ELEMENTS.md, section
/// 9).
Eigen::MatrixXd single_layer_matrix(std::span<const Panel> panels, double tolerance,
                                    const KnownElements& known, std::size_t threads);
Eigen::MatrixXd single_layer_matrix(std::span<const Panel> panels, double tolerance);

/// Computes the mean potentials on targets, which may be parts of panels, of charges on the panels; one
/// column for each column of charges. The result has the same bits for any number of threads.
Eigen::MatrixXd panel_potentials(std::span<const Panel> targets, std::span<const Panel> panels,
                                 const Eigen::MatrixXd& charges, double tolerance, std::size_t threads);

/// Computes the single-layer block of a face's functions (rows) with panels of unit charge (columns) that do
/// not touch it. `tolerance` is the error aimed at, relative to the largest elements of a column.
Eigen::MatrixXd single_layer_block(const ChargedFace& face, FaceFunctions functions,
                                   std::span<const Panel> panels, double tolerance);

}  // namespace fringe::detail
