#include "assessment.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include <Eigen/Geometry>
#include <mpfr.h>

#include "fringe/batch_integral.hpp"
#include "fringe/plate_integral.hpp"

namespace fringe::stress {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Computes ∫dA/d over a triangle in region I by the formula printed in thesis 5.3.1 and appendix D, without
/// ε, in double precision and without any safeguards.
double thesis_formula(const Triangle& triangle, const Rectangle& plate) {
  const Eigen::Vector3d n = plate.edge_u.cross(plate.edge_v).normalized();
  const Eigen::Vector3d u = triangle[1] - triangle[0], v = triangle[2] - triangle[0];
  const double a = u.dot(n), b = v.dot(n), c = triangle[0].dot(n) - plate.corner.dot(n);
  return u.cross(v).norm() / b *
         (b * (a + c) / (a * (a - b)) * std::log(a + c) - (b + c) / (a - b) * std::log(b + c) +
          c / a * std::log(c));
}

bool in_front(const Dissection& dissection) {
  return std::all_of(dissection.vertices.begin(), dissection.vertices.end(), [&](const RealVector& vertex) {
    return vertex.x() >= 0 && vertex.x() <= dissection.frame.lengths[0] && vertex.y() >= 0 &&
           vertex.y() <= dissection.frame.lengths[1];
  });
}

/// Computes everything that needs more than double precision.
void complete(Specimen& specimen) {
  const Dissection dissection = dissect(specimen.triangle, specimen.plate);
  specimen.truth = integrate(dissection);
  const double value = specimen.truth.value.high;
  if (value > 0 && std::isfinite(value))
    specimen.conditioning =
        std::max(smallest_conditioning, conditioning(dissection, specimen.triangle, specimen.plate, value));
  if (in_front(dissection))
    specimen.thesis = thesis_formula(specimen.triangle, specimen.plate);
}

std::vector<Specimen> with_truth(const std::vector<Group>& groups, unsigned threads) {
  std::vector<Specimen> specimens;
  for (const Group& group : groups)
    for (const Triangle& triangle : group.triangles) {
      specimens.emplace_back();
      specimens.back().triangle = triangle;
      specimens.back().plate = group.plate;
    }
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < specimens.size(); i = next++)
      complete(specimens[i]);
    // MPFR caches constants and memory for each thread, and frees them only on request.
    mpfr_free_cache2(MPFR_FREE_LOCAL_CACHE);
  };
  std::vector<std::jthread> pool;
  for (unsigned i = 0; i < threads; ++i)
    pool.emplace_back(work);
  pool.clear();
  return specimens;
}

}  // namespace

double relative_error(double value, const Truth& truth) {
  const double expected = truth.value.high;
  if (expected == 0 || std::isinf(expected))
    return value == expected ? 0 : infinity;
  return std::isfinite(value) ? std::abs(((value - expected) - truth.value.low) / expected) : infinity;
}

std::optional<double> error_of(const Specimen& specimen, Judged method) {
  switch (method) {
  case Judged::exact:
    return std::max(relative_error(specimen.batched, specimen.truth),
                    relative_error(specimen.single, specimen.truth));
  case Judged::split:
    return relative_error(specimen.split, specimen.truth);
  case Judged::thesis:
    if (specimen.thesis)
      return relative_error(*specimen.thesis, specimen.truth);
  }
  return std::nullopt;
}

double error_over_allowed(const Specimen& specimen, std::size_t tolerance) {
  return relative_error(specimen.bounded[tolerance], specimen.truth) /
         (tolerances[tolerance] + limit * specimen.conditioning);
}

bool keeps_tolerances(const Specimen& specimen) {
  for (std::size_t k = 0; k < tolerances.size(); ++k)
    if (!(error_over_allowed(specimen, k) <= 1))
      return false;
  return true;
}

bool passes(const Specimen& specimen, const TriangleClass& of_class) {
  const double error = *error_of(specimen, Judged::exact);
  return specimen.truth.converged && error <= limit * specimen.conditioning &&
         (!of_class.well_behaved || error <= largest_well_behaved_error) && keeps_tolerances(specimen);
}

Assessment assess(const TriangleClass& of_class, const std::vector<Group>& groups, unsigned threads) {
  Assessment assessment{of_class, with_truth(groups, threads)};
  auto specimen = assessment.specimens.begin();
  for (const Group& group : groups) {
    const std::vector<double> batched = plate_integrals(group.triangles, group.plate);
    const TriangleBatch batch(group.triangles);
    std::array<std::vector<double>, tolerances.size()> bounded;
    for (std::size_t k = 0; k < tolerances.size(); ++k)
      bounded[k] = plate_integrals(batch, group.plate, tolerances[k]);
    const std::vector<double> split = plate_integrals(group.triangles, group.plate, Split{4});
    for (std::size_t i = 0; i < group.triangles.size(); ++i, ++specimen) {
      specimen->batched = batched[i];
      for (std::size_t k = 0; k < tolerances.size(); ++k)
        specimen->bounded[k] = bounded[k][i];
      specimen->split = split[i];
      specimen->single = plate_integral(group.triangles[i], group.plate);
    }
  }
  return assessment;
}

}  // namespace fringe::stress
