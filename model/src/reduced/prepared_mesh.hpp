#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "reduced/node_kernels.hpp"
#include "reduced/panel_clusters.hpp"
#include "reduced/prepared_shape.hpp"

/// What of a body of triangles does not change when it moves or grows (model/BOUNDARY_ELEMENTS.md, section
/// 8).
namespace fringe::detail {

/// With more the preparation takes many seconds.
constexpr std::size_t most_mesh_panels = 2000;

/// The charges with which a body of triangles answers others, most needed first, each a density for every
/// panel. They have the energy one and none in common.
class PreparedMesh {
 public:
  /// `triangles` about the origin, their largest coordinate about 1. The panels are to be so fine that
  /// energies are within `accuracy`.
  PreparedMesh(std::vector<Triangle> triangles, double accuracy);

  const std::vector<Triangle>& triangles() const { return triangles_; }
  bool is_closed() const { return is_closed_; }
  /// Around all triangles.
  const BoxNumbers& box() const { return box_; }

  /// The panels that carry the functions' charges.
  const PanelClusters& panels() const { return panels_; }
  std::ptrdiff_t places() const { return static_cast<std::ptrdiff_t>(panels_.panels.size()); }

  /// The centre of the panel at a place.
  Eigen::Vector3d point(std::ptrdiff_t place) const;

  /// The charges at all places, a row for every function.
  NodeMatrix functions(std::ptrdiff_t count) const { return {functions_.data(), count, places()}; }

  /// With so many functions as a level has.
  PreparedLevel level(int index) const;

 private:
  std::vector<Triangle> triangles_;
  bool is_closed_;
  BoxNumbers box_;
  PanelClusters panels_;
  std::vector<float> functions_;
  double root_ = 0;          ///< of the capacitance
  Eigen::MatrixXd missing_;  ///< energies that coarser panels lack
};

}  // namespace fringe::detail
