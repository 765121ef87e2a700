#pragma once

#include <cstddef>
#include <cstdint>

#include "collision/gjk_filter.hpp"

/// The filtered GJK search for the instruction set that `Lanes` represents.
namespace fringe::detail {

template <class Lanes>
class GjkFilterFor {
 public:
  static Verdict decide(const PlacedShape& a, const PlacedShape& b) {
    GjkFilterAnswer answer;
    return dispatched<false>(a, b, answer);
  }

  static void prove(const PlacedShape& a, const PlacedShape& b, GjkFilterAnswer& answer) {
    answer.verdict = dispatched<true>(a, b, answer);
  }

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

  static std::uint32_t support(const SupportShape& shape, const double* direction, double* point) {
    const Vec d{direction[0], direction[1], direction[2]};
    const Local local = shape.kind == ShapeKind::hull  ? Hull::support(shape, d)
                        : shape.kind == ShapeKind::box ? Box::support(shape, d)
                                                       : Curved::support(shape, d);
    point[0] = local.at.x;
    point[1] = local.at.y;
    point[2] = local.at.z;
    return local.index;
  }

  static constexpr GjkFilter kernels{&decide, &prove, &support, &box_gap};

 private:
  /// Three numbers and an unused fourth lane.
  using Four = double __attribute__((vector_size(32)));

  struct Vec {
    double x, y, z;
  };

  /// A support point in the shape's frame, and its index among the vertices.
  struct Local {
    Vec at;
    std::uint32_t index;
  };

  /// A point of the Minkowski difference, and the iteration that found it.
  struct Point {
    Vec at;
    int round;
  };

  /// The support points whose difference a point of the Minkowski difference is.
  struct Source {
    Local a, b;
  };

  static double fused(double a, double b, double c) {
    if constexpr (Lanes::fused)
      return __builtin_fma(a, b, c);
    else
      return a * b + c;
  }
  static Vec minus(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  static Vec negated(const Vec& a) { return {-a.x, -a.y, -a.z}; }
  static double dot(const Vec& a, const Vec& b) { return fused(a.x, b.x, fused(a.y, b.y, a.z * b.z)); }
  /// Returns a b − c d with one rounding less where fused multiply-add exists.
  static double difference_of_products(double a, double b, double c, double d) {
    return fused(a, b, -(c * d));
  }
  static Vec cross(const Vec& a, const Vec& b) {
    return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
            difference_of_products(a.x, b.y, a.y, b.x)};
  }
  /// Returns the 1-norm of a vector.
  static double sum_of_magnitudes(const Vec& a) {
    return __builtin_fabs(a.x) + __builtin_fabs(a.y) + __builtin_fabs(a.z);
  }

  /// Returns zero, or NaN if a number of a rotation is not finite.
  static double zero_if_finite(const double* pose_a, const double* pose_b) {
    Four sum{};
    for (const double* pose : {pose_a, pose_b})
      for (std::size_t column = 0; column < 3; ++column) {
        Four numbers;
        __builtin_memcpy(&numbers, pose + 4 * column, sizeof(Four));
        sum += numbers;
      }
    return 0 * (sum[0] + sum[1] + sum[2]);
  }

  /// Turns a direction into the shape's frame (by the transposed rotation).
  static Vec to_local(const double* pose, const Vec& d) {
    return {dot({pose[0], pose[1], pose[2]}, d), dot({pose[4], pose[5], pose[6]}, d),
            dot({pose[8], pose[9], pose[10]}, d)};
  }
  /// Rotates a point and adds an offset.
  static Vec rotated(const double* pose, const Vec& p, const Vec& plus) {
    return {fused(pose[0], p.x, fused(pose[4], p.y, fused(pose[8], p.z, plus.x))),
            fused(pose[1], p.x, fused(pose[5], p.y, fused(pose[9], p.z, plus.y))),
            fused(pose[2], p.x, fused(pose[6], p.y, fused(pose[10], p.z, plus.z)))};
  }

  using V = typename Lanes::Vector;
  static constexpr std::size_t width = Lanes::width;

  /// Computes the dot products of the vertices of a block with (x, y, z), from a lane on.
  static V products(const double* block, std::size_t lane, const V& x, const V& y, const V& z) {
    constexpr std::size_t size = VertexBlocks::size;
    return fma(
        x, V::load_unaligned(block + lane),
        fma(y, V::load_unaligned(block + size + lane), z * V::load_unaligned(block + 2 * size + lane)));
  }

  static Vec vertex(const VertexBlocks& vertices, std::size_t i) {
    constexpr std::size_t size = VertexBlocks::size;
    const double* const block = vertices.coordinates + i / size * (3 * size) + i % size;
    return {block[0], block[size], block[2 * size]};
  }

  /// Finds a support point among the vertices from `first` up to below `last`.
  static std::size_t farthest(const VertexBlocks& vertices, std::size_t first, std::size_t last,
                              const Vec& d) {
    constexpr std::size_t size = VertexBlocks::size;
    const V x(d.x), y(d.y), z(d.z);
    V best = products(vertices.coordinates + first * 3, 0, x, y, z), place(static_cast<double>(first));
    for (std::size_t i = first; i < last; i += size)
      for (std::size_t lane = 0; lane < size; lane += width) {
        const V product = products(vertices.coordinates + i * 3, lane, x, y, z);
        place = select(product > best, V(static_cast<double>(i + lane)), place);
        best = max(best, product);
      }
    const unsigned which = Lanes::bits(best == V(Lanes::largest(best))) | (1U << (width - 1));
    const auto lane = static_cast<std::size_t>(__builtin_ctz(which));
    double places[width];
    place.store_unaligned(places);
    return static_cast<std::size_t>(places[lane]) + lane;
  }

  /// Returns the index of the square along one side of a cube face.
  static int square(double along, double inverse_of_main, int resolution) {
    const double half = 0.5 * resolution;
    const int index = static_cast<int>(fused(along * inverse_of_main, half, half));
    return index < resolution ? index : resolution - 1;
  }

  /// Returns the index of the direction cell.
  static std::uint32_t cell(int resolution, const Vec& d) {
    const double x = __builtin_fabs(d.x), y = __builtin_fabs(d.y), z = __builtin_fabs(d.z);
    int face;
    double main, u, v;
    if (x >= y && x >= z) {
      face = d.x < 0 ? 1 : 0;
      main = x, u = d.y, v = d.z;
    } else if (y >= z) {
      face = d.y < 0 ? 3 : 2;
      main = y, u = d.z, v = d.x;
    } else {
      face = d.z < 0 ? 5 : 4;
      main = z, u = d.x, v = d.y;
    }
    const double inverse = 1 / main;
    return static_cast<std::uint32_t>((face * resolution + square(u, inverse, resolution)) * resolution +
                                      square(v, inverse, resolution));
  }

  /// Finds a hull's support point, by its direction cells if it has any.
  static Local hull_support(const SupportShape& shape, const Vec& d) {
    const DirectionCells& cells = shape.cells;
    if (cells.resolution == 0) {
      const std::size_t i = farthest(shape.vertices, 0, shape.vertices.count, d);
      const auto index = static_cast<std::uint32_t>(i);
      return {vertex(shape.vertices, i), index < shape.vertices.last ? index : shape.vertices.last};
    }
    const std::uint32_t c = cell(cells.resolution, d);
    const std::size_t i = farthest(cells.vertices, cells.starts[c], cells.starts[c + 1], d);
    return {vertex(cells.vertices, i), cells.indices[i]};
  }

  /// Returns (x, y, z) with (x, y) of length `radius` along (d.x, d.y), or along x if that is zero.
  static Vec on_circle(double radius, const Vec& d, double z) {
    double x = d.x, y = d.y, square = fused(x, x, y * y);
    // Where the squares would underflow or overflow, the direction is first scaled towards 1.
    constexpr double small = 0x1p-900, large = 0x1p900, near_1 = 0x1p500;
    if (square < small || square > large) {
      const double factor = square < small ? near_1 : 1 / near_1;
      x *= factor, y *= factor, square = fused(x, x, y * y);
      if (square < small)
        return {radius, 0, z};
    }
    const double factor = radius / __builtin_sqrt(square);
    return {x * factor, y * factor, z};
  }

  static Local ball_support(const SupportShape& shape, const Vec& d) {
    const Vec across = on_circle(1, d, 0);
    const double horizontal = fused(across.x, d.x, across.y * d.y);
    const Vec tilted = on_circle(shape.size[0], {horizontal, d.z, 0}, 0);
    return {{across.x * tilted.x, across.y * tilted.x, tilted.y}, 0};
  }

  static Local cone_support(const SupportShape& shape, const Vec& d) {
    const Vec rim = on_circle(shape.size[0], d, -shape.size[1]);
    const double height_of_rim = fused(rim.x, d.x, fused(rim.y, d.y, rim.z * d.z));
    if (shape.size[1] * d.z > height_of_rim)
      return {{0, 0, shape.size[1]}, 0};
    return {rim, 0};
  }

  /// Finds a sector's support point: on the outer arc if the direction is between the ends, otherwise at an
  /// end.
  static Local sector_support(const SupportShape& shape, const Vec& d) {
    const double* ends = shape.ends;
    const double z = __builtin_copysign(shape.size[1], d.z);
    const double from_first = difference_of_products(ends[0], d.y, ends[1], d.x),
                 to_second = difference_of_products(d.x, ends[3], d.y, ends[2]);
    const double first = fused(ends[0], d.x, ends[1] * d.y), second = fused(ends[2], d.x, ends[3] * d.y);
    if (from_first >= 0 && to_second >= 0 && first + second > 0)
      return {on_circle(shape.size[0], d, z), 0};
    const double* end = first > second ? ends : ends + 2;
    const double radius = (first > second ? first : second) > 0 ? shape.size[0] : shape.size[2];
    return {{radius * end[0], radius * end[1], z}, 0};
  }

  /// The kinds of shape for which the search is compiled separately; Curved covers all round ones.
  struct Hull {
    static Local support(const SupportShape& shape, const Vec& d) { return hull_support(shape, d); }
  };
  struct Box {
    static Local support(const SupportShape& shape, const Vec& d) {
      return {{__builtin_copysign(shape.size[0], d.x), __builtin_copysign(shape.size[1], d.y),
               __builtin_copysign(shape.size[2], d.z)},
              static_cast<std::uint32_t>((d.x < 0 ? 0 : 1) | (d.y < 0 ? 0 : 2) | (d.z < 0 ? 0 : 4))};
    }
  };
  struct Curved {
    static Local support(const SupportShape& shape, const Vec& d) {
      switch (shape.kind) {
      case ShapeKind::ball:
        return ball_support(shape, d);
      case ShapeKind::cylinder:
        return {on_circle(shape.size[0], d, __builtin_copysign(shape.size[1], d.z)), 0};
      case ShapeKind::cone:
        return cone_support(shape, d);
      default:
        return sector_support(shape, d);
      }
    }
  };

  /// A support point of a moved shape, in the world and in the shape's frame.
  struct SupportPoint {
    Vec at;
    Local local;
  };

  /// The support mapping of a moved shape: turns the direction into the shape's frame and the point out of
  /// it.
  template <class Kind>
  struct Turned {
    const SupportShape& shape;
    const double* pose;
    Vec offset;

    Turned(const PlacedShape& placed, const Vec& to) : shape(*placed.shape), pose(placed.pose), offset(to) {}

    SupportPoint farthest(const Vec& d) const {
      const Local local = Kind::support(shape, to_local(pose, d));
      return {rotated(pose, local.at, offset), local};
    }
  };

  /// The support mapping of a moved hull with at most this many vertices, all of which are moved in advance.
  /// With one block of vertices the loops disappear.
  template <std::uint32_t most_vertices>
  struct Moved {
    const SupportShape& shape;
    double blocks[3 * most_vertices];

    std::uint32_t count() const {
      return most_vertices == VertexBlocks::size ? most_vertices : shape.vertices.count;
    }

    Moved(const PlacedShape& placed, const Vec& to) : shape(*placed.shape) {
      constexpr std::size_t size = VertexBlocks::size;
      const double* const pose = placed.pose;
      const std::size_t end = std::size_t{3} * count();
      for (std::size_t block = 0; block < end; block += 3 * size)
        for (std::size_t lane = 0; lane < size; lane += width) {
          const double* const from = shape.vertices.coordinates + block + lane;
          const V x = V::load_unaligned(from), y = V::load_unaligned(from + size),
                  z = V::load_unaligned(from + 2 * size);
          const auto row = [&](int k, double offset) {
            return fma(V(pose[k]), x, fma(V(pose[4 + k]), y, fma(V(pose[8 + k]), z, V(offset))));
          };
          row(0, to.x).store_unaligned(blocks + block + lane);
          row(1, to.y).store_unaligned(blocks + block + size + lane);
          row(2, to.z).store_unaligned(blocks + block + 2 * size + lane);
        }
    }

    SupportPoint farthest(const Vec& d) const {
      // The last five bits of each product are replaced by the index of its vertex, so that the largest
      // product carries it.
      constexpr std::size_t size = VertexBlocks::size;
      const V x(d.x), y(d.y), z(d.z);
      V best = Lanes::tagged(products(blocks, 0, x, y, z), 0);
      for (std::size_t first = 0; first < count(); first += size)
        for (std::size_t lane = 0; lane < size; lane += width)
          best = max(best, Lanes::tagged(products(blocks + first * 3, lane, x, y, z),
                                         static_cast<std::uint32_t>(first + lane)));
      const std::uint32_t i = Lanes::tag(Lanes::largest(best)) % most_vertices;
      const double* const point = blocks + i / size * (3 * size) + i % size;
      return {{point[0], point[size], point[2 * size]},
              {vertex(shape.vertices, i), i < shape.vertices.last ? i : shape.vertices.last}};
    }
  };

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

  /// Tests two boxes by their fifteen candidate separating axes.
  static Verdict compare_boxes(const PlacedShape& a, const PlacedShape& b) {
    const auto lanes_of = [](const PlacedShape& box, BoxLanes& lanes) {
      for (int k = 0; k < 3; ++k)
        lanes.axes[k] = Four{box.pose[k], box.pose[4 + k], box.pose[8 + k], 0};
      lanes.half = Four{box.shape->size[0], box.shape->size[1], box.shape->size[2], 0};
    };
    BoxLanes lanes_a, lanes_b;
    lanes_of(a, lanes_a);
    lanes_of(b, lanes_b);
    const Vec between{b.pose[12] - a.pose[12], b.pose[13] - a.pose[13], b.pose[14] - a.pose[14]};
    const double extent = sum_of_magnitudes(between) + a.shape->bounding_radius + b.shape->bounding_radius;
    // In this range squares neither overflow nor, where it matters, underflow.
    if (!(extent < 0x1p500 && extent > 0x1p-500))
      return Verdict::undecided;
    // The margin is large enough for poses whose matrices are rotations only to 1e-9.
    const double margin = 0x1p-24 * extent, largest_gap = gap(lanes_a, lanes_b, between);
    if (largest_gap > margin)
      return Verdict::disjoint;
    return largest_gap < -margin ? Verdict::intersecting : Verdict::undecided;
  }

  /// Names a type as an argument.
  template <class T>
  struct As {};

  /// Calls a function with the support mapping that suits the shape.
  template <class Function>
  static Verdict with_support(const SupportShape& shape, const Function& function) {
    switch (shape.kind) {
    case ShapeKind::hull:
      if (shape.vertices.count == VertexBlocks::size)
        return function(As<Moved<VertexBlocks::size>>());
      if (shape.vertices.count <= SupportShape::few_vertices)
        return function(As<Moved<SupportShape::few_vertices>>());
      return function(As<Turned<Hull>>());
    case ShapeKind::box:
      return function(As<Turned<Box>>());
    default:
      return function(As<Turned<Curved>>());
    }
  }

  /// Decides by the search for the two kinds of shape, and two boxes by their axes if no proof is asked for.
  template <bool with_proof>
  static Verdict dispatched(const PlacedShape& a, const PlacedShape& b, GjkFilterAnswer& answer) {
    if (!with_proof && a.shape->kind == ShapeKind::box && b.shape->kind == ShapeKind::box) {
      const Verdict verdict = compare_boxes(a, b);
      if (verdict != Verdict::undecided)
        return verdict;
    }
    return with_support(*a.shape, [&]<class A>(As<A>) {
      return with_support(*b.shape, [&]<class B>(As<B>) { return search<with_proof, A, B>(a, b, answer); });
    });
  }

  /// Up to four points of the Minkowski difference. A triangle also stores the products that the next
  /// iteration needs.
  struct Simplex {
    Point points[4];
    int size;
    Vec crosses[3];      ///< cross products of the points 1 and 2, 2 and 0, 0 and 1
    double determinant;  ///< of the points 0, 1 and 2
  };

  static Vec plus(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }

  /// Runs the filtered GJK iteration. Without a proof to give, the simplex starts with an inner point of the
  /// Minkowski difference that is no difference of support points; this saves one iteration.
  ///
  /// gnu::flatten is needed because the search is instantiated so often that the compiler would otherwise not
  /// inline even the dot products.
  template <bool with_proof, class A, class B>
  [[gnu::flatten]] static Verdict search(const PlacedShape& a, const PlacedShape& b,
                                         GjkFilterAnswer& answer) {
    const double* pose_a = a.pose;
    const double* pose_b = b.pose;
    const Vec offset{pose_a[12] - pose_b[12], pose_a[13] - pose_b[13], pose_a[14] - pose_b[14]};
    // Bounds the length of every point of the Minkowski difference; NaN if a rotation is not finite.
    const double extent = sum_of_magnitudes(offset) + a.shape->bounding_radius + b.shape->bounding_radius +
                          zero_if_finite(pose_a, pose_b);
    answer.size = 0;
    if (!(extent < 0x1p170 && extent > 0x1p-170))
      return Verdict::undecided;
    constexpr double error_per_product = 0x1p-46, error_per_determinant = 0x1p-46;
    // Below these, products could have lost digits to underflow.
    constexpr double smallest_product = 0x1p-860, smallest_direction = 0x1p-900;
    const double error_of_determinants = error_per_determinant * extent * extent * extent;
    const Vec centre_a{a.shape->centre[0], a.shape->centre[1], a.shape->centre[2]};
    const Vec centre_b{b.shape->centre[0], b.shape->centre[1], b.shape->centre[2]};
    const Vec inside = minus(rotated(pose_a, centre_a, offset), rotated(pose_b, centre_b, {0, 0, 0}));
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
