#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fringe/scene.hpp"
#include "fringe/triangle.hpp"

namespace fringe {

/// The charges on the surfaces of a scene's conductors, from which its potential follows anywhere.
struct SurfaceCharges {
  std::vector<Triangle> panels;           ///< m, in the world; each with a charge spread evenly
  std::vector<std::string> conductors;    ///< sensors, grounded conductors and electrodes, then floating ones
  std::vector<std::size_t> conductor_of;  ///< of each panel, its place among the conductors
  /// Charges on the panels (rows), each conductor (columns) at unit potential and all others at 0, divided by
  /// 4πε (m).
  Eigen::MatrixXd charges;
  /// Estimate of the relative error of the charges' energies; of sensors and electrodes alone if there are
  /// any.
  double error = 0;
};

struct SurfaceChargeOptions {
  double rtol = 1e-2;              ///< relative error of the energies at which refinement stops
  std::size_t most_panels = 4000;  ///< refinement stops there, too
  std::size_t threads = 0;         ///< 0: as many as this process may run at once
};

/// Computes the charges by boundary elements with triangles only (model/BOUNDARY_ELEMENTS.md, section 9).
/// Throws InputError as maxwell() does, and for options out of range.
SurfaceCharges surface_charges(const Scene& scene, const SurfaceChargeOptions& options = {});

/// Computes the mean of 1/r between every pair of triangles (1/m): the single-layer matrix of triangles with
/// unit charges. `tolerance` is the relative error aimed at for each element.
Eigen::MatrixXd single_layer(std::span<const Triangle> triangles, double tolerance = 1e-4);

/// Single-precision values of triangles (columns) at points (rows).
using TrianglePotentials = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Computes the mean of 1/r over each triangle at points (1/m). A triangle farther away than ten times its
/// radius counts as a point, within 2e-3 of its own potential; their sum is far more accurate.
TrianglePotentials triangle_potentials(std::span<const Eigen::Vector3d> points,
                                       std::span<const Triangle> triangles, std::size_t threads = 0);

}  // namespace fringe
