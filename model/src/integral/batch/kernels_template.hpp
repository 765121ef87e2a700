#pragma once

#include <cstddef>
#include <cstdint>

#include "integral/batch/kernels.hpp"
#include "integral/batch/near_forms.hpp"
#include "numeric/quadrature_rules.hpp"
#include "simd/vector_math.hpp"

/// The batch integrals for one instruction set, given by the template parameter `Lanes` (model/NUMERICS.md,
/// section 12).
namespace fringe::detail {

/// Computes 1/√x for normal x: not 0, subnormal or infinite.
template <class Lanes, class V>
V inverse_square_root(const V& x) {
  if constexpr (Lanes::has_estimate) {
    // With e = 1 − x·y², |e| ≤ 2^−13, the series of y·(1 − e)^(−1/2) is truncated after the third power; the
    // truncation error is 6e-17.
    const V y = Lanes::inverse_square_root_estimate(x);
    const V e = fnma(x * y, y, V(1));
    return fma(y * e, fma(e, fma(e, V(5.0 / 16), V(3.0 / 8)), V(0.5)), y);
  } else {
    return V(1) / sqrt(x);
  }
}

/// The vectors from the plate's nearest points to the vertices of one triangle per lane, each triangle in one
/// cell.
template <class V>
struct VirtualLanes {
  Vector3<V> v0, v1, v2;
};

/// Indices at which the results of a register's lanes are stored.
template <class Lanes>
struct Places {
  std::uint32_t indices[Lanes::width];
  bool consecutive = false;
};

/// Queue of triangles that wait until a whole register of the same kind has been collected.
template <class Lanes>
class Queue {
 public:
  using V = typename Lanes::Vector;
  static constexpr int components = 10;

  bool full() const { return size_ > capacity - Lanes::width; }
  int size() const { return size_; }

  void push(const V (&values)[components], const Places<Lanes>& places, unsigned lanes) {
    constexpr unsigned all_lanes = (1U << Lanes::width) - 1;
    if (lanes == all_lanes) {
      for (int k = 0; k < components; ++k)
        values[k].store_unaligned(values_[k] + size_);
      for (int lane = 0; lane < Lanes::width; ++lane)
        indices_[size_ + lane] = places.indices[lane];
      size_ += Lanes::width;
      return;
    }
    double spread[components][Lanes::width];
    for (int k = 0; k < components; ++k)
      values[k].store_unaligned(spread[k]);
    for (int lane = 0; lane < Lanes::width; ++lane) {
      if ((lanes >> lane & 1U) == 0)
        continue;
      for (int k = 0; k < components; ++k)
        values_[k][size_] = spread[k][lane];
      indices_[size_++] = places.indices[lane];
    }
  }

  /// Removes up to one register of triangles. Sets the bits of `lanes` that hold triangles; the other lanes
  /// repeat one of them.
  void pop(V (&values)[components], Places<Lanes>& places, unsigned& lanes) {
    const int taken = size_ < Lanes::width ? size_ : Lanes::width;
    size_ -= taken;
    for (int lane = taken; lane < Lanes::width; ++lane)
      for (auto& values_of_one : values_)
        values_of_one[size_ + lane] = values_of_one[size_];
    for (int k = 0; k < components; ++k)
      values[k] = V::load_unaligned(values_[k] + size_);
    for (int lane = 0; lane < Lanes::width; ++lane)
      places.indices[lane] = indices_[size_ + (lane < taken ? lane : 0)];
    lanes = (1U << taken) - 1;
  }

 private:
  /// Number of triangles in a queue: eight of the widest registers. Few registers are then partial, and three
  /// queues stay in the fastest cache.
  static constexpr int capacity = 64;
  double values_[components][capacity + Lanes::width];
  std::uint32_t indices_[capacity + Lanes::width];
  int size_ = 0;
};

/// The work of one call: evaluates full registers at once, and queues triangles that need another formula.
template <class Lanes>
class BatchIntegration {
 public:
  using V = typename Lanes::Vector;
  using Mask = typename Lanes::Mask;
  static constexpr int width = Lanes::width;
  static constexpr unsigned all_lanes = (1U << width) - 1;

  /// @param least_height triangles of region I closer to the plate's plane than this are left out
  BatchIntegration(const Choices& choices, double* values, std::uint32_t* left, double least_height)
      : choices_(choices), values_(values), left_(left), least_height_(least_height) {}

  /// Integrates triangles of any cells, given in the plate's coordinates.
  void integrate(const PlateCoordinates& plate, const Vector3<V> (&local)[3], const V& twice_area,
                 const V& squared_size, const Places<Lanes>& places, unsigned lanes) {
    const Strips u = strips(local[0].x, local[1].x, local[2].x, plate.length_u);
    const Strips v = strips(local[0].y, local[1].y, local[2].y, plate.length_v);
    const Mask in_front = u.within & v.within;
    if (lanes == all_lanes && all(in_front)) {
      add_in_front(local[0].z, local[1].z, local[2].z, twice_area, places, lanes);
      return;
    }
    const unsigned whole = Lanes::bits(u.only & v.only) & lanes;
    if (whole != 0) {
      const V length_u(plate.length_u), length_v(plate.length_v);
      const auto from_plate = [&](const Vector3<V>& point) -> Vector3<V> {
        return {beside(point.x, length_u), beside(point.y, length_v), point.z};
      };
      evaluate({from_plate(local[0]), from_plate(local[1]), from_plate(local[2])}, twice_area, squared_size,
               in_front, places, whole);
    }
    const unsigned straddling = lanes & ~whole;
    if (straddling == 0)
      return;
    const V values[] = {local[0].x, local[0].y, local[0].z, local[1].x, local[1].y,
                        local[1].z, local[2].x, local[2].y, local[2].z, twice_area};
    if (straddling == all_lanes) {
      cut(plate, local, twice_area, places, straddling);
      return;
    }
    straddling_.push(values, places, straddling);
    if (straddling_.full())
      drain_straddling(plate, width);
  }

  /// Integrates triangles that each lie in one cell.
  ///
  /// @param squared_size at least the largest squared distance of a vertex from the centroid
  /// @param in_front marks the triangles of region I
  void evaluate(const VirtualLanes<V>& triangle, const V& weight, const V& squared_size, const Mask& in_front,
                const Places<Lanes>& places, unsigned lanes) {
    const Vector3<V> edge1 = triangle.v1 - triangle.v0, edge2 = triangle.v2 - triangle.v0;
    const V squared_distance = squared_norm(along(triangle.v0, V(1.0 / 3), edge1 + edge2));

    const auto beyond = [&](const RuleChoice& rule) {
      return Lanes::bits(squared_size > V(rule.largest_squared_ratio) * squared_distance);
    };
    // Lengths whose sixth powers underflow or overflow are left to the code that rescales them.
    const V shortest(1e-80), longest(1e80);
    const unsigned ordinary =
        Lanes::bits((squared_distance > shortest) & (squared_distance < longest) & (squared_size < longest)) &
        lanes;
    if (ordinary != lanes)
      leave(places, lanes & ~ordinary);
    const unsigned fronts = Lanes::bits(in_front) & ordinary;
    unsigned rest = ordinary;
    std::size_t rule = 0;
    const std::size_t rules = choices_.rules.size();
    while (rule < rules && choices_.rules[rule].points <= few_points &&
           (beyond(choices_.rules[rule]) & rest) != 0)
      ++rule;
    if (rule == rules || choices_.rules[rule].points > few_points) {
      // In region I the closed form costs less than a rule of many points.
      if (fronts != 0)
        add_in_front(triangle.v0.z, triangle.v1.z, triangle.v2.z, weight, places, fronts);
      rest &= ~fronts;
      if (rest == 0)
        return;
      const unsigned near = rules == 0 ? rest : beyond(choices_.rules[rules - 1]) & rest;
      if (near != 0)
        add_near(triangle, weight, squared_distance, places, near);
      rest &= ~near;
      if (rest == 0)
        return;
      rule = 0;
      while ((beyond(choices_.rules[rule]) & rest) != 0)
        ++rule;
    }
    add(weight * mean_over_rule(choices_.rules[rule], triangle.v0, edge1, edge2), places, rest);
  }

  /// Computes the largest squared distance of a vertex from the centroid.
  static V squared_size(const VirtualLanes<V>& triangle) {
    const Vector3<V> edge1 = triangle.v1 - triangle.v0, edge2 = triangle.v2 - triangle.v0;
    const Vector3<V> centroid = along(triangle.v0, V(1.0 / 3), edge1 + edge2);
    return max(squared_norm(triangle.v0 - centroid),
               max(squared_norm(triangle.v1 - centroid), squared_norm(triangle.v2 - centroid)));
  }

  void finish(const PlateCoordinates& plate) {
    while (straddling_.size() > 0)
      drain_straddling(plate, 1);
    finish();
  }

  void finish() {
    while (near_.size() > 0)
      drain(near_, 1, [this](const auto&... arguments) { add_closed(arguments...); });
    while (along_height_.size() > 0)
      drain(along_height_, 1, [this](const auto&... arguments) { add_along_height(arguments...); });
  }

  std::size_t left_count() const { return left_count_; }

 private:
  /// Number of points up to which a rule costs no more than the closed form of region I.
  static constexpr int few_points = 7;

  /// Largest ratios of length to height and of distance to height for the closed form; one of the two
  /// suffices. The closed form loses about as many units in the last place as the ratio of length to height,
  /// unless the origin is within about one height.
  static constexpr double most_heights_long = 3, most_heights_away = 1.5;

  /// Position of triangles relative to the plate's strips along one axis.
  struct Strips {
    Mask within;
    Mask only;  ///< in one strip alone
  };

  static Strips strips(const V& a, const V& b, const V& c, double length) {
    const V lowest = min(a, min(b, c)), highest = max(a, max(b, c));
    const Mask within = (lowest >= V(0)) & (highest <= V(length));
    return {within, within | (highest <= V(0)) | (lowest >= V(length))};
  }

  /// Computes the signed distance of a coordinate from the interval [0, length].
  static V beside(const V& coordinate, const V& length) {
    return coordinate - min(max(coordinate, V(0)), length);
  }

  /// Returns whether the first mask differs from the other two, which agree.
  static Mask alone(const Mask& first, const Mask& second, const Mask& third) {
    return (first & (!second) & (!third)) | ((!first) & second & third);
  }

  /// Adds the results of the marked lanes to the values.
  void add(const V& results, const Places<Lanes>& places, unsigned lanes) {
    if (lanes == all_lanes && places.consecutive) {
      double* values = values_ + places.indices[0];
      (V::load_unaligned(values) + results).store_unaligned(values);
      return;
    }
    double spread[width];
    results.store_unaligned(spread);
    for (int lane = 0; lane < width; ++lane)
      if ((lanes >> lane & 1U) != 0)
        values_[places.indices[lane]] += spread[lane];
  }

  /// Writes the indices of the marked lanes to the list of triangles left out.
  void leave(const Places<Lanes>& places, unsigned lanes) {
    for (int lane = 0; lane < width; ++lane)
      if ((lanes >> lane & 1U) != 0)
        left_[left_count_++] = places.indices[lane];
  }

  /// Computes half the mean of 1/|v| over a triangle by a rule: an approximation of K.
  static V mean_over_rule(const RuleChoice& rule, const Vector3<V>& start, const Vector3<V>& edge1,
                          const Vector3<V>& edge2) {
    V sum(0);
    if (rule.points <= few_points) {
      for (int i = 0; i < rule.points; ++i) {
        const TriangleNode& node = rule.nodes[i];
        const Vector3<V> point = along(along(start, V(node.second), edge1), V(node.third), edge2);
        sum = fma(V(node.weight), inverse_square_root<Lanes>(squared_norm(point)), sum);
      }
      return V(0.5) * sum;
    }
    // |v|² as a polynomial in the node's two coordinates. All its terms are small compared with the constant
    // one.
    const V constant = squared_norm(start), first = V(2) * dot(start, edge1),
            second = V(2) * dot(start, edge2);
    const V first_squared = squared_norm(edge1), mixed = V(2) * dot(edge1, edge2),
            second_squared = squared_norm(edge2);
    for (int i = 0; i < rule.points; ++i) {
      const TriangleNode& node = rule.nodes[i];
      const V u(node.second), v(node.third);
      const V squared = fma(u, fma(u, first_squared, first),
                            fma(v, fma(u, mixed, fma(v, second_squared, second)), constant));
      sum = fma(V(node.weight), inverse_square_root<Lanes>(squared), sum);
    }
    return V(0.5) * sum;
  }

  /// Adds the closed form of region I; leaves out triangles that may touch the plate's plane.
  void add_in_front(const V& z0, const V& z1, const V& z2, const V& weight, const Places<Lanes>& places,
                    unsigned lanes) {
    const Mask one_side =
        (min(z0, min(z1, z2)) > V(least_height_)) | (max(z0, max(z1, z2)) < V(-least_height_));
    const unsigned clear = Lanes::bits(one_side) & lanes;
    if (clear != lanes)
      leave(places, lanes & ~clear);
    if (clear == 0)
      return;
    add(weight * kernel_of_heights<Lanes>(select(one_side, abs(z0), V(1)), select(one_side, abs(z1), V(1)),
                                          select(one_side, abs(z2), V(1))),
        places, clear);
  }

  /// Adds triangles close to the origin by the closed form or, if they are long and thin, by a Gauss rule
  /// along the height; queues partial registers.
  void add_near(const VirtualLanes<V>& triangle, const V& weight, const V& squared_distance,
                const Places<Lanes>& places, unsigned lanes) {
    const Vector3<V>&v0 = triangle.v0, &v1 = triangle.v1, &v2 = triangle.v2;
    const V longest = max(squared_norm(v1 - v0), max(squared_norm(v2 - v1), squared_norm(v0 - v2)));
    // The squared height is |N|²/longest, with N from the edges: accurate enough to choose a formula.
    const Vector3<V> edge1 = v1 - v0, edge2 = v2 - v0;
    const V nx = edge1.y * edge2.z - edge1.z * edge2.y, ny = edge1.z * edge2.x - edge1.x * edge2.z,
            nz = edge1.x * edge2.y - edge1.y * edge2.x;
    const V squared_height = (nx * nx + ny * ny + nz * nz) / max(longest, V(smallest));
    // A needle that rounding has collapsed to a point in the plate's coordinates has height zero and no
    // closed form.
    const unsigned closed =
        Lanes::bits((longest < V(most_heights_long * most_heights_long) * squared_height) |
                    (squared_distance <= V(most_heights_away * most_heights_away) * squared_height)) &
        lanes;
    const unsigned along_height = lanes & ~closed;
    const V values[] = {v0.x, v0.y, v0.z, v1.x, v1.y, v1.z, v2.x, v2.y, v2.z, weight};
    if (closed == all_lanes) {
      add_closed(values, places, closed);
    } else if (closed != 0) {
      near_.push(values, places, closed);
      if (near_.full())
        drain(near_, width, [this](const auto&... arguments) { add_closed(arguments...); });
    }
    if (along_height == all_lanes) {
      add_along_height(values, places, along_height);
    } else if (along_height != 0) {
      along_height_.push(values, places, along_height);
      if (along_height_.full())
        drain(along_height_, width, [this](const auto&... arguments) { add_along_height(arguments...); });
    }
  }

  /// Adds the closed form; leaves out the lanes in which it is not accurate.
  void add_closed(const V (&values)[Queue<Lanes>::components], const Places<Lanes>& places, unsigned lanes) {
    Mask safe = V(1) > V(0);
    const V kernel =
        kernel_near<Lanes, V>({values[0], values[1], values[2]}, {values[3], values[4], values[5]},
                              {values[6], values[7], values[8]}, safe);
    const unsigned done = Lanes::bits(safe) & lanes;
    if (done != lanes)
      leave(places, lanes & ~done);
    add(values[9] * kernel, places, done);
  }

  /// Adds the Gauss rule along the height; leaves out the lanes in which no rule suffices.
  void add_along_height(const V (&values)[Queue<Lanes>::components], const Places<Lanes>& places,
                        unsigned lanes) {
    const LanesHeightSplit<V> split =
        split_at_height<V>({values[0], values[1], values[2]}, {values[3], values[4], values[5]},
                           {values[6], values[7], values[8]});
    const V squared_distance = squared_distance_to_triangle(split.a, split.b, split.m);
    const V squared_height = squared_norm(split.height);
    const auto reached_by = [&](const HeightRuleChoice& rule) {
      return Lanes::bits(squared_distance >= V(rule.smallest_squared_ratio) * squared_height);
    };
    const V squared_length = squared_norm(split.b - split.a);
    const unsigned apart = Lanes::bits(squared_length <= V(most_lengths * most_lengths) * squared_distance) &
                           reached_by(choices_.height_rules.back()) & lanes;
    if (apart != lanes)
      leave(places, lanes & ~apart);
    if (apart == 0)
      return;
    std::size_t rule = 0;
    while ((reached_by(choices_.height_rules[rule]) & apart) != apart)
      ++rule;
    const HeightRuleChoice& chosen = choices_.height_rules[rule];
    add(values[9] * kernel_along_height<Lanes>(split, chosen.nodes, chosen.points), places, apart);
  }

  /// Empties the queue register by register until fewer than `least` triangles remain.
  template <class Add>
  void drain(Queue<Lanes>& queue, int least, const Add& add_all) {
    while (queue.size() >= least) {
      V values[Queue<Lanes>::components];
      Places<Lanes> places;
      unsigned lanes = 0;
      queue.pop(values, places, lanes);
      add_all(values, places, lanes);
    }
  }

  void drain_straddling(const PlateCoordinates& plate, int least) {
    drain(straddling_, least, [&](const auto& values, const Places<Lanes>& places, unsigned lanes) {
      const Vector3<V> local[] = {{values[0], values[1], values[2]},
                                  {values[3], values[4], values[5]},
                                  {values[6], values[7], values[8]}};
      cut(plate, local, values[9], places, lanes);
    });
  }

  /// Cuts triangles that one border plane crosses into three pieces, and leaves out those that several border
  /// planes cross.
  void cut(const PlateCoordinates& plate, const Vector3<V> (&local)[3], const V& twice_area,
           const Places<Lanes>& places, unsigned lanes) {
    // Swap the axes so that the crossed one is x.
    const Mask swap = strips(local[0].x, local[1].x, local[2].x, plate.length_u).only;
    Vector3<V> points[3];
    for (int i = 0; i < 3; ++i)
      points[i] = {select(swap, local[i].y, local[i].x), select(swap, local[i].x, local[i].y), local[i].z};
    const V length_x = select(swap, V(plate.length_v), V(plate.length_u));
    const V length_y = select(swap, V(plate.length_u), V(plate.length_v));
    const V lowest_y = min(points[0].y, min(points[1].y, points[2].y));
    const V highest_y = max(points[0].y, max(points[1].y, points[2].y));
    const Mask within_y = (lowest_y >= V(0)) & (highest_y <= length_y);
    const Mask only_y = within_y | (highest_y <= V(0)) | (lowest_y >= length_y);
    const V lowest_x = min(points[0].x, min(points[1].x, points[2].x));
    const V highest_x = max(points[0].x, max(points[1].x, points[2].x));
    const Mask at_zero = (lowest_x < V(0)) & (highest_x > V(0)) & (highest_x <= length_x);
    const Mask at_length = (lowest_x >= V(0)) & (lowest_x < length_x) & (highest_x > length_x);
    const unsigned single = Lanes::bits(only_y & (at_zero | at_length)) & lanes;
    if (single != lanes)
      leave(places, lanes & ~single);
    if (single == 0)
      return;

    const V border = select(at_zero, V(0), length_x);
    // Signed distances from the border plane: positive beside the plate, negative in front of it.
    V outward[3];
    for (int i = 0; i < 3; ++i) {
      points[i].y = points[i].y - min(max(points[i].y, V(0)), length_y);
      outward[i] = select(at_zero, border - points[i].x, points[i].x - border);
    }
    // Rotate the vertices so that the one alone on its side comes first.
    const Mask out0 = outward[0] > V(0), out1 = outward[1] > V(0), out2 = outward[2] > V(0);
    const Mask one_alone = alone(out1, out2, out0);
    const Mask two_alone = alone(out2, out0, out1);
    const auto turned = [&](const auto& a, const auto& b, const auto& c) {
      return select(two_alone, c, select(one_alone, b, a));
    };
    const Vector3<V> lone = turned(points[0], points[1], points[2]);
    const Vector3<V> next = turned(points[1], points[2], points[0]);
    const Vector3<V> last = turned(points[2], points[0], points[1]);
    const V lone_out = turned(outward[0], outward[1], outward[2]);
    const V next_out = turned(outward[1], outward[2], outward[0]);
    const V last_out = turned(outward[2], outward[0], outward[1]);

    const V to_next = lone_out / (lone_out - next_out), from_next = next_out / (next_out - lone_out);
    const V to_last = lone_out / (lone_out - last_out), from_last = last_out / (last_out - lone_out);
    const auto between = [](const Vector3<V>& a, const Vector3<V>& b, const V& from_a,
                            const V& from_b) -> Vector3<V> {
      // Interpolate from the nearer end, which preserves its digits.
      const Mask near_a = from_a <= V(0.5);
      return select(near_a, along(a, from_a, b - a), along(b, from_b, a - b));
    };
    Vector3<V> cut_next = between(lone, next, to_next, from_next);
    Vector3<V> cut_last = between(lone, last, to_last, from_last);
    cut_next.x = V(0);
    cut_last.x = V(0);
    const auto with_x = [](const Vector3<V>& point, const V& x) -> Vector3<V> {
      return {x, point.y, point.z};
    };
    // The sign of a component does not change a distance, so outward distances serve as components.
    const Vector3<V> lone_vector = with_x(lone, max(lone_out, V(0)));
    const Vector3<V> next_vector = with_x(next, max(next_out, V(0)));
    const Vector3<V> last_vector = with_x(last, max(last_out, V(0)));
    const Mask lone_outside = lone_out > V(0);
    const Mask front_lone = within_y & (!lone_outside), front_rest = within_y & lone_outside;
    const auto evaluate_piece = [&](const VirtualLanes<V>& piece, const V& weight, const Mask& in_front) {
      evaluate(piece, weight, squared_size(piece), in_front, places, single);
    };
    evaluate_piece({lone_vector, cut_next, cut_last}, twice_area * to_next * to_last, front_lone);
    evaluate_piece({cut_next, next_vector, last_vector}, twice_area * from_next, front_rest);
    evaluate_piece({cut_next, last_vector, cut_last}, twice_area * to_next * from_last, front_rest);
  }

  const Choices& choices_;
  double* values_;
  std::uint32_t* left_;
  std::size_t left_count_ = 0;
  double least_height_;
  Queue<Lanes> near_, along_height_, straddling_;
};

/// The functions of BatchKernels for one instruction set.
template <class Lanes>
struct BatchKernelsFor {
  using V = typename Lanes::Vector;
  using Mask = typename Lanes::Mask;
  static constexpr int width = Lanes::width;

  /// Bound of the rounding error of the height of a point in a plate's coordinates, as a share of the plate's
  /// lengths: a few units of 2^−53.
  static constexpr double rounding = 0x1p-44;

  static void measure(const double* const (&coordinates)[9], std::size_t count, double* twice_area,
                      double* squared_size) {
    for (std::size_t i = 0; i < count; i += width) {
      V c[9];
      for (int k = 0; k < 9; ++k)
        c[k] = V::load_unaligned(coordinates[k] + i);
      const VirtualLanes<V> triangle{{c[0], c[1], c[2]}, {c[3], c[4], c[5]}, {c[6], c[7], c[8]}};
      area_doubled(triangle).store_unaligned(twice_area + i);
      BatchIntegration<Lanes>::squared_size(triangle).store_unaligned(squared_size + i);
    }
  }

  // NOLINTBEGIN(readability-non-const-parameter): the batch writes through values and left.
  static std::size_t integrate(const TriangleArrays& triangles, std::size_t count,
                               const PlateCoordinates& plate, const Choices& choices, double* values,
                               std::uint32_t* left) {
    // Contact is not decided here. Triangles that may touch the plate through rounding are left to the code
    // that orders the vertices first.
    BatchIntegration<Lanes> batch(choices, values, left, rounding * (plate.length_u + plate.length_v));
    const PlateLanes frame(plate);
    Places<Lanes> places;
    places.consecutive = true;
    for (std::size_t i = 0; i < count; i += width) {
      Vector3<V> local[3];
      for (std::size_t vertex = 0; vertex < 3; ++vertex)
        local[vertex] = frame.local({V::load_unaligned(triangles.coordinates[3 * vertex] + i),
                                     V::load_unaligned(triangles.coordinates[3 * vertex + 1] + i),
                                     V::load_unaligned(triangles.coordinates[3 * vertex + 2] + i)});
      const V twice_area = V::load_unaligned(triangles.twice_area + i);
      for (int lane = 0; lane < width; ++lane)
        places.indices[lane] = static_cast<std::uint32_t>(i) + static_cast<std::uint32_t>(lane);
      const unsigned with_area = Lanes::bits(twice_area > V(0));
      batch.integrate(plate, local, twice_area, V::load_unaligned(triangles.squared_size + i), places,
                      with_area & lanes_up_to(count - i));
    }
    batch.finish(plate);
    return batch.left_count();
  }

  static std::size_t integrate_virtual(const VirtualTriangles& triangles, std::size_t count,
                                       const Choices& choices, double* values, std::uint32_t* left) {
    // Heights whose ratio to others overflows are left to the code that avoids the division.
    constexpr double least_height = 1e-200;
    BatchIntegration<Lanes> batch(choices, values, left, least_height);
    Places<Lanes> places;
    places.consecutive = true;
    for (std::size_t i = 0; i < count; i += width) {
      for (int lane = 0; lane < width; ++lane)
        places.indices[lane] = static_cast<std::uint32_t>(i) + static_cast<std::uint32_t>(lane);
      V v[9];
      for (int k = 0; k < 9; ++k)
        v[k] = V::load_unaligned(triangles.components[k] + i);
      const auto in_front =
          (v[0] == V(0)) & (v[1] == V(0)) & (v[3] == V(0)) & (v[4] == V(0)) & (v[6] == V(0)) & (v[7] == V(0));
      const VirtualLanes<V> triangle{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}};
      batch.evaluate(triangle, V::load_unaligned(triangles.weight + i), batch.squared_size(triangle),
                     in_front, places, lanes_up_to(count - i));
    }
    batch.finish();
    return batch.left_count();
  }
  // NOLINTEND(readability-non-const-parameter)

  static double sum_over_nodes(const PlateCoordinates& plate, const double* x, const double* y,
                               const double* z, const double* weight, std::size_t count) {
    const PlateLanes frame(plate);
    const V length_u(plate.length_u), length_v(plate.length_v);
    V sum(0);
    for (std::size_t i = 0; i < count; i += width) {
      Vector3<V> point =
          frame.local({V::load_unaligned(x + i), V::load_unaligned(y + i), V::load_unaligned(z + i)});
      point.x = point.x - min(max(point.x, V(0)), length_u);
      point.y = point.y - min(max(point.y, V(0)), length_v);
      sum = fma(V::load_unaligned(weight + i), inverse_square_root<Lanes>(squared_norm(point)), sum);
    }
    return hadd(sum);
  }

  static void soft_inverse_distances(const double* const (&columns)[3], std::size_t stride,
                                     const double* rows, std::size_t row_count, double squared_softness,
                                     double* values) {
    const V softness(squared_softness);
    for (std::size_t row = 0; row < row_count; ++row) {
      const Vector3<V> point{V(rows[3 * row]), V(rows[3 * row + 1]), V(rows[3 * row + 2])};
      for (std::size_t i = 0; i < stride; i += width) {
        const Vector3<V> column{V::load_unaligned(columns[0] + i), V::load_unaligned(columns[1] + i),
                                V::load_unaligned(columns[2] + i)};
        inverse_square_root<Lanes>(squared_norm(column - point) + softness)
            .store_unaligned(values + row * stride + i);
      }
    }
  }

  static constexpr BatchKernels kernels{&measure, &integrate, &integrate_virtual, &sum_over_nodes,
                                        &soft_inverse_distances};

 private:
  static V area_doubled(const VirtualLanes<V>& triangle) {
    const Vector3<V> edge0 = triangle.v2 - triangle.v1, edge1 = triangle.v0 - triangle.v2,
                     edge2 = triangle.v1 - triangle.v0;
    const V squared0 = squared_norm(edge0), squared1 = squared_norm(edge1), squared2 = squared_norm(edge2);
    // The two shorter edges carry the smallest rounding error into the cross product.
    const V longest = max(squared0, max(squared1, squared2));
    const Mask longest0 = squared0 == longest, longest1 = squared1 == longest;
    const Vector3<V> first = select(longest0, edge1, select(longest1, edge2, edge0));
    const Vector3<V> second = select(longest0, edge2, select(longest1, edge0, edge1));
    return sqrt(squared_norm(cross<Lanes>(first, second)));
  }

  /// A plate's frame in all lanes.
  struct PlateLanes {
    explicit PlateLanes(const PlateCoordinates& plate)
        : corner{V(plate.corner[0]), V(plate.corner[1]), V(plate.corner[2])} {
      for (std::size_t i = 0; i < 3; ++i)
        axes[i] = {V(plate.axes[3 * i]), V(plate.axes[3 * i + 1]), V(plate.axes[3 * i + 2])};
    }

    Vector3<V> local(const Vector3<V>& point) const {
      const Vector3<V> from_corner = point - corner;
      return {dot(axes[0], from_corner), dot(axes[1], from_corner), dot(axes[2], from_corner)};
    }

    Vector3<V> corner;
    Vector3<V> axes[3];
  };

  static unsigned lanes_up_to(std::size_t count) {
    return count >= static_cast<std::size_t>(width) ? (1U << width) - 1 : (1U << count) - 1;
  }
};

}  // namespace fringe::detail
