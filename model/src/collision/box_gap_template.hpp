#pragma once

#include <cstddef>

#include "collision/support_template.hpp"

/// The separating axis test of two boxes for the instruction set that `Lanes` represents.
namespace fringe::detail {

template <class Lanes>
struct BoxGapFor {
  /// Computes the largest gap along the fifteen candidate separating axes; those that are cross products of
  /// two edges are not normalised. Overflow makes the result NaN.
  static double box_gap(const BoxNumbers& a, const BoxNumbers& b) {
    // Loads four numbers from a place within the box's bytes; the fourth belongs to a neighbouring array.
    const auto loaded = [](const BoxNumbers& box, std::size_t place, Four& four) {
      __builtin_memcpy(&four, reinterpret_cast<const char*>(&box) + place, sizeof(Four));
    };
    BoxLanes lanes_a, lanes_b;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t axis = offsetof(BoxNumbers, axes) + 3 * k * sizeof(double);
      loaded(a, axis, lanes_a.axes[k]);
      loaded(b, axis, lanes_b.axes[k]);
    }
    // The number in front of the half-widths goes to the unused lane.
    constexpr std::size_t before_half = offsetof(BoxNumbers, half_widths) - sizeof(double);
    loaded(a, before_half, lanes_a.half);
    loaded(b, before_half, lanes_b.half);
    lanes_a.half = __builtin_shufflevector(lanes_a.half, lanes_a.half, 1, 2, 3, 0);
    lanes_b.half = __builtin_shufflevector(lanes_b.half, lanes_b.half, 1, 2, 3, 0);
    return gap(lanes_a, lanes_b,
               {b.centre[0] - a.centre[0], b.centre[1] - a.centre[1], b.centre[2] - a.centre[2]});
  }

  /// Tests two boxes by their fifteen candidate separating axes.
  static Verdict compare(const PlacedShape& a, const PlacedShape& b) {
    const auto lanes_of = [](const PlacedShape& box, BoxLanes& lanes) {
      for (int k = 0; k < 3; ++k)
        lanes.axes[k] = Four{box.pose[k], box.pose[4 + k], box.pose[8 + k], 0};
      lanes.half = Four{box.shape->size[0], box.shape->size[1], box.shape->size[2], 0};
    };
    BoxLanes lanes_a, lanes_b;
    lanes_of(a, lanes_a);
    lanes_of(b, lanes_b);
    const Vec between{b.pose[12] - a.pose[12], b.pose[13] - a.pose[13], b.pose[14] - a.pose[14]};
    const double extent =
        Support::sum_of_magnitudes(between) + a.shape->bounding_radius + b.shape->bounding_radius;
    // In this range squares neither overflow nor, where it matters, underflow.
    if (!(extent < 0x1p500 && extent > 0x1p-500))
      return Verdict::undecided;
    // The margin is large enough for poses whose matrices are rotations only to 1e-9.
    const double margin = 0x1p-24 * extent, largest_gap = gap(lanes_a, lanes_b, between);
    if (largest_gap > margin)
      return Verdict::disjoint;
    return largest_gap < -margin ? Verdict::intersecting : Verdict::undecided;
  }

 private:
  using Support = SupportFor<Lanes>;
  using Four = typename Support::Four;
  using Vec = typename Support::Vec;

  struct BoxLanes {
    Four axes[3];  ///< the x of the three axes, then their y, then their z
    Four half;     ///< half-widths
  };

  static void add_product(const Four& a, const Four& b, Four& sum) {
    if constexpr (Lanes::fused)
      sum = Lanes::fused_four(a, b, sum);
    else
      sum += a * b;
  }
  static void add_product(double a, const Four& b, Four& sum) { add_product(Four{a, a, a, a}, b, sum); }

  /// Computes the largest gap along the fifteen axes of the separating axis test (S. Gottschalk, M. C. Lin
  /// and D. Manocha, SIGGRAPH 1996, 171).
  static double gap(const BoxLanes& a, const BoxLanes& b, const Vec& between) {
    const Four* const axes_a = a.axes;
    const Four* const axes_b = b.axes;
    const Four half_a = a.half, half_b = b.half;
    const auto magnitude = [](const Four& value, Four& result) { result = value < 0 ? -value : value; };
    // Computes x a + y b + z c.
    const auto combined = [](double x, const Four& a, double y, const Four& b, double z, const Four& c,
                             Four& result) {
      result = x * a;
      add_product(y, b, result);
      add_product(z, c, result);
    };
    Four along_a, along_b;
    combined(between.x, axes_a[0], between.y, axes_a[1], between.z, axes_a[2], along_a);
    combined(between.x, axes_b[0], between.y, axes_b[1], between.z, axes_b[2], along_b);
    Four cosines[3], sizes[3];  // of each axis of A with the axes of B
    for (int i = 0; i < 3; ++i) {
      combined(axes_a[0][i], axes_b[0], axes_a[1][i], axes_b[1], axes_a[2][i], axes_b[2], cosines[i]);
      magnitude(cosines[i], sizes[i]);
    }
    Four radius_on_a = half_a, radius_on_b = half_b;
    for (int j = 0; j < 3; ++j) {
      Four size;
      combined(axes_b[0][j], axes_a[0], axes_b[1][j], axes_a[1], axes_b[2][j], axes_a[2], size);
      magnitude(size, size);
      add_product(half_b[j], size, radius_on_a);
      add_product(half_a[j], sizes[j], radius_on_b);
    }
    Four distance;
    magnitude(along_a, distance);
    Four gaps = distance - radius_on_a;
    const auto take = [&](const Four& along, const Four& radius) {
      Four value;
      magnitude(along, value);
      value -= radius;
      gaps = value > gaps ? value : gaps;
    };
    take(along_b, radius_on_b);
    const Four half_b1 = __builtin_shufflevector(half_b, half_b, 1, 2, 0, 3);
    const Four half_b2 = __builtin_shufflevector(half_b, half_b, 2, 0, 1, 3);
    for (int i = 0; i < 3; ++i) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
      Four along = along_a[i2] * cosines[i1], radius = half_a[i1] * sizes[i2];
      add_product(-along_a[i1], cosines[i2], along);
      add_product(half_a[i2], sizes[i1], radius);
      add_product(half_b1, __builtin_shufflevector(sizes[i], sizes[i], 2, 0, 1, 3), radius);
      add_product(half_b2, __builtin_shufflevector(sizes[i], sizes[i], 1, 2, 0, 3), radius);
      take(along, radius);
    }
    const double largest = gaps[0] > gaps[1] ? gaps[0] : gaps[1];
    return largest > gaps[2] ? largest : gaps[2];
  }
};

}  // namespace fringe::detail
