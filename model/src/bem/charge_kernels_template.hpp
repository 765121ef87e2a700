#pragma once

#include <numbers>

#include "bem/charge_kernels.hpp"
#include "integral/batch/kernels_template.hpp"

/// The charge kernels for one instruction set, which `Lanes` stands for.
namespace fringe::detail {

template <class Lanes>
class ChargeKernelsFor {
  using Count = std::ptrdiff_t;

 public:
  static void face_potentials(const FacePoint& point, const RuleView& u, const RuleView& v, double* scratch,
                              double* result) {
    const Count padded = whole_face_blocks(v.points);
    double* const along = scratch;
    double* const across = along + u.points;
    double* const inverse = across + padded;
    double* const half_way = inverse + face_block * u.points;
    for (Count p = 0; p < u.points; ++p) {
      const double away = point.half_u * u.nodes[p] - point.x;
      along[p] = away * away + point.z * point.z;
    }
    for (Count q = 0; q < v.points; ++q) {
      const double away = point.half_v * v.nodes[q] - point.y;
      across[q] = away * away;
    }
    // Padding: the last block reads these values, but no result depends on them.
    for (Count q = v.points; q < padded; ++q)
      across[q] = 1;
    sum_over_u(u, v, padded, along, across, inverse, half_way);
    sum_over_v(u, v, padded, half_way, result);
  }

  static void triangle_potentials(const double* const (&components)[9], std::size_t count,
                                  double* potentials) {
    for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(width)) {
      Vector v[9];
      for (int k = 0; k < 9; ++k)
        v[k] = Vector::load_unaligned(components[k] + i);
      triangle_potential({{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}})
          .store_unaligned(potentials + i);
    }
  }

  static void solid_angles(const double* const (&components)[9], std::size_t count, double* angles) {
    for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(width)) {
      Vector v[9];
      for (int k = 0; k < 9; ++k)
        v[k] = Vector::load_unaligned(components[k] + i);
      solid_angle({{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}}).store_unaligned(angles + i);
    }
  }

  static constexpr ChargeKernels kernels{&face_potentials, &triangle_potentials, &solid_angles};

 private:
  using Vector = typename Lanes::Vector;
  static constexpr Count width = Lanes::width;

  using Point = Vector3<Vector>;

  static Point cross(const Point& a, const Point& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }

  /// Returns h·∫dl/r along a side from a to b, where h is the distance from the side to the origin's
  /// projection onto the triangle's plane, positive inwards; `normal` has length 1.
  static Vector side_moment(const Point& a, const Point& b, const Vector& from, const Vector& to,
                            const Point& normal) {
    const Point side = b - a;
    const Vector length = sqrt(squared_norm(side)), inverse = Vector(1) / length;
    const Point direction{side.x * inverse, side.y * inverse, side.z * inverse};
    const Vector height = dot(cross(a, direction), normal);
    // Mirrors a side that lies mostly behind the origin's foot point on it, to avoid cancellation in r + s.
    const Vector before = dot(a, direction), after = dot(b, direction);
    const auto is_behind = before + after < Vector(0);
    const Vector first = select(is_behind, Vector(0) - after, before);
    const Vector last = select(is_behind, Vector(0) - before, after);
    const Vector from_first = select(is_behind, to, from), from_last = select(is_behind, from, to);
    const Vector away = squared_norm(cross(a, direction));
    const Vector near =
        select(first < Vector(0), max(away, Vector(tiny) * squared_norm(side)) / (from_first - first),
               from_first + first);
    return select(near > Vector(0), height * Lanes::log((from_last + last) / near), Vector(0));
  }

  /// Returns the mean of 1/r over a triangle, by the sides' moments and the solid angle (Wilton et al. 1984;
  /// van Oosterom and Strackee 1983).
  static Vector triangle_potential(const VirtualLanes<Vector>& triangle) {
    const auto& [a, b, c] = triangle;
    const Point product = cross(b - a, c - a);
    const Vector twice_area = sqrt(squared_norm(product)), inverse = Vector(1) / twice_area;
    const Point normal{product.x * inverse, product.y * inverse, product.z * inverse};
    const Vector ra = sqrt(squared_norm(a)), rb = sqrt(squared_norm(b)), rc = sqrt(squared_norm(c));
    const Vector moments = side_moment(a, b, ra, rb, normal) + side_moment(b, c, rb, rc, normal) +
                           side_moment(c, a, rc, ra, normal);
    const Vector height = abs(dot(a, normal));
    const Vector angle = Vector(2) * Lanes::atan2(height * twice_area, ra * rb * rc + dot(a, b) * rc +
                                                                           dot(b, c) * ra + dot(c, a) * rb);
    return Vector(2) * inverse * (moments - height * angle);
  }

  /// Returns a triangle's solid angle over 4π (van Oosterom and Strackee 1983).
  static Vector solid_angle(const VirtualLanes<Vector>& triangle) {
    const auto& [a, b, c] = triangle;
    const Vector ra = sqrt(squared_norm(a)), rb = sqrt(squared_norm(b)), rc = sqrt(squared_norm(c));
    const Vector volume = dot(a, cross(b, c));
    const Vector angle =
        Lanes::atan2(volume, ra * rb * rc + dot(a, b) * rc + dot(b, c) * ra + dot(c, a) * rb);
    return select(abs(volume) > Vector(0), angle * Vector(1 / (2 * std::numbers::pi)), Vector(0));
  }

  /// Least squared distance from a side's line, relative to the side's squared length. Nearer, the side's
  /// moment is less than rounding.
  static constexpr double tiny = 1e-30;

  /// Number of sums that are held in registers.
  static constexpr Count together = 8;

  /// Computes half_way[k·padded + q] = Σ_p f_k(x_p)·weight/distance for all nodes along v.
  static void sum_over_u(const RuleView& u, const RuleView& v, Count padded, const double* along,
                         const double* across, double* inverse, double* half_way) {
    const Count parts = (u.functions + together - 1) / together;
    for (Count q = 0; q < v.points; q += width)
      for (Count part = 0; part < parts; ++part) {
        const Count from = part * u.functions / parts, to = (part + 1) * u.functions / parts;
        columns<together>(to - from, u, from, along, Vector::load_unaligned(across + q), part == 0, inverse,
                          half_way + from * padded + q, padded);
      }
  }

  /// Runs the loop that is compiled for exactly `count` functions.
  template <Count most>
  static void columns(Count count, const RuleView& u, Count from, const double* along, const Vector& across,
                      bool is_first, double* inverse, double* half_way, Count padded) {
    if constexpr (most > 1) {
      if (count < most) {
        columns<most - 1>(count, u, from, along, across, is_first, inverse, half_way, padded);
        return;
      }
    }
    Vector sums[most];
    for (Count k = 0; k < most; ++k)
      sums[k] = Vector(0.0);
    const double* weights = u.weights + from;
    for (Count p = 0; p < u.points; ++p, weights += u.stride) {
      Vector value;
      if (is_first) {
        value = inverse_square_root<Lanes>(Vector(along[p]) + across);
        value.store_unaligned(inverse + p * width);
      } else {
        value = Vector::load_unaligned(inverse + p * width);
      }
      for (Count k = 0; k < most; ++k)
        sums[k] = fma(Vector(weights[k]), value, sums[k]);
    }
    for (Count k = 0; k < most; ++k)
      sums[k].store_unaligned(half_way + k * padded);
  }

  /// Computes result[k·functions + l] = Σ_q half_way[k·padded + q]·f_l(y_q)·weight.
  static void sum_over_v(const RuleView& u, const RuleView& v, Count padded, const double* half_way,
                         double* result) {
    constexpr Count rows = 4;
    for (Count l = 0; l < v.functions; l += width) {
      const Count here = v.functions - l < width ? v.functions - l : width;
      Count k = 0;
      for (; k + rows <= u.functions; k += rows)
        tile<rows>(v, padded, half_way + k * padded, l, here, result + k * v.functions + l);
      for (; k < u.functions; ++k)
        tile<1>(v, padded, half_way + k * padded, l, here, result + k * v.functions + l);
    }
  }

  template <Count rows>
  static void tile(const RuleView& v, Count padded, const double* half_way, Count l, Count here,
                   double* result) {
    Vector sums[rows];
    for (Count k = 0; k < rows; ++k)
      sums[k] = Vector(0.0);
    const double* weights = v.weights + l;
    for (Count q = 0; q < v.points; ++q, weights += v.stride) {
      const Vector weight = Vector::load_unaligned(weights);
      for (Count k = 0; k < rows; ++k)
        sums[k] = fma(Vector(half_way[k * padded + q]), weight, sums[k]);
    }
    for (Count k = 0; k < rows; ++k) {
      if (here == width) {
        sums[k].store_unaligned(result + k * v.functions);
        continue;
      }
      double last[static_cast<std::size_t>(width)];
      sums[k].store_unaligned(last);
      for (Count lane = 0; lane < here; ++lane)
        result[k * v.functions + lane] = last[lane];
    }
  }
};

}  // namespace fringe::detail
