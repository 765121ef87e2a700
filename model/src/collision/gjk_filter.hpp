#pragma once

#include <cstddef>
#include <cstdint>

/// The search in floating point that answers most queries (model/NUMERICS.md, section 13).
///
/// Compiled once for every instruction set: what is declared here obeys the rule in simd/dispatch.hpp.
namespace fringe::detail {

/// Vertices in blocks of eight: their x, then their y, then their z. The last vertex is repeated where the
/// last block would not be full.
struct VertexBlocks {
  const double* coordinates;
  std::uint32_t count;  ///< of vertices, repeated ones included
  std::uint32_t last;   ///< the index of the vertex that is repeated; ones above stand for it

  static constexpr std::size_t size = 8;
};

/// For hulls of many vertices: the directions, by the face and square of a cube around the origin that they
/// go through, and for each square all vertices that may be the farthest along one of its directions.
struct DirectionCells {
  int resolution;                ///< squares along a side; 0: there are no cells, all vertices are looked at
  const std::uint32_t* starts;   ///< where a cell's vertices begin, with a block of its own; and the end
  VertexBlocks vertices;         ///< of all cells, one after the other
  const std::uint32_t* indices;  ///< of these vertices among the hull's
};

enum class Form : int { hull, box, ball, cylinder, cone, sector };

/// A convex shape in its own frame, as its farthest points along directions.
struct SupportShape {
  Form form;
  double size[3];  ///< box: half the sides; ball: radius; cylinder, cone and sector: (outer) radius, half the
                   ///< height, inner radius
  double ends[4];  ///< sector: the unit vectors (x, y) of its two ends, anticlockwise, less than half a turn
  double middle[3];  ///< a point of the shape, but for rounding
  double reach;      ///< no point is farther from the frame's origin
  VertexBlocks vertices;
  DirectionCells cells;

  /// Hulls of no more vertices are moved as a whole when a search begins.
  static constexpr std::size_t few_vertices = 32;
};

/// A shape with the 16 numbers, column by column, of the matrix of its pose: a rotation to 1e-9.
struct PlacedShape {
  const SupportShape* shape;
  const double* pose;
};

/// The farthest point of A along a direction and that of B against it, each in its shape's frame; and of
/// hulls and boxes their indices (of a box: bit k is set where coordinate k is positive).
struct SupportPair {
  double on_a[3];
  double on_b[3];
  std::uint32_t a;
  std::uint32_t b;
};

enum class Verdict : int { undecided, disjoint, intersecting };

/// What the search has proven with regard to every rounding, or where it got to.
struct GjkFilterAnswer {
  Verdict verdict;
  double direction[3];   ///< disjoint: separates the shapes, from A to B
  SupportPair pairs[4];  ///< the simplex reached; intersecting: one around the origin
  int size;
};

/// An oriented box as plain numbers, laid out as OrientedBox is.
struct BoxNumbers {
  double centre[3];
  double axes[9];  ///< the axes' x, their y, their z
  double half_widths[3];
};

/// The functions for one instruction set.
struct GjkFilter {
  /// The verdict alone; somewhat faster.
  Verdict (*decide)(const PlacedShape& a, const PlacedShape& b);

  void (*prove)(const PlacedShape& a, const PlacedShape& b, GjkFilterAnswer& answer);

  /// A point of a shape farthest along a direction, both in its own frame.
  void (*support)(const SupportShape& shape, const double* direction, double* point);

  /// By how much two boxes are apart along one of the fifteen axes that tell them apart, at most.
  double (*box_gap)(const BoxNumbers& a, const BoxNumbers& b);
};

}  // namespace fringe::detail
