#include "integral/surface_integral.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include <fmt/format.h>

#include "fringe/batch_integral.hpp"
#include "fringe/plate_integral.hpp"
#include "geometry/plate_frame.hpp"
#include "integral/derivative/plate_wrench.hpp"
#include "integral/facing.hpp"
#include "integral/nearest_plate.hpp"
#include "integral/node_sums.hpp"
#include "numeric/infinity.hpp"

namespace fringe::detail {
namespace {

/// Relative tolerance of the division of a surface among its nearest plates when no tolerance is given. Below
/// it, the rounding of the coordinates decides which plate is the nearest one.
constexpr double division_tolerance = 1e-12;

/// Returns whether a triangle touches a plate, from whatever side.
bool touches(const Triangle& triangle, const Rectangle& plate) {
  return std::isinf(plate_integral(triangle, plate));
}

/// Returns whether a triangle counts for a plate: always for FaceRule::all, otherwise when it sees or touches
/// the plate.
bool counts(const Triangle& triangle, const Rectangle& plate, FaceRule faces) {
  if (faces == FaceRule::all)
    return true;
  const Sight seen = sight(triangle, plate);
  return seen == Sight::outward || (seen == Sight::grazing && touches(triangle, plate));
}

/// Returns the triangles that count for a plate.
std::vector<Triangle> triangles_counting(std::span<const Triangle> triangles, const Rectangle& plate,
                                         FaceRule faces) {
  std::vector<Triangle> counted;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(counted),
               [&](const Triangle& triangle) { return counts(triangle, plate, faces); });
  return counted;
}

/// Adds Σ∫dA/d over triangles to the integral of a plate.
void add(SurfaceIntegral& integral, std::span<const Triangle> triangles, const Rectangle& plate,
         const Method& method) {
  const std::vector<double> values = plate_integrals(triangles, plate, method);
  integral.value += std::accumulate(values.begin(), values.end(), 0.0);
  integral.counts.triangles_evaluated += triangles.size();
}

SurfaceIntegral sum_one_by_one(std::span<const Rectangle> plates, std::span<const Triangle> triangles,
                               const IntegralOptions& options) {
  SurfaceIntegral integral;
  for (const Rectangle& plate : plates)
    if (options.faces == FaceRule::all)
      add(integral, triangles, plate, options.method);
    else
      add(integral, triangles_counting(triangles, plate, options.faces), plate, options.method);
  return integral;
}

/// Returns the indices of the plates for which a triangle counts.
std::vector<std::size_t> plates_counting(std::span<const Rectangle> plates, const Triangle& triangle,
                                         FaceRule faces) {
  std::vector<std::size_t> counting;
  for (std::size_t k = 0; k < plates.size(); ++k)
    if (counts(triangle, plates[k], faces))
      counting.push_back(k);
  return counting;
}

/// Divides triangles among their nearest plates.
NearestPlates divided(std::span<const Rectangle> plates, std::span<const Triangle> triangles,
                      const IntegralOptions& options) {
  NearestPlates division(plates);
  for (const Triangle& triangle : triangles)
    division.add(triangle, plates_counting(plates, triangle, options.faces));
  division.refine(options.tolerance > 0 ? options.tolerance : division_tolerance);
  return division;
}

SurfaceIntegral nearest_plate_exactly(std::span<const Rectangle> plates, std::span<const Triangle> triangles,
                                      const IntegralOptions& options) {
  const NearestPlates division = divided(plates, triangles, options);
  SurfaceIntegral integral;
  integral.bound = division.bound();
  const std::vector<std::vector<Triangle>> shares = division.shares();
  for (std::size_t k = 0; k < plates.size(); ++k)
    add(integral, shares[k], plates[k], options.method);
  return integral;
}

/// Computes ∫dA/min_k d_k over a triangle as a sum over nodes; +infinity when the triangle touches a plate.
double nearest_node_sum(std::span<const Rectangle> plates, const Triangle& triangle, const Method& method) {
  std::vector<PlateFrame> frames;
  frames.reserve(plates.size());
  for (const Rectangle& plate : plates) {
    // A sum over nodes is finite even where the integral diverges.
    if (touches(triangle, plate))
      return infinity;
    frames.push_back(plate_frame(plate));
  }
  const auto least_distance = [&](const Eigen::Vector3d& point) {
    double least = infinity;
    for (const PlateFrame& plate : frames)
      least = std::min(least, distance(plate, plate.axes * (point - plate.corner)));
    return least;
  };
  if (const auto* split = std::get_if<Split>(&method))
    return split_integral(triangle, twice_area(triangle), split->levels, least_distance);
  return gauss_integral(triangle, twice_area(triangle), gauss_rule(std::get<Gauss>(method).points),
                        least_distance);
}

SurfaceIntegral nearest_plate_by_nodes(std::span<const Rectangle> plates, std::span<const Triangle> triangles,
                                       const IntegralOptions& options) {
  SurfaceIntegral integral;
  std::vector<std::vector<Triangle>> with_one_plate(plates.size());
  for (const Triangle& triangle : triangles) {
    const std::vector<std::size_t> counting = plates_counting(plates, triangle, options.faces);
    if (counting.size() == 1) {
      with_one_plate[counting[0]].push_back(triangle);
    } else if (counting.size() > 1) {
      std::vector<Rectangle> several;
      several.reserve(counting.size());
      for (const std::size_t k : counting)
        several.push_back(plates[k]);
      integral.value += nearest_node_sum(several, triangle, options.method);
      integral.counts.triangles_evaluated += several.size();
    }
  }
  for (std::size_t k = 0; k < plates.size(); ++k)
    add(integral, with_one_plate[k], plates[k], options.method);
  return integral;
}

/// Adds up the integrals over all triangles for each plate, several triangles per register.
SurfaceIntegral sum_in_batches(const Surface& surface, std::span<const Rectangle> plates, double tolerance) {
  SurfaceIntegral integral;
  for (const BoundedIntegral& total : total_integrals(surface.batch, plates, tolerance)) {
    integral.value += total.value;
    integral.bound += total.bound;
  }
  integral.counts.triangles_evaluated = plates.size() * surface.batch.size();
  return integral;
}

SurfaceIntegral sum_by_tree(const SurfaceTree& tree, std::span<const Rectangle> plates,
                            const IntegralOptions& options, double allowance) {
  SurfaceIntegral integral;
  for (const Rectangle& plate : plates) {
    const TreeIntegral part = tree.integrate(plate, options.tolerance,
                                             allowance / static_cast<double>(plates.size()), options.faces);
    integral.value += part.value;
    integral.bound += part.bound;
    integral.counts.triangles_evaluated += part.counts.triangles_evaluated;
    integral.counts.triangles_lumped += part.counts.triangles_lumped;
    integral.counts.triangles_skipped += part.counts.triangles_skipped;
    integral.counts.nodes_lumped += part.counts.nodes_lumped;
  }
  return integral;
}

SurfaceIntegral integrate(const Surface& surface, std::span<const Rectangle> plates,
                          const IntegralOptions& options, double allowance) {
  const bool exact = std::holds_alternative<Exact>(options.method);
  if (options.plates == PlateRule::nearest)
    return exact ? nearest_plate_exactly(plates, surface.triangles, options)
                 : nearest_plate_by_nodes(plates, surface.triangles, options);
  if (exact && surface.tree)
    return sum_by_tree(*surface.tree, plates, options, allowance);
  if (exact && options.faces == FaceRule::all)
    return sum_in_batches(surface, plates, options.tolerance);
  return sum_one_by_one(plates, surface.triangles, options);
}

}  // namespace

Surface make_surface(std::vector<Triangle> triangles) {
  TriangleBatch batch(triangles);
  double total_area = 0;
  Eigen::Vector3d first_moment = Eigen::Vector3d::Zero();
  // Moments are taken about a point of the surface, which avoids cancellation far from the origin.
  const Eigen::Vector3d origin = triangles.front()[0];
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& [a, b, c] = triangles[i];
    const double area = batch.twice_area()[i] / 2;
    total_area += area;
    first_moment += area / 3 * ((a - origin) + (b - origin) + (c - origin));
  }
  const Eigen::Vector3d centroid =
      total_area > 0 ? Eigen::Vector3d(origin + first_moment / total_area) : origin;
  double squared_radius = 0, squared_radius_moment = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Eigen::Vector3d a = triangles[i][0] - centroid, b = triangles[i][1] - centroid,
                          c = triangles[i][2] - centroid;
    squared_radius = std::max({squared_radius, a.squaredNorm(), b.squaredNorm(), c.squaredNorm()});
    squared_radius_moment +=
        batch.twice_area()[i] / 12 *
        (a.squaredNorm() + b.squaredNorm() + c.squaredNorm() + a.dot(b) + b.dot(c) + c.dot(a));
  }
  return {std::move(triangles),      std::move(batch), std::nullopt,         centroid,
          std::sqrt(squared_radius), total_area,       squared_radius_moment};
}

Enclosure enclosure(const Surface& surface, const Eigen::Vector3d& centroid,
                    std::span<const PlateFrame> plates) {
  Enclosure result;
  for (const PlateFrame& plate : plates) {
    const double to_centroid = distance(plate, plate.axes * (centroid - plate.corner));
    const double farthest = to_centroid + surface.radius, nearest = to_centroid - surface.radius;
    if (!(nearest > 0)) {
      result.lower += surface.area / farthest;
      result.upper = infinity;
      continue;
    }
    const double middle = surface.area / to_centroid;
    const double error = surface.squared_radius_moment / (nearest * nearest * nearest);
    result.lower += std::max(surface.area / farthest, middle - error);
    result.upper += std::min(surface.area / nearest, middle + error);
  }
  return result;
}

SurfaceIntegral surface_integral(const Surface& surface, std::span<const Rectangle> plates,
                                 const IntegralOptions& options, double allowance) {
  SurfaceIntegral integral = integrate(surface, plates, options, allowance);
  if (std::isinf(integral.value))
    integral.bound = 0;
  integral.counts.objects_evaluated = 1;
  return integral;
}

Wrench surface_wrench(const Surface& surface, std::span<const Rectangle> plates,
                      const IntegralOptions& options) {
  Wrench sum;
  if (options.plates == PlateRule::nearest) {
    const std::vector<std::vector<Triangle>> shares = divided(plates, surface.triangles, options).shares();
    for (std::size_t k = 0; k < plates.size(); ++k)
      sum += plate_wrench(TriangleBatch(shares[k]), plates[k]);
    return sum;
  }
  for (const Rectangle& plate : plates)
    if (options.faces == FaceRule::all)
      sum += plate_wrench(surface.batch, plate);
    else
      sum += plate_wrench(TriangleBatch(triangles_counting(surface.triangles, plate, options.faces)), plate);
  return sum;
}

}  // namespace fringe::detail
