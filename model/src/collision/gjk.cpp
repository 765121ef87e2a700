#include "fringe/gjk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "collision/exact_search.hpp"
#include "collision/float_search.hpp"
#include "collision/gjk_filter.hpp"
#include "collision/hull_pair.hpp"
#include "simd/dispatch.hpp"

namespace fringe {
namespace {

using detail::ExactHulls;
using detail::ExactNearest;
using detail::Goal;
using Eigen::Vector3d;

/// Converts the result of the exact search into an answer with a certificate.
GjkAnswer answer_of(const ExactHulls& exact, const ExactNearest& nearest) {
  if (detail::dot(nearest.point, nearest.point).is_zero())
    return {true, SimplexAroundOrigin{nearest.simplex}};
  const Vector3d direction = detail::direction_of(detail::negated(nearest.point));
  if (detail::separates(exact, direction))
    return {false, SeparatingDirection{direction}};
  return {false, SeparatingSimplex{nearest.simplex}};
}

/// Copies the vertices of a small hull, relative to an origin, into the layout of one filter query.
class PassingHull {
 public:
  PassingHull(detail::Vertices vertices, const Vector3d& origin) {
    constexpr std::size_t block = detail::VertexBlocks::size;
    const std::size_t count = (vertices.size() + block - 1) / block * block;
    double largest = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Vector3d point = vertices[std::min(i, vertices.size() - 1)] - origin;
      for (std::size_t k = 0; k < 3; ++k) {
        const double coordinate = point[static_cast<Eigen::Index>(k)];
        coordinates_[i / block * 3 * block + k * block + i % block] = coordinate;
        largest = std::max(largest, std::abs(coordinate));
      }
    }
    // Any point of the hull: the midpoint of two vertices that are not neighbours in most lists.
    const Vector3d middle = (vertices.front() - origin) / 2 + (vertices[vertices.size() / 2] - origin) / 2;
    std::copy(middle.begin(), middle.end(), support_.middle);
    constexpr double root_of_3 = 1.7320508075688774;
    support_.reach = root_of_3 * (1 + 0x1p-50) * largest;
    support_.vertices = {coordinates_.data(), static_cast<std::uint32_t>(count),
                         static_cast<std::uint32_t>(vertices.size() - 1)};
  }
  PassingHull(const PassingHull&) = delete;
  PassingHull& operator=(const PassingHull&) = delete;

  detail::PlacedShape placed() const { return {&support_, identity_.data()}; }

 private:
  std::array<double, 3 * detail::SupportShape::few_vertices> coordinates_;
  detail::SupportShape support_{};
  Eigen::Matrix4d identity_ = Eigen::Matrix4d::Identity();
};

/// Answers the query by the filter; returns nothing if the filter leaves it undecided. For larger hulls,
/// copying the vertices would take longer than the filter saves.
std::optional<GjkAnswer> quick_answer(const detail::HullPair& hulls) {
  if (std::max(hulls.a.size(), hulls.b.size()) > detail::SupportShape::few_vertices)
    return std::nullopt;
  const PassingHull a(hulls.a, hulls.origin), b(hulls.b, hulls.origin);
  detail::GjkFilterAnswer found;
  detail::best_kernels<detail::GjkFilter>().prove(a.placed(), b.placed(), found);
  if (found.verdict == detail::Verdict::disjoint)
    return GjkAnswer{false, SeparatingDirection{Vector3d(found.direction)}};
  if (found.verdict == detail::Verdict::undecided)
    return std::nullopt;
  PairSimplex simplex;
  for (int i = 0; i < found.size; ++i)
    simplex.pairs[simplex.size++] = {found.pairs[i].a, found.pairs[i].b};
  return GjkAnswer{true, SimplexAroundOrigin{simplex}};
}

}  // namespace

GjkAnswer gjk_intersects(std::span<const Vector3d> a, std::span<const Vector3d> b) {
  const detail::HullPair hulls = detail::hull_pair(a, b);
  if (const std::optional<GjkAnswer> answer = quick_answer(hulls))
    return *answer;
  const auto [answer, reached] = detail::float_search(hulls, Goal::decision);
  if (answer)
    return *answer;
  const ExactHulls exact = detail::exact_hulls(hulls);
  return answer_of(exact, detail::exact_search(exact, reached, Goal::decision));
}

HullDistance gjk_distance(std::span<const Vector3d> a, std::span<const Vector3d> b) {
  const detail::HullPair hulls = detail::hull_pair(a, b);
  const ExactHulls exact = detail::exact_hulls(hulls);
  const ExactNearest nearest =
      detail::exact_search(exact, detail::float_search(hulls, Goal::distance).reached, Goal::distance);
  return detail::rounded_distance(exact, nearest);
}

}  // namespace fringe
