#pragma once

#include <cstddef>
#include <cstdint>

#include "collision/gjk_filter.hpp"

/// The support mappings of all kinds of shape for the instruction set that `Lanes` represents.
namespace fringe::detail {

template <class Lanes>
struct SupportFor {
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

  static double fused(double a, double b, double c) {
    if constexpr (Lanes::fused)
      return __builtin_fma(a, b, c);
    else
      return a * b + c;
  }
  static Vec plus(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
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

  /// Returns the position of the frame of A relative to that of B.
  static Vec offset_of(const PlacedShape& a, const PlacedShape& b) {
    return {a.pose[12] - b.pose[12], a.pose[13] - b.pose[13], a.pose[14] - b.pose[14]};
  }
  /// Bounds the length of every point of the Minkowski difference; NaN if a rotation is not finite.
  static double extent_of(const PlacedShape& a, const PlacedShape& b, const Vec& offset) {
    return sum_of_magnitudes(offset) + a.shape->bounding_radius + b.shape->bounding_radius +
           zero_if_finite(a.pose, b.pose);
  }
  /// Returns a point inside the Minkowski difference.
  static Vec offset_of_centres(const PlacedShape& a, const PlacedShape& b, const Vec& offset) {
    const double* const on_a = a.shape->centre;
    const double* const on_b = b.shape->centre;
    return minus(rotated(a.pose, {on_a[0], on_a[1], on_a[2]}, offset),
                 rotated(b.pose, {on_b[0], on_b[1], on_b[2]}, {0, 0, 0}));
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

  /// Returns the point of a sphere around the origin that is farthest along d.
  static Vec on_sphere(double radius, const Vec& d) {
    const Vec across = on_circle(1, d, 0);
    const double horizontal = fused(across.x, d.x, across.y * d.y);
    const Vec tilted = on_circle(radius, {horizontal, d.z, 0}, 0);
    return {across.x * tilted.x, across.y * tilted.x, tilted.y};
  }

  static Local ball_support(const SupportShape& shape, const Vec& d) {
    return {on_sphere(shape.size[0], d), 0};
  }

  static Local rounded_box_support(const SupportShape& shape, const Vec& d) {
    const Vec corner{__builtin_copysign(shape.size[0], d.x), __builtin_copysign(shape.size[1], d.y),
                     __builtin_copysign(shape.size[2], d.z)};
    return {plus(corner, on_sphere(shape.ends[0], d)), 0};
  }

  /// Finds an ellipsoid's support point: the unit sphere's, for the direction stretched by the semi-axes,
  /// stretched in the same way.
  static Local ellipsoid_support(const SupportShape& shape, const Vec& d) {
    const double* share = shape.ends;
    const Vec unit = on_sphere(1, {share[0] * d.x, share[1] * d.y, share[2] * d.z});
    return {{shape.size[0] * unit.x, shape.size[1] * unit.y, shape.size[2] * unit.z}, 0};
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
              0};
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
      case ShapeKind::rounded_box:
        return rounded_box_support(shape, d);
      case ShapeKind::ellipsoid:
        return ellipsoid_support(shape, d);
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
    static constexpr bool has_indices_in_products = false;
    const SupportShape& shape;
    const double* pose;
    Vec offset;

    Turned(const PlacedShape& placed, const Vec& to) : shape(*placed.shape), pose(placed.pose), offset(to) {}

    SupportPoint farthest(const Vec& d) const {
      const Local local = Kind::support(shape, to_local(pose, d));
      return {rotated(pose, local.at, offset), local};
    }
  };

  /// Finds a support point among few vertices. With one block of vertices the loops disappear.
  template <std::uint32_t most_vertices>
  struct Few {
    static std::uint32_t count(const SupportShape& shape) {
      return most_vertices == VertexBlocks::size ? most_vertices : shape.vertices.count;
    }

    static std::uint32_t farthest(const SupportShape& shape, const double* blocks, const Vec& d) {
      // The last five bits of each product are replaced by the index of its vertex, so that the largest
      // product carries it.
      constexpr std::size_t size = VertexBlocks::size;
      const V x(d.x), y(d.y), z(d.z);
      V best = Lanes::tagged(products(blocks, 0, x, y, z), 0);
      for (std::size_t first = 0; first < count(shape); first += size)
        for (std::size_t lane = 0; lane < size; lane += width)
          best = max(best, Lanes::tagged(products(blocks + first * 3, lane, x, y, z),
                                         static_cast<std::uint32_t>(first + lane)));
      return Lanes::tag(Lanes::largest(best)) % most_vertices;
    }
  };

  /// The support mapping of a hull in its place, whose vertices are relative to the common origin.
  template <std::uint32_t most_vertices>
  struct InPlace {
    static constexpr bool has_indices_in_products = true;
    const SupportShape& shape;

    SupportPoint farthest(const Vec& d) const {
      const std::uint32_t i = Few<most_vertices>::farthest(shape, shape.vertices.coordinates, d);
      const Vec point = vertex(shape.vertices, i);
      return {point, {point, i < shape.vertices.last ? i : shape.vertices.last}};
    }
  };

  /// The same for hulls of any number of vertices.
  struct ManyInPlace {
    static constexpr bool has_indices_in_products = false;
    const SupportShape& shape;

    SupportPoint farthest(const Vec& d) const {
      const Local local = hull_support(shape, d);
      return {local.at, local};
    }
  };

  /// The support mapping of a moved hull with at most this many vertices, all of which are moved in advance.
  template <std::uint32_t most_vertices>
  struct Moved {
    static constexpr bool has_indices_in_products = true;
    const SupportShape& shape;
    double blocks[3 * most_vertices];

    Moved(const PlacedShape& placed, const Vec& to) : shape(*placed.shape) {
      constexpr std::size_t size = VertexBlocks::size;
      const double* const pose = placed.pose;
      const std::size_t end = std::size_t{3} * Few<most_vertices>::count(shape);
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
      constexpr std::size_t size = VertexBlocks::size;
      const std::uint32_t i = Few<most_vertices>::farthest(shape, blocks, d);
      const double* const point = blocks + i / size * (3 * size) + i % size;
      return {{point[0], point[size], point[2 * size]},
              {vertex(shape.vertices, i), i < shape.vertices.last ? i : shape.vertices.last}};
    }
  };

  /// Calls a function of two types with the support mappings that suit two shapes.
  template <class Function>
  static auto with_supports(const SupportShape& a, const SupportShape& b, const Function& function) {
    return with_support(a, [&]<class A>(As<A>) {
      return with_support(b, [&]<class B>(As<B>) { return function.template operator()<A, B>(); });
    });
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

 private:
  /// Names a type as an argument.
  template <class T>
  struct As {};

  /// Calls a function with the support mapping that suits the shape.
  template <class Function>
  static auto with_support(const SupportShape& shape, const Function& function) {
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
};

}  // namespace fringe::detail
