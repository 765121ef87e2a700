#pragma once

#include <type_traits>

#include "collision/gjk_filter.hpp"
#include "collision/support_template.hpp"

/// The search for the shortest distance in floating point, for the instruction set that `Lanes` represents.
namespace fringe::detail {

template <class Lanes>
class GjkDistanceFor : SupportFor<Lanes> {
 public:
  static void approach(const PlacedShape& a, const PlacedShape& b, DistanceAnswer& answer) {
    Support::with_supports(*a.shape, *b.shape, [&]<class A, class B>() {
      const Vec offset = Support::offset_of(a, b);
      search(A(a, offset), B(b, {0, 0, 0}), Support::extent_of(a, b, offset),
             Support::offset_of_centres(a, b, offset), answer);
    });
  }

  /// The same for hulls whose vertices are relative to a common origin.
  static void approach_in_place(const SupportShape& a, const SupportShape& b, DistanceAnswer& answer) {
    const double extent = a.bounding_radius + b.bounding_radius;
    const Vec start{a.centre[0] - b.centre[0], a.centre[1] - b.centre[1], a.centre[2] - b.centre[2]};
    const auto run = [&]<class Kind>(Kind of_a, Kind of_b) { search(of_a, of_b, extent, start, answer); };
    const std::uint32_t count = a.vertices.count < b.vertices.count ? b.vertices.count : a.vertices.count;
    if (count == VertexBlocks::size)
      run(InPlace<VertexBlocks::size>{a}, InPlace<VertexBlocks::size>{b});
    else if (count <= SupportShape::few_vertices)
      run(InPlace<SupportShape::few_vertices>{a}, InPlace<SupportShape::few_vertices>{b});
    else
      run(ManyInPlace{a}, ManyInPlace{b});
  }

 private:
  using Support = SupportFor<Lanes>;
  using Support::cross;
  using Support::dot;
  using Support::fused;
  using Support::minus;
  using Support::negated;
  using Support::sum_of_magnitudes;
  using typename Support::Curved;
  using typename Support::Local;
  using typename Support::ManyInPlace;
  using typename Support::SupportPoint;
  using typename Support::Vec;
  using Turned = typename Support::template Turned<Curved>;
  template <std::uint32_t most_vertices>
  using InPlace = typename Support::template InPlace<most_vertices>;

  /// A point of the Minkowski difference, and the iteration that found it.
  struct Point {
    Vec at;
    int round;

    bool operator==(const Vec& other) const { return at.x == other.x && at.y == other.y && at.z == other.z; }
  };

  /// A simplex of one to three points whose point nearest to the origin is inside of it. Without arrays, so
  /// that the compiler keeps it in registers.
  struct Face {
    Point a, b, c;
    double share_b, share_c;  ///< barycentric coordinates of the nearest point; that of `a` is the rest
    int size;
    Vec nearest;
    double square;  ///< squared distance of the nearest point from the origin

    Vec combination() const {
      Vec sum = a.at;
      if (size > 1)
        add(share_b, minus(b.at, a.at), sum);
      if (size > 2)
        add(share_c, minus(c.at, a.at), sum);
      return sum;
    }
    bool has(const Vec& point) const {
      return a == point || (size > 1 && b == point) || (size > 2 && c == point);
    }
  };

  /// The support points whose difference a point is.
  struct Source {
    Local a, b;
  };

  /// Finds the nearest point by the iteration of Gilbert, Johnson and Keerthi, from a point of the Minkowski
  /// difference on, with bounds of the distance.
  ///
  /// gnu::flatten is needed because the search is instantiated so often that the compiler would otherwise not
  /// inline even the dot products.
  template <class A, class B>
  [[gnu::flatten]] static void search(const A& moved_a, const B& moved_b, double extent, const Vec& start,
                                      DistanceAnswer& answer) {
    constexpr bool is_curved = std::is_same_v<A, Turned> || std::is_same_v<B, Turned>;
    answer.end = DistanceEnd::open;
    answer.size = 0;
    if (!(extent < 0x1p170 && extent > 0x1p-170))
      return;
    // Bounds the error of a support value along a unit vector; indices in products add to it.
    constexpr bool has_indices = A::has_indices_in_products || B::has_indices_in_products;
    const double error = (has_indices ? 0x1p-46 : 0x1p-47) * extent;
    const double error_of_volume = 0x1p-42 * extent * extent * extent, least_square = error * error;
    // The search is complete at this gain of a round, relative to the squared distance.
    constexpr double enough = 0x1p-41;
    // Polytopes take about six rounds, round shapes thirty.
    constexpr int most_rounds = 100;
    Source sources[most_rounds];
    Face face{};
    Vec v = start;
    if (!(dot(v, v) > least_square))
      v = {extent, 0, 0};
    double bound = 0;  // lower one, before rounding; for round shapes the best of all rounds
    Vec direction = v;
    for (int round = 0; round < most_rounds; ++round) {
      const SupportPoint on_a = moved_a.farthest(negated(v)), on_b = moved_b.farthest(v);
      const Point s{minus(on_a.at, on_b.at), round};
      sources[round] = {on_a.local, on_b.local};
      const double height = dot(s.at, v);
      if (face.size == 0) {
        put_vertex(s, face);
      } else {
        const double gain = face.square - height;
        // Rounding hides a gain below the first term.
        const bool is_last =
            gain <= fused(0x1p-53 * extent, sum_of_magnitudes(v), enough * face.square) || face.has(s.at);
        if (is_curved || is_last) {
          const double candidate = height / __builtin_sqrt(face.square);
          if (candidate > bound)
            bound = candidate, direction = v;
        }
        if (is_last)
          break;
        if (face.size < 3) {
          const Face old = face;
          if (old.size == 1)
            reduce_segment(old.a, s, face);
          else
            reduce_triangle<is_curved>(old.a, old.b, s, face);
          if (!(face.square < old.square)) {
            face = old;
            break;
          }
        } else {
          Face next{};
          if (!extend<is_curved>(face, s, error_of_volume, next, answer)) {
            if (answer.end == DistanceEnd::intersecting)
              put_pair(sources[round], 3, answer);
            break;
          }
          if (!(next.square < face.square))
            break;
          face = next;
        }
      }
      v = face.nearest;
      if (!(face.square > least_square))
        break;
    }
    record(face, sources, answer);
    if (answer.end == DistanceEnd::intersecting)
      return;
    // Only a convex combination of points bounds the distance from above, whatever the rounding of the
    // search.
    const Vec nearest = face.combination();
    const double length = __builtin_sqrt(dot(nearest, nearest)), lower = bound - error;
    answer.length = length;
    answer.lower_bound = lower > 0 ? (lower < length ? lower : length) : 0;
    const double scale = answer.lower_bound > 0 ? -1 / __builtin_sqrt(dot(direction, direction)) : 0;
    answer.direction[0] = scale * direction.x;
    answer.direction[1] = scale * direction.y;
    answer.direction[2] = scale * direction.z;
    if (length > error && length + error - answer.lower_bound <= DistanceAnswer::most_doubt * length &&
        face.share_b + face.share_c <= 1)
      answer.end = DistanceEnd::converged;
  }

  /// Writes a face into the answer; of a simplex that contains the origin, its first three points.
  static void record(const Face& face, const Source* sources, DistanceAnswer& answer) {
    put_pair(sources[face.a.round], 0, answer);
    if (answer.end == DistanceEnd::intersecting || face.size > 1)
      put_pair(sources[face.b.round], 1, answer);
    if (answer.end == DistanceEnd::intersecting || face.size > 2)
      put_pair(sources[face.c.round], 2, answer);
    if (answer.end == DistanceEnd::intersecting) {
      answer.size = 4;
      return;
    }
    answer.size = face.size;
    answer.weights[0] = 1 - face.share_b - face.share_c;
    answer.weights[1] = face.share_b;
    answer.weights[2] = face.share_c;
  }

  static void put_pair(const Source& source, int place, DistanceAnswer& answer) {
    answer.pairs[place] = {{source.a.at.x, source.a.at.y, source.a.at.z},
                           {source.b.at.x, source.b.at.y, source.b.at.z},
                           source.a.index,
                           source.b.index};
  }

  static void add(double factor, const Vec& vector, Vec& sum) {
    sum = {fused(factor, vector.x, sum.x), fused(factor, vector.y, sum.y), fused(factor, vector.z, sum.z)};
  }

  static void put_vertex(const Point& a, Face& face) {
    face.a = a;
    face.share_b = face.share_c = 0;
    face.size = 1;
    face.nearest = a.at;
    face.square = dot(a.at, a.at);
  }

  /// Finds the nearest face of a segment whose newest point is `a`, as in the functions below.
  static void reduce_segment(const Point& b, const Point& a, Face& face) {
    const Vec along = minus(b.at, a.at);
    const double share = -dot(along, a.at), square = dot(along, along);
    if (!(share > 0)) {
      put_vertex(a, face);
      return;
    }
    const double t = share < square ? share / square : 1;
    face.a = a;
    face.b = b;
    face.share_b = t;
    face.share_c = 0;
    face.size = 2;
    face.nearest = a.at;
    add(t, along, face.nearest);
    face.square = dot(face.nearest, face.nearest);
  }

  /// Finds the nearest face of a triangle. But for rounding, it is never the edge without `a`. Points
  /// of round shapes lie so close together that rounding turns the triangle's normal; its nearest point is
  /// then found from its barycentric coordinates.
  template <bool is_curved>
  static void reduce_triangle(const Point& b, const Point& c, const Point& a, Face& face) {
    const Vec ab = minus(b.at, a.at), ac = minus(c.at, a.at), normal = cross(ab, ac);
    const double square = dot(normal, normal);
    const double share_b = dot(cross(ac, a.at), normal), share_c = dot(cross(a.at, ab), normal);
    if (share_b > 0 && share_c > 0) {
      if (!(share_b + share_c < square)) {
        reduce_segment(b, c, face);
        return;
      }
      const double inverse = 1 / square;
      face.a = a;
      face.b = b;
      face.c = c;
      face.share_b = share_b * inverse;
      face.share_c = share_c * inverse;
      face.size = 3;
      if constexpr (is_curved) {
        face.nearest = face.combination();
        face.square = dot(face.nearest, face.nearest);
      } else {
        const double height = dot(normal, a.at), factor = height * inverse;
        face.nearest = {factor * normal.x, factor * normal.y, factor * normal.z};
        face.square = height * factor;
      }
      return;
    }
    if (share_b > 0) {
      reduce_segment(b, a, face);
      return;
    }
    reduce_segment(c, a, face);
    if (share_c > 0)
      return;
    // The origin is beyond both edges of the newest point.
    Face other{};
    reduce_segment(b, a, other);
    if (other.square < face.square)
      face = other;
  }

  /// Adds a point to a triangle and finds the nearest face of the tetrahedron. Returns false if it contains
  /// the origin, which `answer` then says, or if rounding hides that.
  template <bool is_curved>
  static bool extend(const Face& face, const Point& added, double error, Face& next, DistanceAnswer& answer) {
    const Vec& s = added.at;
    const Vec to_a = minus(face.a.at, s), to_b = minus(face.b.at, s), to_c = minus(face.c.at, s);
    const Vec normal_a = cross(to_b, to_c), normal_b = cross(to_c, to_a), normal_c = cross(to_a, to_b);
    const double volume = dot(normal_c, to_c), sign = volume < 0 ? -1 : 1;
    // Barycentric coordinates of the origin times the volume.
    const double share_a = -sign * dot(normal_a, s), share_b = -sign * dot(normal_b, s),
                 share_c = -sign * dot(normal_c, s), whole = sign * volume;
    const bool is_flat = !(whole > error);
    if (!is_flat && share_a >= 0 && share_b >= 0 && share_c >= 0) {
      const double share = whole - share_a - share_b - share_c, inverse = 1 / whole;
      if (share_a > error && share_b > error && share_c > error && share > error) {
        answer.end = DistanceEnd::intersecting;
        answer.weights[0] = share_a * inverse;
        answer.weights[1] = share_b * inverse;
        answer.weights[2] = share_c * inverse;
        answer.weights[3] = share * inverse;
      }
      return false;
    }
    // The nearest point is on a face beyond which the origin lies.
    next.square = __builtin_inf();
    const auto take = [&](const Point& b, const Point& c) {
      Face candidate{};
      reduce_triangle<is_curved>(b, c, added, candidate);
      if (candidate.square < next.square)
        next = candidate;
    };
    if (is_flat || share_a < 0)
      take(face.b, face.c);
    if (is_flat || share_b < 0)
      take(face.a, face.c);
    if (is_flat || share_c < 0)
      take(face.a, face.b);
    return true;
  }
};

}  // namespace fringe::detail
