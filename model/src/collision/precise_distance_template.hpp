#pragma once

#include "collision/gjk_filter.hpp"
#include "collision/support_template.hpp"

/// Bounds of the distance of two polytopes in twice the precision, for the instruction set that `Lanes`
/// represents.
namespace fringe::detail {

template <class Lanes>
class PreciseDistanceFor : SupportFor<Lanes> {
 public:
  /// Finds the nearest point of a simplex of up to three pairs, and the bounds of the distance that it gives,
  /// with errors of some 2^−98 of the extent. The rounding of the direction to doubles remains: it makes the
  /// bounds too far apart where the distance is below about 1e-4 of the extent.
  static void refine(const PlacedShape& a, const PlacedShape& b, DistanceAnswer& answer) {
    const double extent = Support::extent_of(a, b, Support::offset_of(a, b));
    if (answer.size < 1 || answer.size > 3 || !(answer.length > 0x1p-14 * extent))
      return;
    PreciseVec nearest = point_of(a, b, answer.pairs[0]);
    double weights[3] = {1, 0, 0};
    if (answer.size > 1) {
      const PreciseVec edge = difference(point_of(a, b, answer.pairs[1]), nearest);
      const PreciseVec second =
          answer.size == 2 ? PreciseVec{} : difference(point_of(a, b, answer.pairs[2]), nearest);
      const Shares shares(edge.rounded(), second.rounded(), answer.size);
      // The second step removes the rounding of the first.
      for (int step = 0; step < 2; ++step) {
        double first_share, second_share;
        shares.along(nearest.rounded(), first_share, second_share);
        nearest.subtract(first_share, edge);
        nearest.subtract(second_share, second);
        weights[1] -= first_share;
        weights[2] -= second_share;
      }
      weights[0] = 1 - weights[1] - weights[2];
      // Weights that could be negative but for rounding prove nothing.
      for (int i = 0; i < answer.size; ++i)
        if (!(weights[i] > 0x1p-45))
          return;
    }
    const Vec point = nearest.rounded();
    const double length = __builtin_sqrt(dot(point, point));
    const Vec direction{-point.x / length, -point.y / length, -point.z / length};
    constexpr double rounded_up = 1 + 0x1p-49, rounded_down = 1 - 0x1p-49;
    const double bound = separation(a, b, direction) * rounded_down - 0x1p-90 * extent;
    if (!(length * rounded_up - bound <= DistanceAnswer::most_doubt * length))
      return;
    answer.end = DistanceEnd::converged;
    answer.length = length;
    answer.lower_bound = bound < length ? bound : length;
    answer.direction[0] = direction.x;
    answer.direction[1] = direction.y;
    answer.direction[2] = direction.z;
    for (int i = 0; i < answer.size; ++i)
      answer.weights[i] = weights[i];
  }

 private:
  using Support = SupportFor<Lanes>;
  using Support::cross;
  using Support::dot;
  using Support::width;
  using typename Support::Local;
  using typename Support::V;
  using typename Support::Vec;

  /// An unevaluated sum of two doubles. After operations the lower one may overlap the higher one.
  struct Sum {
    double high, low;

    double rounded() const { return high + low; }

    void add(double term) {
      const double sum = high + term, part = sum - high;
      low += (high - (sum - part)) + (term - part);
      high = sum;
    }
    void add_product(double x, double y) {
      const double product = x * y;
      add(product);
      low += error_of_product(x, y, product);
    }
    void add_product(double x, const Sum& y) {
      add_product(x, y.high);
      low += x * y.low;
    }
  };

  /// Returns what rounding has taken from a product: x y − product, without error.
  static double error_of_product(double x, double y, double product) {
    if constexpr (Lanes::fused) {
      return __builtin_fma(x, y, -product);
    } else {
      // Splits each factor into halves of 26 bits (T. J. Dekker, Numerische Mathematik 18, 1971).
      constexpr double splitter = 0x1p27 + 1;
      const double x_scaled = splitter * x, y_scaled = splitter * y;
      const double x_high = x_scaled - (x_scaled - x), y_high = y_scaled - (y_scaled - y);
      const double x_low = x - x_high, y_low = y - y_high;
      return x_low * y_low - (((product - x_high * y_high) - x_low * y_high) - x_high * y_low);
    }
  }

  struct PreciseVec {
    Sum x{}, y{}, z{};

    Vec rounded() const { return {x.rounded(), y.rounded(), z.rounded()}; }
    void subtract(double factor, const PreciseVec& other) {
      x.add_product(-factor, other.x);
      y.add_product(-factor, other.y);
      z.add_product(-factor, other.z);
    }
  };

  static PreciseVec difference(const PreciseVec& a, const PreciseVec& b) {
    PreciseVec result = a;
    result.subtract(1, b);
    return result;
  }

  /// Computes the difference of a pair's moved points.
  static PreciseVec point_of(const PlacedShape& a, const PlacedShape& b, const SupportPair& pair) {
    const auto coordinate = [&](int row) {
      Sum sum{a.pose[12 + row], 0};
      sum.add(-b.pose[12 + row]);
      for (int column = 0; column < 3; ++column) {
        sum.add_product(a.pose[4 * column + row], pair.on_a[column]);
        sum.add_product(-b.pose[4 * column + row], pair.on_b[column]);
      }
      return sum;
    };
    return {coordinate(0), coordinate(1), coordinate(2)};
  }

  /// Finds the shares of two edges in the part of a vector that lies in their plane; for a single edge, in
  /// the part along it.
  struct Shares {
    Vec first, second, to_first, to_second;

    Shares(const Vec& edge, const Vec& other, int size) : first(edge), second(other) {
      if (size == 2) {
        const double square = dot(edge, edge);
        to_first = {edge.x / square, edge.y / square, edge.z / square};
        to_second = {0, 0, 0};
        return;
      }
      // The dual basis.
      const Vec normal = cross(edge, other);
      const double square = dot(normal, normal);
      const Vec across_second = cross(other, normal), across_first = cross(normal, edge);
      to_first = {across_second.x / square, across_second.y / square, across_second.z / square};
      to_second = {across_first.x / square, across_first.y / square, across_first.z / square};
    }

    void along(const Vec& vector, double& of_first, double& of_second) const {
      of_first = dot(to_first, vector);
      of_second = dot(to_second, vector);
    }
  };

  /// Computes the least product of a direction with the differences b − a of the moved shapes' points.
  static double separation(const PlacedShape& a, const PlacedShape& b, const Vec& direction) {
    const double d[3] = {direction.x, direction.y, direction.z};
    Sum sum{0, 0};
    for (int row = 0; row < 3; ++row) {
      Sum offset{b.pose[12 + row], 0};
      offset.add(-a.pose[12 + row]);
      sum.add_product(d[row], offset);
    }
    const Sum reach_a = reach(a, d, 1), reach_b = reach(b, d, -1);
    sum.add(-reach_a.high);
    sum.add(-reach_b.high);
    sum.low -= reach_a.low + reach_b.low;
    return sum.rounded();
  }

  /// Computes the largest product of a direction, times a sign, with the rotated points of a shape.
  static Sum reach(const PlacedShape& placed, const double* d, double sign) {
    // The direction in the shape's own frame.
    Sum turned[3];
    for (int column = 0; column < 3; ++column) {
      Sum& sum = turned[column] = {0, 0};
      for (int row = 0; row < 3; ++row)
        sum.add_product(placed.pose[4 * column + row], sign * d[row]);
      const double high = sum.rounded();
      sum = {high, sum.low - (high - sum.high)};
    }
    const SupportShape& shape = *placed.shape;
    if (shape.kind != ShapeKind::box)
      return reach_of_hull(shape, turned);
    Sum largest{0, 0};
    for (int i = 0; i < 3; ++i)
      largest.add_product(turned[i].high < 0 ? -shape.size[i] : shape.size[i], turned[i]);
    return largest;
  }

  static Sum product(const Vec& vertex, const Sum* direction) {
    Sum sum{0, 0};
    sum.add_product(vertex.x, direction[0]);
    sum.add_product(vertex.y, direction[1]);
    sum.add_product(vertex.z, direction[2]);
    return sum;
  }

  /// Compares precisely those vertices whose rounded products are close to the largest.
  static Sum reach_of_hull(const SupportShape& shape, const Sum* direction) {
    const Vec d{direction[0].high, direction[1].high, direction[2].high};
    VertexBlocks vertices = shape.vertices;
    std::size_t first = 0, last = vertices.count;
    if (shape.cells.resolution != 0) {
      const std::uint32_t cell = Support::cell(shape.cells.resolution, d);
      vertices = shape.cells.vertices;
      first = shape.cells.starts[cell];
      last = shape.cells.starts[cell + 1];
    }
    constexpr std::size_t size = VertexBlocks::size;
    const Vec leader = Support::vertex(vertices, Support::farthest(vertices, first, last, d));
    Sum largest = product(leader, direction);
    const double margin = 0x1p-48 * shape.bounding_radius;
    const V x(d.x), y(d.y), z(d.z), least(largest.high - margin);
    for (std::size_t block = first; block < last; block += size)
      for (std::size_t lane = 0; lane < size; lane += width) {
        const V products = Support::products(vertices.coordinates + block * 3, lane, x, y, z);
        for (unsigned close = Lanes::bits(products > least); close != 0; close &= close - 1) {
          const auto i = static_cast<std::size_t>(__builtin_ctz(close));
          const Sum other = product(Support::vertex(vertices, block + lane + i), direction);
          if (other.high - largest.high + (other.low - largest.low) > 0)
            largest = other;
        }
      }
    return largest;
  }
};

}  // namespace fringe::detail
