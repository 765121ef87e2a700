#include "bem/asked_error.hpp"

#include <algorithm>

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Eigen::ArrayXXd error_scales(const MaxwellMatrix& answer, const ChargedBodies& bodies) {
  /// Entries of this part of the diagonal are as accurate as they are large. Those of bodies that others
  /// shield from each other are far smaller, and no reading depends on their digits.
  constexpr double least_part = 1e-3;
  const VectorXd roots = answer.values.diagonal().cwiseSqrt();
  Eigen::ArrayXXd scales = answer.values.array().abs().max(least_part * (roots * roots.transpose()).array());
  for (Index i = 0; i < scales.rows(); ++i)
    for (Index j = 0; j < scales.cols(); ++j)
      if (!bodies.conductors[static_cast<std::size_t>(i)].is_asked &&
          !bodies.conductors[static_cast<std::size_t>(j)].is_asked)
        scales(i, j) = std::numeric_limits<double>::infinity();
  return scales;
}

double largest_error(const MaxwellMatrix& answer, const ChargedBodies& bodies) {
  return (answer.errors.array() / error_scales(answer, bodies)).maxCoeff();
}

double excess_error(const MaxwellMatrix& answer, const ChargedBodies& bodies, const MatrixXd& geometry,
                    double rtol) {
  const Eigen::ArrayXXd values = error_scales(answer, bodies);
  const double simplified = (geometry.array() / values).maxCoeff();
  return ((answer.errors - geometry).array() / values).maxCoeff() / std::max(rtol - simplified, simplified);
}

bool Progress::is_in_vain(double excess, std::size_t unknowns) {
  /// Unknowns from which a refinement takes half a minute or more.
  constexpr std::size_t many = 8000;
  /// Excess beyond which the goal is far: many more refinements, each of which takes longer, would be
  /// needed.
  constexpr double far = 10;
  /// Factor that a refinement has to gain, and how many of them in succession may not.
  constexpr double least_gain = 0.9;
  constexpr int most_vain_steps = 2;
  vain_steps_ = excess > least_gain * best_ ? vain_steps_ + 1 : 0;
  best_ = std::min(best_, excess);
  return unknowns >= many && excess > far && vain_steps_ >= most_vain_steps;
}

}  // namespace fringe::detail
