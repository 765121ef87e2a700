#pragma once

#include "collision/gjk_distance_template.hpp"
#include "collision/gjk_filter.hpp"
#include "collision/support_template.hpp"

/// Distances of hulls of vertices in twice the precision, as accurate as those in exact numbers wherever they
/// can be certain of it, for the instruction set that `Lanes` represents (model/NUMERICS.md, section 13).
namespace fringe::detail {

template <class Lanes>
class HullDistanceFor : SupportFor<Lanes> {
 public:
  /// Copies vertices into blocks, relative to an origin, and computes a point of their hull. Returns the
  /// largest magnitude of a coordinate, NaN if one is not finite.
  static double arrange(const double* vertices, std::size_t count, const double* origin, double* blocks,
                        double* centre) {
    constexpr std::size_t size = VertexBlocks::size;
    const V origin_x(origin[0]), origin_y(origin[1]), origin_z(origin[2]);
    V largest(0.0), sum_x(0.0), sum_y(0.0), sum_z(0.0);
    double last_block[3 * size];
    std::size_t first = 0;
    for (; first < count; first += size) {
      const double* from = vertices + 3 * first;
      if (first + size > count) {
        for (std::size_t i = 0; i < 3 * size; ++i) {
          const std::size_t place = 3 * first + i;
          last_block[i] = vertices[place < 3 * count ? place : 3 * (count - 1) + i % 3];
        }
        from = last_block;
      }
      for (std::size_t lane = 0; lane < size; lane += width) {
        V x, y, z;
        Lanes::deinterleave(from + 3 * lane, x, y, z);
        x = x - origin_x, y = y - origin_y, z = z - origin_z;
        double* const place = blocks + 3 * first + lane;
        x.store_unaligned(place);
        y.store_unaligned(place + size);
        z.store_unaligned(place + 2 * size);
        largest = max(max(abs(x), abs(y)), max(abs(z), largest));
        sum_x = sum_x + x, sum_y = sum_y + y, sum_z = sum_z + z;
      }
    }
    const double share = 1 / static_cast<double>(first);
    centre[0] = share * hadd(sum_x);
    centre[1] = share * hadd(sum_y);
    centre[2] = share * hadd(sum_z);
    // Maxima may lose a NaN, sums do not.
    return Lanes::largest(largest) + 0 * (centre[0] + centre[1] + centre[2]);
  }

  /// Searches the distance in doubles, and evaluates the simplex found in twice the precision.
  static void distance(const GivenHull& a, const GivenHull& b, HullDistance& found) {
    DistanceAnswer reached;
    GjkDistanceFor<Lanes>::approach_in_place(*a.shape, *b.shape, reached);
    found.is_certain = false;
    found.simplex.size = reached.size;
    if (reached.size == 0)
      return;
    for (int i = 0; i < reached.size; ++i) {
      found.simplex.a[i] = reached.pairs[i].a;
      found.simplex.b[i] = reached.pairs[i].b;
    }
    const double extent = a.shape->bounding_radius + b.shape->bounding_radius;
    PreciseSimplex precise(a, b, found.simplex, extent);
    if (reached.size == 4) {
      found.is_certain = precise.find_common_point(reached.weights, found);
      return;
    }
    CornerPair beyond;
    const Outcome outcome = precise.find_distance(reached.weights, found, beyond);
    found.is_certain =
        outcome == Outcome::certain || (outcome == Outcome::beyond && exchange(a, b, extent, beyond, found));
  }

 private:
  using Support = SupportFor<Lanes>;
  using Support::cross;
  using Support::dot;
  using Support::width;
  using typename Support::Four;
  using typename Support::V;
  using typename Support::Vec;

  /// Four unevaluated sums of two doubles; three are the coordinates of a vector, the fourth is zero. After
  /// operations the lower numbers may overlap the higher ones.
  struct Sum {
    Four high, low;

    Vec rounded() const { return {high[0], high[1], high[2]}; }

    /// Makes the higher numbers the rounded sums.
    void normalise() {
      const Four sum = high + low, part = sum - high;
      low = (high - (sum - part)) + (low - part);
      high = sum;
    }
    void add(const Four& term) {
      const Four sum = high + term, part = sum - high;
      low += (high - (sum - part)) + (term - part);
      high = sum;
    }
    void add_product(double factor, const Sum& other) {
      const Four factors{factor, factor, factor, factor}, product = factors * other.high;
      add(product);
      Four error;
      find_error_of_product(factors, other.high, product, error);
      low += error + factors * other.low;
    }
  };

  /// An unevaluated sum of two doubles, of which the lower one may overlap the higher one.
  struct Product {
    double high, low;

    double rounded() const { return high + low; }
  };

  /// Computes what rounding has taken from products: x y − product, without error.
  static void find_error_of_product(const Four& x, const Four& y, const Four& product, Four& error) {
    if constexpr (Lanes::fused) {
      error = Lanes::fused_four(x, y, -product);
    } else {
      // Splits each factor into halves of 26 bits (T. J. Dekker, Numerische Mathematik 18, 1971).
      constexpr double splitter = 0x1p27 + 1;
      const Four x_scaled = splitter * x, y_scaled = splitter * y;
      const Four x_high = x_scaled - (x_scaled - x), y_high = y_scaled - (y_scaled - y);
      const Four x_low = x - x_high, y_low = y - y_high;
      error = x_low * y_low - (((product - x_high * y_high) - x_low * y_high) - x_high * y_low);
    }
  }

  /// Computes a − b without error.
  static Sum exact_difference(const Four& a, const Four& b) {
    const Four difference = a - b, part = difference - a;
    return {difference, (a - (difference - part)) - (b + part)};
  }

  static Product precise_dot(const Sum& a, const Sum& b) {
    const Four products = a.high * b.high;
    Four errors;
    find_error_of_product(a.high, b.high, products, errors);
    errors += a.high * b.low + a.low * b.high;
    const double x = products[0], y = products[1], z = products[2];
    const double two = x + y, y_part = two - x, three = two + z, z_part = three - two;
    const double rounding = ((x - (two - y_part)) + (y - y_part)) + ((two - (three - z_part)) + (z - z_part));
    return {three, rounding + ((errors[0] + errors[1]) + errors[2])};
  }

  struct CornerPair {
    std::uint32_t a, b;
  };

  enum class Outcome : int {
    certain,   ///< the simplex's nearest point is that of both hulls
    beyond,    ///< vertices lie beyond the plane of the nearest point
    uncertain  ///< for another reason
  };

  /// A simplex of one to four pairs of vertices, evaluated in twice the precision.
  class PreciseSimplex {
   public:
    PreciseSimplex(const GivenHull& of_a, const GivenHull& of_b, const CornerSimplex& corners, double size)
        : a_(of_a), b_(of_b), first_{corners.a[0], corners.b[0]}, count_(corners.size - 1), extent_(size) {
      load(a_, first_.a, corner_a_);
      load(b_, first_.b, corner_b_);
      nearest_ = exact_difference(corner_a_, corner_b_);
      for (int i = 0; i < count_; ++i) {
        Four on_a, on_b;
        load(a_, corners.a[i + 1], on_a);
        load(b_, corners.b[i + 1], on_b);
        edges_a_[i] = exact_difference(on_a, corner_a_);
        edges_b_[i] = exact_difference(on_b, corner_b_);
        Sum& edge = edges_[i] = exact_difference(edges_a_[i].high, edges_b_[i].high);
        edge.low += edges_a_[i].low - edges_b_[i].low;
        edge.normalise();
      }
    }

    /// Finds the distance if the simplex's nearest point is that of both hulls. `weights` are those of the
    /// corners for the nearest point, roughly.
    Outcome find_distance(const double* weights, HullDistance& found, CornerPair& beyond) {
      if (!find_shares(weights))
        return Outcome::uncertain;
      const Product product = precise_dot(nearest_, nearest_);
      const double square = product.rounded(), length = __builtin_sqrt(square);
      // Below this the errors, of some 2^−78 of the extent, could be felt.
      if (!(length > 0x1p-20 * extent_))
        return Outcome::uncertain;
      const Vec n = nearest_.rounded();
      const bool of_a = is_beyond(a_, corner_a_, first_.a, 1, n, square, beyond.a),
                 of_b = is_beyond(b_, corner_b_, first_.b, -1, n, square, beyond.b);
      if (of_a || of_b)
        return Outcome::beyond;
      if (!put_point(corner_a_, edges_a_, found.on_a) || !put_point(corner_b_, edges_b_, found.on_b))
        return Outcome::uncertain;
      const Product rounded_square = square_of(length);
      const double rest = (product.high - rounded_square.high) + (product.low - rounded_square.low);
      constexpr double rounded_down = 1 - 0x1p-50;
      found.distance = length + rest / (2 * length);
      found.lower_bound = found.distance * rounded_down;
      const double scale = -1 / length;
      found.direction[0] = scale * n.x;
      found.direction[1] = scale * n.y;
      found.direction[2] = scale * n.z;
      return Outcome::certain;
    }

    /// Finds a common point of both hulls if the simplex contains the origin.
    bool find_common_point(const double* weights, HullDistance& found) {
      if (!find_shares(weights) || !put_point(corner_a_, edges_a_, found.on_a))
        return false;
      found.distance = found.lower_bound = 0;
      for (int k = 0; k < 3; ++k) {
        found.direction[k] = 0;
        found.on_b[k] = found.on_a[k];
      }
      return true;
    }

   private:
    static void load(const GivenHull& hull, std::uint32_t index, Four& vertex) {
      const double* const place = hull.vertices + std::size_t{3} * index;
      vertex = Four{place[0], place[1], place[2], 0};
    }

    static Product square_of(double x) {
      const Four four{x, 0, 0, 0}, squares = four * four;
      Four errors;
      find_error_of_product(four, four, squares, errors);
      return {squares[0], errors[0]};
    }

    /// Numbers that are parallel to the edges: their products with a vector are its coordinates in the basis
    /// of the edges.
    struct DualBasis {
      Vec rows[3];
      double squares[3];  ///< of the edges' lengths
      double rate;        ///< bounds the error of coordinates, relative to the largest in units of length
    };

    /// Returns false for thin simplices.
    bool find_dual_basis(DualBasis& dual) const {
      // Thinner simplices have no digits left; below the second number they could have lost them to
      // underflow.
      constexpr double thinnest = 0x1p-24, least = 0x1p-1000;
      constexpr double rounding = 0x1p-46;
      for (int i = 0; i < count_; ++i) {
        const Vec edge = edges_[i].rounded();
        dual.squares[i] = dot(edge, edge);
      }
      if (count_ == 0)
        return true;
      const Vec first = edges_[0].rounded();
      if (count_ == 1) {
        dual.rate = rounding;
        dual.rows[0] = scaled(1 / dual.squares[0], first);
        return dual.squares[0] > least;
      }
      const Vec second = edges_[1].rounded(), normal = cross(first, second);
      const double of_both = dual.squares[0] * dual.squares[1];
      if (count_ == 2) {
        const double square = dot(normal, normal), inverse = 1 / square, ratio = of_both * inverse;
        dual.rows[0] = scaled(inverse, cross(second, normal));
        dual.rows[1] = scaled(inverse, cross(normal, first));
        dual.rate = rounding * ratio * ratio;
        return square > thinnest * of_both && square > least;
      }
      const Vec third = edges_[2].rounded();
      const double volume = dot(normal, third), inverse = 1 / volume, square = volume * volume;
      dual.rows[0] = scaled(inverse, cross(second, third));
      dual.rows[1] = scaled(inverse, cross(third, first));
      dual.rows[2] = scaled(inverse, normal);
      dual.rate = rounding * (of_both * inverse) * (dual.squares[2] * inverse);
      return square > thinnest * of_both * dual.squares[2] && square > least;
    }

    /// Finds the coordinates of the nearest point in the basis of the edges, and the point itself. Returns
    /// false for thin simplices, and if the point may not be inside.
    bool find_shares(const double* weights) {
      DualBasis dual{};
      if (!find_dual_basis(dual))
        return false;
      for (int i = 0; i < count_; ++i) {
        shares_[i] = {weights[i + 1], 0};
        nearest_.add_product(weights[i + 1], edges_[i]);
      }
      // Every step leaves of the coordinates what rounding takes of the last one's.
      constexpr int most_steps = 4;
      const double enough = 0x1p-78 * extent_, enough_square = enough * enough;
      bool is_done = count_ == 0;
      for (int step = 0; step < most_steps && !is_done; ++step) {
        nearest_.normalise();
        double coordinates[3];
        find_coordinates(dual, coordinates);
        double largest_square = 0;
        for (int i = 0; i < count_; ++i) {
          const double square = coordinates[i] * coordinates[i] * dual.squares[i];
          largest_square = square > largest_square ? square : largest_square;
          shares_[i].add(-coordinates[i]);
          nearest_.add_product(-coordinates[i], edges_[i]);
        }
        is_done = largest_square <= enough_square || dual.rate * dual.rate * largest_square <= enough_square;
      }
      nearest_.normalise();
      // A share that is this small could be negative.
      constexpr double least = 0x1p-40;
      double rest = 1;
      for (int i = 0; i < count_; ++i) {
        rest -= shares_[i].high;
        is_done = is_done && shares_[i].high > least;
      }
      return is_done && rest > least;
    }

    /// Computes the coordinates, in the basis of the edges, of the part of the nearest point along them.
    void find_coordinates(const DualBasis& dual, double* coordinates) const {
      if (count_ == 3) {
        const Vec n = nearest_.rounded();
        for (int i = 0; i < 3; ++i)
          coordinates[i] = dot(dual.rows[i], n);
        return;
      }
      Vec along{0, 0, 0};
      for (int i = 0; i < count_; ++i)
        along = Support::plus(along, scaled(precise_dot(edges_[i], nearest_).rounded(), dual.rows[i]));
      for (int i = 0; i < count_; ++i)
        coordinates[i] = dot(dual.rows[i], along);
    }

    static Vec scaled(double factor, const Vec& a) { return {factor * a.x, factor * a.y, factor * a.z}; }

    /// Tests whether vertices of A, or of B with the sign −1, are nearer to the other hull than the corner by
    /// as much as the last place of the distance or of a witness could show, and finds the nearest.
    bool is_beyond(const GivenHull& hull, const Four& corner, std::uint32_t index, double sign, const Vec& n,
                   double square, std::uint32_t& nearest) const {
      constexpr std::size_t size = VertexBlocks::size;
      const VertexBlocks& vertices = hull.shape->vertices;
      const Vec d = scaled(sign, n), at_corner = Support::vertex(vertices, index);
      const double certain = 0x1p-48 * extent_ * Support::sum_of_magnitudes(d);
      const V x(d.x), y(d.y), z(d.z), limit(dot(at_corner, d) + certain);
      const double for_distance = 0x1p-58 * square, for_witness = 0x1p-76 * extent_ * extent_;
      const double tolerance = for_distance < for_witness ? for_distance : for_witness;
      bool found = false;
      double least = 0;
      nearest = index;
      for (std::size_t first = 0; first < vertices.count; first += size)
        for (std::size_t lane = 0; lane < size; lane += width) {
          const V products = Support::products(vertices.coordinates + first * 3, lane, x, y, z);
          // Written so that a NaN counts as close.
          unsigned close = ~Lanes::bits(products > limit) & ((1U << width) - 1);
          for (; close != 0; close &= close - 1) {
            const auto i =
                static_cast<std::uint32_t>(first + lane) + static_cast<std::uint32_t>(__builtin_ctz(close));
            if (i == index || i > vertices.last)
              continue;
            Four other;
            load(hull, i, other);
            const double product = sign * precise_dot(exact_difference(other, corner), nearest_).rounded();
            if (product < least) {
              least = product;
              nearest = i;
            }
            found = found || !(product >= -tolerance);
          }
        }
      return found;
    }

    /// Computes the point of a hull at the shares, each coordinate accurate to a unit in its last place.
    /// Returns false if coordinates near zero could have lost digits, unless they are those of all corners.
    bool put_point(const Four& corner, const Sum* edges, double* point) const {
      Sum sum{corner, Four{}};
      auto moved = Four{} != Four{};
      for (int i = 0; i < count_; ++i) {
        sum.add_product(shares_[i].high, edges[i]);
        sum.low += shares_[i].low * edges[i].high;
        moved |= edges[i].high != Four{};
      }
      const Four result = sum.high + sum.low;
      bool is_certain = true;
      for (int k = 0; k < 3; ++k) {
        point[k] = result[k];
        is_certain = is_certain && (moved[k] == 0 || __builtin_fabs(result[k]) > 0x1p-20 * extent_);
      }
      return is_certain;
    }

    /// A share as an unevaluated sum.
    struct Share {
      double high, low;

      void add(double term) {
        const double sum = high + term, part = sum - high;
        low += (high - (sum - part)) + (term - part);
        high = sum;
      }
    };

    const GivenHull& a_;
    const GivenHull& b_;
    CornerPair first_;
    int count_;  ///< of edges
    double extent_;
    Four corner_a_, corner_b_;
    Sum edges_a_[3], edges_b_[3], edges_[3];  ///< from the first corner of A, of B and of the difference
    Share shares_[3];                         ///< of the edges
    Sum nearest_;
  };

  /// Finds the distance from a simplex in which vertices beyond its plane take the place of others. Vertices
  /// of a flat face of more than three lie beyond it by their rounding, which the search cannot see.
  [[gnu::noinline]] static bool exchange(const GivenHull& a, const GivenHull& b, double extent,
                                         CornerPair beyond, HullDistance& found) {
    constexpr int most_rounds = 3;
    constexpr double unknown[4] = {1, 0, 0, 0};
    CornerSimplex simplex = found.simplex;
    for (int round = 0; round < most_rounds; ++round) {
      CornerSimplex next = simplex;
      bool is_beyond = false;
      CornerPair beyond_next{};
      // Without one of the corners, then without two of them.
      for (int kept = simplex.size; kept-- > 0 && !is_beyond;)
        for (unsigned members = 0; members < (1U << simplex.size) && !is_beyond; ++members) {
          if (__builtin_popcount(members) != kept)
            continue;
          next = {{beyond.a}, {beyond.b}, 1};
          for (int i = 0; i < simplex.size; ++i)
            if ((members >> i & 1U) != 0) {
              next.a[next.size] = simplex.a[i];
              next.b[next.size++] = simplex.b[i];
            }
          const Outcome outcome =
              PreciseSimplex(a, b, next, extent).find_distance(unknown, found, beyond_next);
          if (outcome == Outcome::certain)
            return true;
          is_beyond = outcome == Outcome::beyond;
        }
      if (!is_beyond)
        return false;
      simplex = next;
      beyond = beyond_next;
    }
    return false;
  }
};

}  // namespace fringe::detail
