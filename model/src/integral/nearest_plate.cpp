#include "integral/nearest_plate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "fringe/plate_integral.hpp"
#include "geometry/clipping.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Refinement stops when the undecided fragments number this many times the original ones. A border that
/// curves through a whole triangle needs some hundred parts for ten digits; more parts mean that rounding
/// keeps the bound from falling.
constexpr std::size_t most_parts_per_fragment = 10'000;

/// Bounds of the distance to one plate over a triangle. The distance is a convex function: it is nowhere
/// above the linear interpolation of its values at the vertices, and nowhere below its tangent plane at the
/// centroid.
struct DistanceRange {
  double at_centroid;
  Vector3d at_vertices;
  Vector3d tangent;  ///< the tangent plane's values at the vertices

  double least() const { return std::max(0.0, tangent.minCoeff()); }
  double largest() const { return at_vertices.maxCoeff(); }
};

DistanceRange distance_range(const PlateFrame& plate, const Triangle& triangle) {
  const LocalTriangle local = to_local(plate, triangle);
  const Vector3d centroid = (local[0] + local[1] + local[2]) / 3;
  const Vector3d away(centroid.x() - std::clamp(centroid.x(), 0.0, plate.length_u),
                      centroid.y() - std::clamp(centroid.y(), 0.0, plate.length_v), centroid.z());
  DistanceRange range{away.norm(), {}, {}};
  const Vector3d slope = range.at_centroid > 0 ? Vector3d(away / range.at_centroid) : Vector3d::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Vector3d& vertex = local[static_cast<std::size_t>(i)];
    range.at_vertices[i] = distance(plate, vertex);
    range.tangent[i] = range.at_centroid + slope.dot(vertex - centroid);
  }
  return range;
}

/// Bounds the error of a distance that comes from the rounding of coordinates. Distances that differ by less
/// count as equal.
double rounding_of_distance(const PlateFrame& plate, const Triangle& triangle) {
  double largest = plate.corner.cwiseAbs().maxCoeff();
  for (const Vector3d& vertex : triangle)
    largest = std::max(largest, vertex.cwiseAbs().maxCoeff());
  // A subtraction and a rotation cause a handful of rounding errors in each coordinate.
  return 8 * std::numeric_limits<double>::epsilon() * (largest + plate.length_u + plate.length_v);
}

/// Returns whether the plate with the range `near` is the nearer one on the whole triangle: a convex function
/// minus an affine one takes its maximum at a vertex.
bool nearer_throughout(const DistanceRange& near, const DistanceRange& far) {
  return (near.at_vertices.array() <= far.tangent.array()).all();
}

/// The function d_j² − d_k² on a triangle that lies in one cell of either plate, where it is quadratic.
struct SquareDifference {
  Vector3d at_vertices;
  /// The coefficients of λ₁λ₂, λ₂λ₀, λ₀λ₁ of the function minus the linear interpolation of its vertex
  /// values.
  Vector3d bulges;
  double rounding;  ///< bound of the rounding error: values below it have no certain sign

  /// Returns the coefficient of 2λ₁λ₂, 2λ₂λ₀ or 2λ₀λ₁ in the Bernstein form.
  double mixed(Eigen::Index i) const {
    return (at_vertices[(i + 1) % 3] + at_vertices[(i + 2) % 3] + bulges[i]) / 2;
  }
  /// Bounds the function from below: it lies between the smallest and the largest coefficient of its
  /// Bernstein form.
  double least() const { return std::min({at_vertices.minCoeff(), mixed(0), mixed(1), mixed(2)}); }
  double largest() const { return std::max({at_vertices.maxCoeff(), mixed(0), mixed(1), mixed(2)}); }
  /// Bounds how far the function rises above the linear interpolation of its vertex values, by λ₁λ₂ + λ₂λ₀ +
  /// λ₀λ₁ ≤ 1/3.
  double most_above() const { return std::max(0.0, bulges.maxCoeff()) / 3; }
  double most_below() const { return std::max(0.0, -bulges.minCoeff()) / 3; }
};

std::array<Vector3d, 3> vectors_from_plate(const PlateFrame& plate, Cell cell, const Triangle& triangle) {
  const LocalTriangle local = to_local(plate, triangle);
  return {from_plate(plate, cell, local[0]), from_plate(plate, cell, local[1]),
          from_plate(plate, cell, local[2])};
}

SquareDifference square_difference(const PlateFrame& plate_j, Cell cell_j, const PlateFrame& plate_k,
                                   Cell cell_k, const Triangle& triangle) {
  const std::array<Vector3d, 3> from_j = vectors_from_plate(plate_j, cell_j, triangle),
                                from_k = vectors_from_plate(plate_k, cell_k, triangle);
  SquareDifference difference{};
  double farthest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3, last = (i + 2) % 3;
    const auto index = static_cast<Eigen::Index>(i);
    const double square_j = from_j[i].squaredNorm(), square_k = from_k[i].squaredNorm();
    difference.at_vertices[index] = square_j - square_k;
    difference.bulges[index] =
        (from_k[next] - from_k[last]).squaredNorm() - (from_j[next] - from_j[last]).squaredNorm();
    farthest = std::max({farthest, square_j, square_k});
  }
  difference.rounding = 2 * std::sqrt(farthest) *
                        (rounding_of_distance(plate_j, triangle) + rounding_of_distance(plate_k, triangle));
  return difference;
}

/// Returns a part of a fragment with one candidate removed.
Fragment without(const Fragment& fragment, const Triangle& part, std::size_t candidate) {
  Fragment rest{part, fragment.candidates};
  rest.candidates.erase(rest.candidates.begin() + static_cast<std::ptrdiff_t>(candidate));
  return rest;
}

/// Returns the index of the range with the smallest distance at the centroid.
std::size_t position_of_least(const std::vector<DistanceRange>& ranges) {
  return static_cast<std::size_t>(std::min_element(ranges.begin(), ranges.end(),
                                                   [](const DistanceRange& a, const DistanceRange& b) {
                                                     return a.at_centroid < b.at_centroid;
                                                   }) -
                                  ranges.begin());
}

std::vector<DistanceRange> distance_ranges(const std::vector<PlateFrame>& frames, const Fragment& fragment) {
  std::vector<DistanceRange> ranges;
  ranges.reserve(fragment.candidates.size());
  for (const Candidate& candidate : fragment.candidates)
    ranges.push_back(distance_range(frames[candidate.plate], fragment.triangle));
  return ranges;
}

/// Removes the candidates that are nowhere nearer than the nearest one (by the distance at the centroid),
/// moves the nearest to the front and the second nearest to the second place.
void sort_out(const std::vector<PlateFrame>& frames, Fragment& fragment) {
  std::vector<DistanceRange> ranges = distance_ranges(frames, fragment);
  const std::size_t nearest = position_of_least(ranges);
  std::swap(ranges[0], ranges[nearest]);
  std::swap(fragment.candidates[0], fragment.candidates[nearest]);
  std::size_t kept = 1;
  for (std::size_t i = 1; i < ranges.size(); ++i) {
    if (nearer_throughout(ranges[0], ranges[i]))
      continue;
    ranges[kept] = ranges[i];
    fragment.candidates[kept] = fragment.candidates[i];
    if (ranges[kept].at_centroid < ranges[1].at_centroid) {
      std::swap(ranges[kept], ranges[1]);
      std::swap(fragment.candidates[kept], fragment.candidates[1]);
    }
    ++kept;
  }
  fragment.candidates.resize(kept);
}

/// Bounds ∫(1/d_k − 1/d_j)⁺ over a fragment from above, where j is the fragment's first candidate and k
/// another plate.
double gap_to(const std::vector<PlateFrame>& frames, std::span<const Rectangle> plates,
              const Fragment& fragment, const Candidate& other) {
  const Candidate& first = fragment.candidates[0];
  const DistanceRange j = distance_range(frames[first.plate], fragment.triangle),
                      k = distance_range(frames[other.plate], fragment.triangle);
  const double least_k = k.least();
  if (least_k == 0)
    return plate_integral(fragment.triangle, plates[other.plate]);
  // Only points that are farther from j than from k contribute; their distance from j is at least this.
  const double least_j = std::max(j.least(), least_k);
  double difference = std::max(0.0, (j.at_vertices - k.tangent).maxCoeff());
  if (first.cell && other.cell) {
    const SquareDifference squares = square_difference(frames[first.plate], *first.cell, frames[other.plate],
                                                       *other.cell, fragment.triangle);
    difference = std::min(difference, std::max(0.0, squares.largest()) / (least_j + least_k));
  }
  return twice_area(fragment.triangle) / 2 * std::min(1.0, difference / least_j) / least_k;
}

}  // namespace

NearestPlates::NearestPlates(std::span<const Rectangle> plates) : plates_(plates), decided_(plates.size()) {
  for (const Rectangle& plate : plates)
    frames_.push_back(plate_frame(plate));
}

void NearestPlates::add(const Triangle& triangle, std::span<const std::size_t> plates) {
  Fragment whole{triangle, {}};
  double largest = std::numeric_limits<double>::infinity();
  for (const std::size_t plate : plates) {
    const DistanceRange range = distance_range(frames_[plate], triangle);
    // A triangle that touches a plate is not divided, because rounding would decide whether its parts still
    // touch.
    if (plates.size() > 1 && range.least() <= rounding_of_distance(frames_[plate], triangle) &&
        std::isinf(plate_integral(triangle, plates_[plate]))) {
      decided_[plate].push_back(triangle);
      return;
    }
    largest = std::min(largest, range.largest());
    whole.candidates.push_back({plate, std::nullopt});
  }
  if (whole.candidates.empty())
    return;
  least_integral_ += twice_area(triangle) / 2 / largest;
  settle(std::move(whole));
}

void NearestPlates::settle(Fragment fragment) {
  if (twice_area(fragment.triangle) == 0)
    return;
  if (fragment.candidates.size() > 1)
    sort_out(frames_, fragment);
  if (fragment.candidates.size() == 1)
    decided_[fragment.candidates[0].plate].push_back(fragment.triangle);
  else if (!fragment.candidates[0].cell)
    cut_to_cells(fragment, 0);
  else if (!fragment.candidates[1].cell)
    cut_to_cells(fragment, 1);
  else
    cut_between_first_two(fragment);
}

void NearestPlates::cut_to_cells(const Fragment& fragment, std::size_t candidate) {
  const PlateFrame& plate = frames_[fragment.candidates[candidate].plate];
  const auto by_strips = [&](const Triangle& triangle, int axis, double length, const auto& take) {
    const LocalTriangle local = to_local(plate, triangle);
    const auto [below, within, above] =
        slices(triangle, {local[0][axis], local[1][axis], local[2][axis]}, 0, length);
    for (const Triangle& part : below)
      take(part, Strip::below);
    for (const Triangle& part : within)
      take(part, Strip::within);
    for (const Triangle& part : above)
      take(part, Strip::above);
  };
  by_strips(fragment.triangle, 0, plate.length_u, [&](const Triangle& in_u, Strip u) {
    by_strips(in_u, 1, plate.length_v, [&](const Triangle& part, Strip v) {
      Fragment in_cell{part, fragment.candidates};
      in_cell.candidates[candidate].cell = Cell{u, v};
      settle(std::move(in_cell));
    });
  });
}

void NearestPlates::cut_between_first_two(const Fragment& fragment) {
  const Candidate &j = fragment.candidates[0], &k = fragment.candidates[1];
  const SquareDifference difference =
      square_difference(frames_[j.plate], *j.cell, frames_[k.plate], *k.cell, fragment.triangle);
  if (difference.largest() <= difference.rounding)
    return settle(without(fragment, fragment.triangle, 1));
  if (difference.least() >= -difference.rounding)
    return settle(without(fragment, fragment.triangle, 0));
  // Where the linear interpolation of the vertex values is far enough from zero, the sign is certain. A strip
  // remains, which is the narrower the straighter the border between the two plates is.
  const auto [nearer_first, strip, nearer_second] =
      slices(fragment.triangle, difference.at_vertices, -difference.most_above(), difference.most_below());
  for (const Triangle& part : nearer_first)
    settle(without(fragment, part, 1));
  for (const Triangle& part : nearer_second)
    settle(without(fragment, part, 0));
  for (const Triangle& part : strip)
    leave_undecided({part, fragment.candidates});
}

void NearestPlates::leave_undecided(Fragment fragment) {
  double gap = 0;
  for (std::size_t i = 1; i < fragment.candidates.size(); ++i)
    gap += gap_to(frames_, plates_, fragment, fragment.candidates[i]);
  undecided_.push_back({std::move(fragment), gap});
}

void NearestPlates::refine(double tolerance) {
  const double allowed = tolerance * least_integral_;
  const std::size_t most_undecided = undecided_.size() * most_parts_per_fragment;
  while (bound() > allowed && undecided_.size() <= most_undecided) {
    // At least one gap is above the mean, so every round makes progress.
    const double small_enough = allowed / static_cast<double>(undecided_.size());
    std::vector<Undecided> coarse;
    const auto first_coarse = std::partition(undecided_.begin(), undecided_.end(),
                                             [=](const Undecided& part) { return part.gap <= small_enough; });
    std::move(first_coarse, undecided_.end(), std::back_inserter(coarse));
    undecided_.erase(first_coarse, undecided_.end());
    for (const auto& [fragment, gap] : coarse)
      for (const Triangle& half : halves(fragment.triangle))
        settle({half, fragment.candidates});
  }
}

std::vector<std::vector<Triangle>> NearestPlates::shares() const {
  std::vector<std::vector<Triangle>> result = decided_;
  for (const auto& [fragment, gap] : undecided_)
    result[fragment.candidates[0].plate].push_back(fragment.triangle);
  return result;
}

double NearestPlates::bound() const {
  return std::accumulate(undecided_.begin(), undecided_.end(), 0.0,
                         [](double sum, const Undecided& part) { return sum + part.gap; });
}

}  // namespace fringe::detail
