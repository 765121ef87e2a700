#pragma once

#include <cstddef>

/// The loops in which a pose spends its time: the potentials of charges at quadrature nodes, in single
/// precision and in the widest registers of the processor (model/BOUNDARY_ELEMENTS.md, section 8).
///
/// Compiled once for every instruction set: what is declared here obeys the rule in simd/dispatch.hpp.
namespace fringe::detail {

/// Number of values in a block. All arrays are read and written in whole blocks, some also one block beyond.
constexpr std::ptrdiff_t node_block = 16;

constexpr std::ptrdiff_t whole_blocks(std::ptrdiff_t count) {
  return (count + node_block - 1) / node_block * node_block;
}

/// Largest number of functions along a direction of a face; they fit in one block.
constexpr int most_reduced_functions = 15;

/// A quadrature rule along one direction of a face.
struct NodeRule {
  std::ptrdiff_t points;
  const float* nodes;    ///< in [−1, 1]
  const float* weights;  ///< weight·(1 − x²)^α·p_k(x): a row of whole_blocks(points) for every function
  const float* values;   ///< the same numbers: a row of one block for every point
};

/// The quadrature rules of a face with functions² functions.
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

/// The matrix of 1/distance of rows × columns. A row takes whole_blocks(columns) and is zero beyond its
/// columns.
struct NodeMatrix {
  const float* values;
  std::ptrdiff_t rows;
  std::ptrdiff_t columns;
};

/// Rows of one block each, one after the other.
struct NodeRows {
  const float* values;
  std::ptrdiff_t count;
};

/// Sets of factors for rows: those of a row follow each other, and begin `stride` values after those of the
/// row before.
struct NodeFactors {
  const float* values;
  std::ptrdiff_t stride;
  std::ptrdiff_t sets;
};

/// A face as its centre and the vectors to the middles of its sides u = 1 and v = 1.
struct NodeFace {
  float centre[3];
  float u[3];
  float v[3];
};

/// Maps points to a face's coordinates: in half sides along the face, in its half sides u above it.
struct FaceMap {
  float rows[9];
  float offset[3];
  float ratio;  ///< half side v/half side u
};

/// The kernels for one instruction set.
struct NodeKernels {
  /// Computes for each of the directions u and v the least sum of distances from the foci ±1 to a singularity
  /// x + iy of the kernel 1/distance, in the complex plane of the coordinate. The singularities belong to
  /// points, which are given in whole blocks.
  void (*ellipses)(const NodePoints& points, const FaceMap& map, float* least);

  /// Computes the nodes of a face, row after row along v; writes up to one block more.
  void (*lay)(const NodeGrid& grid, const NodeFace& face, float* x, float* y, float* z);

  /// Computes the matrix of 1/distance. The columns' coordinates are given up to whole_blocks(columns);
  /// beyond the columns they are so large that 1/distance is negligible.
  void (*fill)(const NodePoints& rows, const NodePoints& columns, float* matrix);

  /// Computes the potentials at the columns, given as in fill(), of charges at the rows.
  void (*add_up)(const NodePoints& rows, const float* row_charges, const NodePoints& columns,
                 float* column_potentials);

  /// Computes the same with 1/distance limited, for every pair to the smaller one of a limit of all rows and
  /// that of the column. Points may coincide.
  void (*add_up_limited)(const NodePoints& rows, const float* row_charges, float row_limit,
                         const NodePoints& columns, const float* column_limits, float* column_potentials);

  /// Computes the potentials at the rows of charges on the columns, and the other way round.
  void (*apply)(const NodeMatrix& matrix, const float* row_charges, const float* column_charges,
                float* row_potentials, float* column_potentials);

  /// Computes the charges at a face's nodes from the coefficients of its functions; writes up to one block
  /// more.
  void (*spread)(const NodeGrid& grid, const float* coefficients, float* charges);

  /// Computes the moments of the potentials at a face's nodes with its functions; writes up to one block
  /// more.
  void (*gather)(const NodeGrid& grid, const float* potentials, float* moments);

  /// Multiplies a square matrix of `count` columns, each of whole_blocks(count), by a vector.
  void (*multiply)(const float* matrix, std::ptrdiff_t count, const float* vector, float* product);

  /// Returns the scalar product of two arrays in whole blocks.
  float (*dot)(const float* a, const float* b, std::ptrdiff_t padded);

  /// Adds a multiple of one array to another, in whole blocks.
  void (*add)(float factor, const float* a, float* to, std::ptrdiff_t padded);

  /// Adds up rows of one block each, with several sets of factors: writes a block for each of them.
  void (*combine)(const NodeRows& rows, const NodeFactors& factors, float* sums);
};

}  // namespace fringe::detail
