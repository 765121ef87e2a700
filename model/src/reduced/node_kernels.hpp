#pragma once

#include <cstddef>

/// What a pose costs: the potentials of charges at quadrature nodes, in single precision and in the widest
/// registers of the processor (model/BOUNDARY_ELEMENTS.md, section 8).
///
/// Compiled once for every instruction set: what is declared here obeys the rule in simd/dispatch.hpp.
namespace fringe::detail {

/// All arrays are read and written in whole blocks of this many numbers, and some one block beyond.
constexpr std::ptrdiff_t node_block = 16;

constexpr std::ptrdiff_t whole_blocks(std::ptrdiff_t count) {
  return (count + node_block - 1) / node_block * node_block;
}

/// The most functions along a direction of a face: one block.
constexpr int most_reduced_functions = 15;

/// A rule along one direction of a face.
struct NodeRule {
  std::ptrdiff_t points;
  const float* nodes;    ///< in [−1, 1]
  const float* weights;  ///< weight·(1 − x²)^α·p_k(x): a row of whole_blocks(points) for every function
  const float* values;   ///< the same numbers: a row of one block for every point
};

/// The rules of a face with functions² functions.
struct NodeGrid {
  std::ptrdiff_t functions;
  NodeRule u;
  NodeRule v;
};

/// Points by their coordinates.
struct NodePoints {
  const float* x;
  const float* y;
  const float* z;
  std::ptrdiff_t count;
};

/// The matrix of 1/distance of rows × columns, a row taking whole_blocks(columns); it is zero beyond.
struct NodeMatrix {
  const float* values;
  std::ptrdiff_t rows;
  std::ptrdiff_t columns;
};

/// A face as its centre and the vectors to the middles of its sides u = 1 and v = 1.
struct NodeFace {
  float centre[3];
  float u[3];
  float v[3];
};

/// The coordinates of points in a face: in half sides along it, in its half sides u above it.
struct FaceMap {
  float rows[9];
  float offset[3];
  float ratio;  ///< half side v/half side u
};

/// The functions for one instruction set.
struct NodeKernels {
  /// The least sums of the distances from the foci ±1 of the complex x + iy and v-coordinates that the
  /// kernel 1/distance from the points is singular at, along u and along v. Points there are in whole blocks.
  void (*ellipses)(const NodePoints& points, const FaceMap& map, float* least);

  /// Writes the nodes of a face, row after row along v; up to one block more.
  void (*lay)(const NodeGrid& grid, const NodeFace& face, float* x, float* y, float* z);

  /// Writes the matrix. There are coordinates up to whole_blocks(columns), so far away beyond the columns
  /// that 1/distance is no number to speak of.
  void (*fill)(const NodePoints& rows, const NodePoints& columns, float* matrix);

  /// The potentials of charges on the columns at the rows, and the other way round.
  void (*apply)(const NodeMatrix& matrix, const float* row_charges, const float* column_charges,
                float* row_potentials, float* column_potentials);

  /// From the coefficients of a face's functions to the charges at its nodes; writes up to one block more.
  void (*spread)(const NodeGrid& grid, const float* coefficients, float* charges);

  /// From the potentials at a face's nodes to their moments with its functions; writes up to one block more.
  void (*gather)(const NodeGrid& grid, const float* potentials, float* moments);

  /// The product of a square matrix of so many columns, each of whole_blocks(count), with a vector.
  void (*multiply)(const float* matrix, std::ptrdiff_t count, const float* vector, float* product);

  /// The scalar product of whole blocks.
  float (*dot)(const float* a, const float* b, std::ptrdiff_t padded);

  /// Adds a multiple of one array to another, in whole blocks.
  void (*add)(float factor, const float* a, float* to, std::ptrdiff_t padded);
};

}  // namespace fringe::detail
