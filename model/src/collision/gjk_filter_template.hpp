#pragma once

#include "collision/box_gap_template.hpp"
#include "collision/gjk_distance_template.hpp"
#include "collision/gjk_filter.hpp"
#include "collision/hull_distance_template.hpp"
#include "collision/precise_distance_template.hpp"
#include "collision/support_template.hpp"

/// The filtered GJK search for the instruction set that `Lanes` represents.
namespace fringe::detail {

template <class Lanes>
class GjkFilterFor : SupportFor<Lanes> {
 public:
  static Verdict decide(const PlacedShape& a, const PlacedShape& b) {
    GjkFilterAnswer answer;
    return dispatched<false>(a, b, answer);
  }

  static void prove(const PlacedShape& a, const PlacedShape& b, GjkFilterAnswer& answer) {
    answer.verdict = dispatched<true>(a, b, answer);
  }

  static constexpr GjkFilter kernels{&decide,
                                     &prove,
                                     &GjkDistanceFor<Lanes>::approach,
                                     &PreciseDistanceFor<Lanes>::refine,
                                     &HullDistanceFor<Lanes>::arrange,
                                     &HullDistanceFor<Lanes>::distance,
                                     &SupportFor<Lanes>::support,
                                     &BoxGapFor<Lanes>::box_gap};

 private:
  using Support = SupportFor<Lanes>;
  using Support::cross;
  using Support::dot;
  using Support::fused;
  using Support::minus;
  using Support::negated;
  using Support::plus;
  using Support::sum_of_magnitudes;
  using typename Support::Local;
  using typename Support::SupportPoint;
  using typename Support::Vec;

  /// A point of the Minkowski difference, and the iteration that found it.
  struct Point {
    Vec at;
    int round;
  };

  /// The support points whose difference a point of the Minkowski difference is.
  struct Source {
    Local a, b;
  };

  /// Decides by the search for the two kinds of shape, and two boxes by their axes if no proof is asked for.
  template <bool with_proof>
  static Verdict dispatched(const PlacedShape& a, const PlacedShape& b, GjkFilterAnswer& answer) {
    if (!with_proof && a.shape->kind == ShapeKind::box && b.shape->kind == ShapeKind::box) {
      const Verdict verdict = BoxGapFor<Lanes>::compare(a, b);
      if (verdict != Verdict::undecided)
        return verdict;
    }
    return Support::with_supports(*a.shape, *b.shape,
                                  [&]<class A, class B>() { return search<with_proof, A, B>(a, b, answer); });
  }

  /// Up to four points of the Minkowski difference. A triangle also stores the products that the next
  /// iteration needs.
  struct Simplex {
    Point points[4];
    int size;
    Vec crosses[3];      ///< cross products of the points 1 and 2, 2 and 0, 0 and 1
    double determinant;  ///< of the points 0, 1 and 2
  };

  /// Runs the filtered GJK iteration. Without a proof to give, the simplex starts with an inner point of the
  /// Minkowski difference that is no difference of support points; this saves one iteration.
  ///
  /// gnu::flatten is needed because the search is instantiated so often that the compiler would otherwise not
  /// inline even the dot products.
  template <bool with_proof, class A, class B>
  [[gnu::flatten]] static Verdict search(const PlacedShape& a, const PlacedShape& b,
                                         GjkFilterAnswer& answer) {
    const Vec offset = Support::offset_of(a, b);
    const double extent = Support::extent_of(a, b, offset);
    answer.size = 0;
    if (!(extent < 0x1p170 && extent > 0x1p-170))
      return Verdict::undecided;
    constexpr double error_per_product = 0x1p-46, error_per_determinant = 0x1p-46;
    // Below these, products could have lost digits to underflow.
    constexpr double smallest_product = 0x1p-860, smallest_direction = 0x1p-900;
    const double error_of_determinants = error_per_determinant * extent * extent * extent;
    const Vec inside = Support::offset_of_centres(a, b, offset);
    Vec direction = negated(inside);
    const A moved_a(a, offset);
    const B moved_b(b, {0, 0, 0});
    Simplex simplex{};
    simplex.points[0] = {inside, 0};
    simplex.size = with_proof ? 0 : 1;
    Verdict verdict = Verdict::undecided;
    constexpr int most_rounds = 32;
    Source sources[with_proof ? most_rounds : 1];
    for (int round = 0; round < most_rounds; ++round) {
      double magnitude = sum_of_magnitudes(direction);
      if (!(magnitude > smallest_direction)) {
        if (round > 0)
          break;
        direction = {extent, 0, 0}, magnitude = extent;
      }
      const SupportPoint on_a = moved_a.farthest(direction), on_b = moved_b.farthest(negated(direction));
      const Point s{minus(on_a.at, on_b.at), round};
      if constexpr (with_proof)
        sources[round] = {on_a.local, on_b.local};
      if (-dot(s.at, direction) > fused(error_per_product * extent, magnitude, smallest_product)) {
        verdict = Verdict::disjoint;
        break;
      }
      if (simplex.size == 3) {
        verdict = add_to_triangle(simplex, s, direction, error_of_determinants);
        if (simplex.size == 4)
          break;
      } else {
        simplex.points[simplex.size++] = s;
        if (simplex.size == 3)
          reduce_triangle(simplex, direction);
        else if (simplex.size == 2)
          reduce_segment(simplex, direction);
        else
          direction = negated(s.at);
      }
    }
    if constexpr (with_proof)
      record(simplex, sources, direction, answer);
    return verdict;
  }

  /// Writes the simplex and the direction into the answer.
  static void record(const Simplex& simplex, const Source* sources, const Vec& direction,
                     GjkFilterAnswer& answer) {
    answer.direction[0] = direction.x;
    answer.direction[1] = direction.y;
    answer.direction[2] = direction.z;
    answer.size = simplex.size;
    for (int i = 0; i < simplex.size; ++i) {
      const Local& a = sources[simplex.points[i].round].a;
      const Local& b = sources[simplex.points[i].round].b;
      answer.pairs[i] = {{a.at.x, a.at.y, a.at.z}, {b.at.x, b.at.y, b.at.z}, a.index, b.index};
    }
  }

  /// Reduces a segment to the face of it nearest to the origin; the newest point, which is the last one,
  /// always stays. Sets the direction from the nearest point to the origin, as the functions below do.
  static void reduce_segment(Simplex& simplex, Vec& direction) {
    const Vec& a = simplex.points[1].at;
    const Vec along = minus(simplex.points[0].at, a);
    const double share = -dot(along, a);
    if (share <= 0) {
      simplex.points[0] = simplex.points[1];
      simplex.size = 1;
      direction = negated(a);
      return;
    }
    const double square = dot(along, along);
    direction = {-fused(a.x, square, along.x * share), -fused(a.y, square, along.y * share),
                 -fused(a.z, square, along.z * share)};
  }

  /// Computes the products of the three points and reduces the triangle they form.
  static void reduce_triangle(Simplex& simplex, Vec& direction) {
    const Vec& c = simplex.points[0].at;
    const Vec& b = simplex.points[1].at;
    const Vec& a = simplex.points[2].at;
    simplex.crosses[0] = cross(b, a);
    simplex.crosses[1] = cross(a, c);
    simplex.crosses[2] = cross(c, b);
    simplex.determinant = dot(simplex.crosses[2], a);
    direct_from_triangle(simplex, simplex.determinant, direction);
  }

  /// Sets the direction along the triangle's normal, to the side of the origin, which the sign of the
  /// determinant `side` tells; or reduces the triangle to an edge if the origin lies beyond that edge.
  static void direct_from_triangle(Simplex& simplex, double side, Vec& direction) {
    const Vec normal = plus(plus(simplex.crosses[0], simplex.crosses[1]), simplex.crosses[2]);
    // The edges opposite the points 0 and 1 end at the newest point.
    const double beyond_0 = dot(normal, simplex.crosses[0]), beyond_1 = dot(normal, simplex.crosses[1]);
    if (beyond_0 < 0 || beyond_1 < 0) {
      if (beyond_0 < beyond_1)
        simplex.points[0] = simplex.points[1];
      simplex.points[1] = simplex.points[2];
      simplex.size = 2;
      reduce_segment(simplex, direction);
      return;
    }
    direction = side > 0 ? negated(normal) : normal;
  }

  /// Adds a point to the triangle. If the tetrahedron contains the origin, keeps all four points and returns
  /// `intersecting`, or `undecided` where rounding leaves that open. Otherwise drops one of the older points
  /// and reduces the triangle that remains.
  static Verdict add_to_triangle(Simplex& simplex, const Point& added, Vec& direction, double error) {
    const Vec& a = added.at;
    // These are proportional to the barycentric coordinates of the origin, all multiplied by the sign of the
    // volume.
    const double sign_of_first = simplex.determinant;
    const double product_0 = dot(a, simplex.crosses[0]), product_1 = dot(a, simplex.crosses[1]),
                 product_2 = dot(a, simplex.crosses[2]);
    const double total = sign_of_first - product_0 - product_1 - product_2;
    const double sign = total < 0 ? -1 : 1;
    const double share_0 = -sign * product_0, share_1 = -sign * product_1, share_2 = -sign * product_2,
                 share = sign * sign_of_first;
    if (share_0 > error && share_1 > error && share_2 > error && share > error) {
      simplex.points[3] = added;
      simplex.size = 4;
      return Verdict::intersecting;
    }
    if (share_0 >= 0 && share_1 >= 0 && share_2 >= 0) {
      simplex.points[3] = added;
      simplex.size = 4;
      return Verdict::undecided;
    }
    // The origin lies beyond the face opposite the dropped point, the one with the least share.
    if (share_0 < share_1 && share_0 < share_2) {
      simplex.points[0] = simplex.points[1];
      simplex.points[1] = simplex.points[2];
    } else if (share_1 < share_2) {
      simplex.points[1] = simplex.points[2];
    }
    simplex.points[2] = added;
    reduce_triangle(simplex, direction);
    return Verdict::undecided;
  }
};

}  // namespace fringe::detail
