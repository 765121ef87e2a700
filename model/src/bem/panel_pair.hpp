#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "surface/panel.hpp"

/// The interaction ∫∫1/r of two panels with unit charges that are near each other, touch, cross or overlap
/// (model/BOUNDARY_ELEMENTS.md, section 9).
namespace fringe::detail {

/// Adds up panels' potentials at points, or their solid angles over 4π, and evaluates them many at a time.
class PotentialSums {
 public:
  PotentialSums();
  static PotentialSums of_solid_angles();

  /// Adds weight·(the potential of the panel at the point) to `sum`, at the latest when flush() is called.
  void add(const Triangle& source, const Eigen::Vector3d& point, double weight, double& sum);
  void flush();

 private:
  using Kernel = void (*)(const double* const (&components)[9], std::size_t count, double* potentials);
  explicit PotentialSums(Kernel kernel) : kernel_(kernel) {}

  static constexpr std::size_t capacity = 256;
  Kernel kernel_;
  std::array<std::array<double, capacity>, 9> components_{};
  std::array<double, capacity> weights_{};
  std::array<double*, capacity> sums_{};
  std::size_t size_ = 0;
};

/// Adds the interaction of two different panels to `sum`, which is complete after sums.flush().
void add_pair(const Panel& a, const Panel& b, double tolerance, PotentialSums& sums, double& sum);

/// Returns the interaction of a panel with itself, in closed form.
double panel_self(const Panel& panel);

}  // namespace fringe::detail
