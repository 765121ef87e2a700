#pragma once

#include <cstddef>
#include <cstdint>

#include "integral/derivative/kernels.hpp"
#include "integral/derivative/wrench_forms.hpp"
#include "simd/vector_math.hpp"

/// The derivatives of ∫dA/d for one instruction set, given by the template parameter `Lanes`
/// (model/NUMERICS.md, section 15).
namespace fringe::detail {

/// Adds up the wrenches of triangles that each lie in one cell: by a quadrature rule at once, or after a
/// register of those that need the same formula has been collected.
template <class Lanes>
class WrenchSum {
 public:
  using V = typename Lanes::Vector;
  using Mask = typename Lanes::Mask;
  static constexpr int width = Lanes::width;

  WrenchSum(const Choices& choices, double least_distance)
      : choices_(choices), least_distance_(least_distance), least_squared_(least_distance * least_distance) {}

  /// Adds the marked lanes; `weight` is twice the area.
  void add(const CornerLanes<V> (&corners)[3], const V& weight, unsigned lanes) {
    const auto none = [](const Vector3<V>& vector) { return (vector.x == V(0)) & (vector.y == V(0)); };
    const unsigned in_front =
        Lanes::bits(none(corners[0].vector) & none(corners[1].vector) & none(corners[2].vector)) & lanes;
    if (in_front != 0)
      add_in_front(corners, weight, in_front);
    if (in_front != lanes)
      add_beside(corners, weight, lanes & ~in_front);
  }

  /// Adds what is still collected, and all sums to `sums`.
  void finish(double* sums) {
    drain_closed(1);
    drain_along_height(1);
    const V parts[] = {force_.x, force_.y, force_.z, moment_.x, moment_.y, moment_.z};
    for (std::size_t k = 0; k < wrench_components; ++k)
      sums[k] = touches_ ? __builtin_nan("") : sums[k] + hadd(parts[k]);
  }

 private:
  /// Adds triangles of region I.
  void add_in_front(const CornerLanes<V> (&corners)[3], const V& weight, unsigned lanes) {
    const V &z0 = corners[0].vector.z, &z1 = corners[1].vector.z, &z2 = corners[2].vector.z;
    const V least(least_distance_);
    const Mask clear = (min(z0, min(z1, z2)) > least) | (max(z0, max(z1, z2)) < V(0) - least);
    if ((Lanes::bits(clear) & lanes) != lanes)
      touches_ = true;
    else
      add(wrench_in_front<Lanes>(corners), weight, lanes);
  }

  /// Adds triangles of the other regions.
  void add_beside(const CornerLanes<V> (&corners)[3], const V& weight, unsigned lanes) {
    const Vector3<V>&v0 = corners[0].vector, &v1 = corners[1].vector, &v2 = corners[2].vector;
    const V third(1.0 / 3);
    const Vector3<V> sum = v0 + v1 + v2, centroid{third * sum.x, third * sum.y, third * sum.z};
    const V squared_distance = squared_norm(centroid);
    const V squared_size =
        max(squared_norm(v0 - centroid), max(squared_norm(v1 - centroid), squared_norm(v2 - centroid)));
    const auto beyond = [&](const RuleChoice& rule) {
      return Lanes::bits(squared_size > V(rule.largest_squared_ratio) * squared_distance);
    };
    const unsigned near = beyond(choices_.rules.back()) & lanes, far = lanes & ~near;
    if (far != 0) {
      std::size_t rule = 0;
      while ((beyond(choices_.rules[rule]) & far) != 0)
        ++rule;
      add(wrench_by_rule<Lanes>(choices_.rules[rule], corners), weight, far);
    }
    if (near == 0)
      return;
    const V squared_length = max(squared_norm(v1 - v0), max(squared_norm(v2 - v1), squared_norm(v0 - v2)));
    const Vector3<V> edge1 = v1 - v0, edge2 = v2 - v0;
    const V squared_height =
        squared_norm(Vector3<V>{edge1.y * edge2.z - edge1.z * edge2.y, edge1.z * edge2.x - edge1.x * edge2.z,
                                edge1.x * edge2.y - edge1.y * edge2.x}) /
        max(squared_length, V(smallest));
    const V squared_gap = squared_distance_to_triangle(v0, v1, v2);
    if ((Lanes::bits(squared_gap <= V(least_squared_)) & near) != 0)
      touches_ = true;
    const unsigned closed =
        Lanes::bits((squared_length < V(most_heights_long * most_heights_long) * squared_height) |
                    (squared_gap < squared_height)) &
        near;
    queue(closed_, corners, weight, squared_gap, squared_height, closed);
    queue(along_height_, corners, weight, squared_gap, squared_height, near & ~closed);
    if (closed_.size > Queue::capacity - width)
      drain_closed(width);
    if (along_height_.size > Queue::capacity - width)
      drain_along_height(width);
  }

  /// Largest ratio of length to height for which the closed form is used: it loses about as many units in the
  /// last place, of which the derivatives need eight digits.
  static constexpr double most_heights_long = 30;

  /// Triangles that wait until a whole register of the same kind has been collected: corners, nearest points,
  /// weight, squared distance and squared height.
  struct Queue {
    static constexpr int capacity = 64, components = 18;
    double values[components][capacity + width];
    int size = 0;
  };

  static void queue(Queue& queue, const CornerLanes<V> (&corners)[3], const V& weight, const V& squared_gap,
                    const V& squared_height, unsigned lanes) {
    if (lanes == 0)
      return;
    double spread[Queue::components][width];
    for (int i = 0; i < 3; ++i) {
      corners[i].vector.x.store_unaligned(spread[5 * i]);
      corners[i].vector.y.store_unaligned(spread[5 * i + 1]);
      corners[i].vector.z.store_unaligned(spread[5 * i + 2]);
      corners[i].nearest_u.store_unaligned(spread[5 * i + 3]);
      corners[i].nearest_v.store_unaligned(spread[5 * i + 4]);
    }
    weight.store_unaligned(spread[15]);
    squared_gap.store_unaligned(spread[16]);
    squared_height.store_unaligned(spread[17]);
    for (int lane = 0; lane < width; ++lane) {
      if ((lanes >> lane & 1U) == 0)
        continue;
      for (int k = 0; k < Queue::components; ++k)
        queue.values[k][queue.size] = spread[k][lane];
      ++queue.size;
    }
  }

  /// Removes up to one register of triangles and calls take(corners, weight, squared distance, squared
  /// height, lanes) until fewer than `least` are left. The lanes beyond the last triangle repeat one.
  template <class Take>
  static void drain(Queue& queue, int least, const Take& take) {
    while (queue.size >= least && queue.size > 0) {
      const int taken = queue.size < width ? queue.size : width;
      queue.size -= taken;
      for (int lane = taken; lane < width; ++lane)
        for (auto& values_of_one : queue.values)
          values_of_one[queue.size + lane] = values_of_one[queue.size];
      const auto value = [&](int k) { return V::load_unaligned(queue.values[k] + queue.size); };
      CornerLanes<V> corners[3];
      for (int i = 0; i < 3; ++i)
        corners[i] = {{value(5 * i), value(5 * i + 1), value(5 * i + 2)}, value(5 * i + 3), value(5 * i + 4)};
      take(corners, value(15), value(16), value(17), (1U << taken) - 1);
    }
  }

  void drain_closed(int least) {
    drain(closed_, least,
          [&](const CornerLanes<V>(&corners)[3], const V& weight, const V&, const V&, unsigned lanes) {
            add(wrench_closed<Lanes>(corners), weight, lanes);
          });
  }

  void drain_along_height(int least) {
    drain(along_height_, least,
          [&](const CornerLanes<V>(&corners)[3], const V& weight, const V& squared_gap,
              const V& squared_height, unsigned lanes) {
            std::size_t rule = 0;
            while (rule + 1 < choices_.height_rules.size() &&
                   (Lanes::bits(squared_gap <
                                V(choices_.height_rules[rule].smallest_squared_ratio) * squared_height) &
                    lanes) != 0)
              ++rule;
            const HeightRuleChoice& chosen = choices_.height_rules[rule];
            add(wrench_along_height<Lanes>(corners, chosen.nodes, chosen.points), weight, lanes);
          });
  }

  void add(const WrenchLanes<V>& wrench, const V& weight, unsigned lanes) {
    constexpr unsigned all_lanes = (1U << width) - 1;
    V marked = weight;
    Vector3<V> force = wrench.force, moment = wrench.moment;
    if (lanes != all_lanes) {
      double flags[width];
      for (int lane = 0; lane < width; ++lane)
        flags[lane] = (lanes >> lane & 1U) != 0 ? 1 : 0;
      const Mask taken = V::load_unaligned(flags) > V(0);
      const Vector3<V> zero{V(0), V(0), V(0)};
      marked = select(taken, weight, V(0));
      force = select(taken, force, zero);
      moment = select(taken, moment, zero);
    }
    force_ = along(force_, marked, force);
    moment_ = along(moment_, marked, moment);
  }

  const Choices& choices_;
  double least_distance_;
  double least_squared_;
  bool touches_ = false;
  Vector3<V> force_{V(0), V(0), V(0)}, moment_{V(0), V(0), V(0)};
  Queue closed_, along_height_;
};

/// The functions of DerivativeKernels for one instruction set.
template <class Lanes>
struct DerivativeKernelsFor {
  using V = typename Lanes::Vector;
  using Mask = typename Lanes::Mask;
  static constexpr int width = Lanes::width;

  // NOLINTBEGIN(readability-non-const-parameter): the functions write through sums and left.
  static std::size_t add_triangles(const TriangleArrays& triangles, std::size_t count,
                                   const PlateCoordinates& plate, double scale, const Choices& choices,
                                   double least_distance, double* sums, std::uint32_t* left) {
    WrenchSum<Lanes> sum(choices, least_distance);
    std::size_t left_count = 0;
    const Vector3<V> corner{V(plate.corner[0]), V(plate.corner[1]), V(plate.corner[2])};
    Vector3<V> axes[3];
    for (std::size_t i = 0; i < 3; ++i)
      axes[i] = {V(scale * plate.axes[3 * i]), V(scale * plate.axes[3 * i + 1]),
                 V(scale * plate.axes[3 * i + 2])};
    const V length_u(scale * plate.length_u), length_v(scale * plate.length_v);
    for (std::size_t i = 0; i < count; i += width) {
      Vector3<V> local[3];
      for (std::size_t vertex = 0; vertex < 3; ++vertex) {
        const Vector3<V> from_corner =
            Vector3<V>{V::load_unaligned(triangles.coordinates[3 * vertex] + i),
                       V::load_unaligned(triangles.coordinates[3 * vertex + 1] + i),
                       V::load_unaligned(triangles.coordinates[3 * vertex + 2] + i)} -
            corner;
        local[vertex] = {dot(axes[0], from_corner), dot(axes[1], from_corner), dot(axes[2], from_corner)};
      }
      const V twice_area = V(scale * scale) * V::load_unaligned(triangles.twice_area + i);
      const unsigned lanes = Lanes::bits(twice_area > V(0)) & lanes_up_to(count - i);
      const unsigned whole = Lanes::bits(in_one_strip(local[0].x, local[1].x, local[2].x, length_u) &
                                         in_one_strip(local[0].y, local[1].y, local[2].y, length_v)) &
                             lanes;
      if (whole != 0)
        add_local(sum, local, twice_area, length_u, length_v, whole);
      unsigned straddling = lanes & ~whole;
      if (straddling != 0)
        straddling = cut(sum, local, twice_area, length_u, length_v, straddling);
      for (int lane = 0; lane < width; ++lane)
        if ((straddling >> lane & 1U) != 0)
          left[left_count++] = static_cast<std::uint32_t>(i) + static_cast<std::uint32_t>(lane);
    }
    sum.finish(sums);
    return left_count;
  }

  static void add_pieces(const PlacedPieces& pieces, std::size_t count, double scale, const Choices& choices,
                         double least_distance, double* sums) {
    WrenchSum<Lanes> sum(choices, least_distance);
    const V factor(scale);
    for (std::size_t i = 0; i < count; i += width) {
      const auto scaled = [&](const double* numbers) { return factor * V::load_unaligned(numbers + i); };
      CornerLanes<V> corners[3];
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = {{scaled(pieces.vectors[3 * k]), scaled(pieces.vectors[3 * k + 1]),
                       scaled(pieces.vectors[3 * k + 2])},
                      scaled(pieces.nearest[2 * k]),
                      scaled(pieces.nearest[2 * k + 1])};
      sum.add(corners, factor * scaled(pieces.weight), lanes_up_to(count - i));
    }
    sum.finish(sums);
  }
  // NOLINTEND(readability-non-const-parameter)

  static constexpr DerivativeKernels kernels{&add_triangles, &add_pieces};

 private:
  /// Adds triangles that lie in one cell, given in the plate's coordinates.
  static void add_local(WrenchSum<Lanes>& sum, const Vector3<V> (&local)[3], const V& twice_area,
                        const V& length_u, const V& length_v, unsigned lanes) {
    CornerLanes<V> corners[3];
    for (int k = 0; k < 3; ++k) {
      const V u = min(max(local[k].x, V(0)), length_u), v = min(max(local[k].y, V(0)), length_v);
      corners[k] = {{local[k].x - u, local[k].y - v, local[k].z}, u, v};
    }
    sum.add(corners, twice_area, lanes);
  }

  /// Cuts triangles that one border plane crosses into three pieces and adds these. Returns the lanes of
  /// those that several border planes cross.
  static unsigned cut(WrenchSum<Lanes>& sum, const Vector3<V> (&local)[3], const V& twice_area,
                      const V& length_u, const V& length_v, unsigned lanes) {
    // Swap the axes so that the crossed one is x.
    const Mask swap = in_one_strip(local[0].x, local[1].x, local[2].x, length_u);
    Vector3<V> points[3];
    for (int i = 0; i < 3; ++i)
      points[i] = {select(swap, local[i].y, local[i].x), select(swap, local[i].x, local[i].y), local[i].z};
    const V length_x = select(swap, length_v, length_u), length_y = select(swap, length_u, length_v);
    const V lowest = min(points[0].x, min(points[1].x, points[2].x)),
            highest = max(points[0].x, max(points[1].x, points[2].x));
    const Mask at_zero = (lowest < V(0)) & (highest > V(0)) & (highest <= length_x);
    const Mask at_length = (lowest >= V(0)) & (lowest < length_x) & (highest > length_x);
    const unsigned single =
        Lanes::bits(in_one_strip(points[0].y, points[1].y, points[2].y, length_y) & (at_zero | at_length)) &
        lanes;
    if (single == 0)
      return lanes;
    const V border = select(at_zero, V(0), length_x);
    const auto beyond = [&](int i) { return points[i].x > border; };
    const Mask beyond0 = beyond(0), beyond1 = beyond(1), beyond2 = beyond(2);
    // Rotate the vertices so that the one alone on its side comes first.
    const Mask one_alone = ((!beyond0) & beyond1 & (!beyond2)) | (beyond0 & (!beyond1) & beyond2);
    const Mask two_alone = ((!beyond0) & (!beyond1) & beyond2) | (beyond0 & beyond1 & (!beyond2));
    const auto turned = [&](const Vector3<V>& a, const Vector3<V>& b, const Vector3<V>& c) {
      return select(two_alone, c, select(one_alone, b, a));
    };
    const Vector3<V> lone = turned(points[0], points[1], points[2]),
                     next = turned(points[1], points[2], points[0]),
                     last = turned(points[2], points[0], points[1]);
    const auto crossing = [&](const Vector3<V>& end) {
      const V way = lone.x - end.x;
      return min(max((lone.x - border) / select(way == V(0), V(1), way), V(0)), V(1));
    };
    const V to_next = crossing(next), to_last = crossing(last);
    Vector3<V> cut_next = along(lone, to_next, next - lone), cut_last = along(lone, to_last, last - lone);
    cut_next.x = cut_last.x = border;
    const auto add_piece = [&](const Vector3<V>& a, const Vector3<V>& b, const Vector3<V>& c,
                               const V& share) {
      const Vector3<V>* piece[] = {&a, &b, &c};
      Vector3<V> corners[3];
      for (int i = 0; i < 3; ++i)
        corners[i] = {select(swap, piece[i]->y, piece[i]->x), select(swap, piece[i]->x, piece[i]->y),
                      piece[i]->z};
      const V weight = share * twice_area;
      add_local(sum, corners, weight, length_u, length_v, Lanes::bits(weight > V(0)) & single);
    };
    add_piece(lone, cut_next, cut_last, to_next * to_last);
    add_piece(cut_next, next, last, V(1) - to_next);
    add_piece(cut_next, last, cut_last, to_next * (V(1) - to_last));
    return lanes & ~single;
  }

  /// Returns whether three coordinates lie in one of the three strips along an axis.
  static Mask in_one_strip(const V& a, const V& b, const V& c, const V& length) {
    const V lowest = min(a, min(b, c)), highest = max(a, max(b, c));
    return (highest <= V(0)) | (lowest >= length) | ((lowest >= V(0)) & (highest <= length));
  }

  static unsigned lanes_up_to(std::size_t count) {
    return count >= static_cast<std::size_t>(width) ? (1U << width) - 1 : (1U << count) - 1;
  }
};

}  // namespace fringe::detail
