#pragma once

#include <cstddef>
#include <cstdint>

/// The filtered GJK search in floating point, which answers most queries (model/NUMERICS.md, section 13).
///
/// It is compiled once for every instruction set; the declarations here obey the rule in simd/dispatch.hpp.
namespace fringe::detail {

/// Vertices in blocks of eight: their x, then their y, then their z. The last vertex is repeated to fill the
/// last block.
struct VertexBlocks {
  const double* coordinates;
  std::uint32_t count;  ///< number of vertices, including repeated ones
  std::uint32_t last;   ///< index of the vertex that is repeated; larger indices mean this vertex

  static constexpr std::size_t size = 8;
};

/// Lookup table for the support mapping of hulls of many vertices. The faces of a cube around the origin are
/// divided into squares; for each square the table lists all vertices that may be the support point for a
/// direction through it.
struct DirectionCells {
  int resolution;                ///< squares along a side; 0: there is no table and all vertices are compared
  const std::uint32_t* starts;   ///< where each cell's vertices begin, block by block; last, the end
  VertexBlocks vertices;         ///< vertices of all cells, one cell after the other
  const std::uint32_t* indices;  ///< indices of these vertices among the hull's
};

enum class ShapeKind : int { hull, box, ball, cylinder, cone, sector, rounded_box, ellipsoid };

/// A convex shape in its own frame, given by the numbers that its support mapping needs.
struct SupportShape {
  ShapeKind kind;
  double size[3];  ///< box: half the sides, of a rounded one those of the box that the ball sweeps; ball:
                   ///< radius; cylinder, cone and sector: (outer) radius, half the height, inner radius;
                   ///< ellipsoid: semi-axes
  double ends[4];  ///< sector: the unit vectors (x, y) of its two ends, anticlockwise, less than half a turn;
                   ///< rounded box: the ball's radius; ellipsoid: semi-axes over the largest
  double centre[3];        ///< a point of the shape, up to rounding
  double bounding_radius;  ///< of a ball around the frame's origin that contains the shape
  VertexBlocks vertices;
  DirectionCells cells;

  /// Hulls of at most this many vertices are moved as a whole when a search begins.
  static constexpr std::size_t few_vertices = 32;
};

/// A shape and its pose: the 16 numbers of a matrix, column by column, which must be a rotation to 1e-9.
struct PlacedShape {
  const SupportShape* shape;
  const double* pose;
};

/// The support points of A along a direction and of B against it, each in its shape's frame, and their
/// indices among a hull's vertices.
struct SupportPair {
  double on_a[3];
  double on_b[3];
  std::uint32_t a;
  std::uint32_t b;
};

enum class Verdict : int { undecided, disjoint, intersecting };

/// What the search has proven, every rounding considered, or the simplex that it reached.
struct GjkFilterAnswer {
  Verdict verdict;
  double direction[3];   ///< if disjoint: a separating direction, from A to B
  SupportPair pairs[4];  ///< the simplex reached; if intersecting: one that contains the origin
  int size;
};

enum class DistanceEnd : int {
  open,         ///< rounding hides the answer, or the shapes' size is not within 2^±170
  converged,    ///< the two bounds of the distance are within most_doubt
  intersecting  ///< the simplex contains the origin, every rounding considered
};

/// How far a search for the shortest distance came. The point of the Minkowski difference nearest to the
/// origin is the sum of the simplex's points times their weights.
struct DistanceAnswer {
  /// Difference between the bounds, relative to the distance, at which a search is complete.
  static constexpr double most_doubt = 1e-12;

  DistanceEnd end;
  double length;        ///< distance of the nearest point found from the origin
  double lower_bound;   ///< of the distance, every rounding considered
  double direction[3];  ///< of length 1 up to rounding, along which this bound holds; zero if the bound is
  SupportPair pairs[4];
  double weights[4];
  int size;  ///< number of pairs; 0 if there was no search
};

/// A hull for one query: its vertices as given, three numbers each, and relative to an origin common to both
/// hulls of the query in the shape's blocks.
struct GivenHull {
  const SupportShape* shape;
  const double* vertices;
};

/// A simplex of the Minkowski difference of two such hulls, by the indices of its vertices.
struct CornerSimplex {
  std::uint32_t a[4];
  std::uint32_t b[4];
  int size;  ///< 0 if there was no search
};

/// The distance of two such hulls, as GjkDistance has it if it is certain, and the simplex that the search
/// has reached.
struct HullDistance {
  bool is_certain;
  double distance;
  double lower_bound;
  double direction[3];
  double on_a[3];
  double on_b[3];
  CornerSimplex simplex;
};

/// An oriented box as plain numbers, laid out as OrientedBox is.
struct BoxNumbers {
  double centre[3];
  double axes[9];  ///< the x of all axes, then their y, then their z
  double half_widths[3];
};

/// The function table of one instruction set.
struct GjkFilter {
  /// Returns the verdict alone; somewhat faster than prove.
  Verdict (*decide)(const PlacedShape& a, const PlacedShape& b);

  /// Computes the verdict with its proof.
  void (*prove)(const PlacedShape& a, const PlacedShape& b, GjkFilterAnswer& answer);

  /// Searches the shortest distance.
  void (*approach)(const PlacedShape& a, const PlacedShape& b, DistanceAnswer& answer);

  /// Tries to complete an open search of two polytopes in twice the precision; otherwise leaves the answer as
  /// it is.
  void (*refine)(const PlacedShape& a, const PlacedShape& b, DistanceAnswer& answer);

  /// Copies vertices, three numbers each, into blocks that have room for them, relative to an origin, and
  /// computes a point of their hull. Returns the largest magnitude of a coordinate, NaN if one is not finite.
  double (*arrange)(const double* vertices, std::size_t count, const double* origin, double* blocks,
                    double* centre);

  /// Computes the distance of hulls that are not prepared.
  void (*hull_distance)(const GivenHull& a, const GivenHull& b, HullDistance& found);

  /// Computes the support point of a shape along a direction, both in the shape's own frame, and returns its
  /// index in a hull.
  std::uint32_t (*support)(const SupportShape& shape, const double* direction, double* point);

  /// Computes the largest gap between two boxes along the fifteen candidate separating axes.
  double (*box_gap)(const BoxNumbers& a, const BoxNumbers& b);
};

}  // namespace fringe::detail
