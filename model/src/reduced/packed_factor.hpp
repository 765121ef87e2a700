#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace fringe::detail {

/// A positive definite matrix and right sides in single precision, for Cholesky's method in the widest
/// registers. Rows are stored in blocks of 16, of which the columns follow each other; right sides are rows
/// below the matrix. Allocates no memory once it has had the size.
class PackedFactor {
 public:
  /// Number of rows and columns of a block.
  static constexpr Eigen::Index block = 16;

  /// Gives the matrix a size in blocks, and so many rows of right sides below it. The values are zero.
  void resize(Eigen::Index blocks, Eigen::Index right_sides);

  /// Returns an entry on or below the diagonal, or of a right side, whose rows begin at rows().
  float& operator()(Eigen::Index row, Eigen::Index column) { return values_[place(row, column)]; }
  float operator()(Eigen::Index row, Eigen::Index column) const { return values_[place(row, column)]; }
  /// Returns the number of rows of the matrix.
  Eigen::Index rows() const { return blocks_ * block; }

  /// Factorises some blocks of columns when those before are factorised, and solves for them in all rows
  /// below, also of right sides. Returns false if the matrix is not positive definite; then nothing is left.
  bool factorise(Eigen::Index first, Eigen::Index end);

  /// Solves the transposed factor, for some blocks of columns and several vectors, whose entries for a row
  /// follow each other; takes their part of the vectors of all blocks before.
  void solve_transposed(Eigen::Index first, Eigen::Index end, std::vector<float>& vectors,
                        Eigen::Index count);

  /// Writes the products of rows of two blocks over the first so many blocks of columns: for each row of the
  /// second the 16 of the first.
  void multiply(Eigen::Index a, Eigen::Index b, Eigen::Index columns, float* products) const;

 private:
  std::size_t place(Eigen::Index row, Eigen::Index column) const {
    return offsets_[static_cast<std::size_t>(row / block)] +
           static_cast<std::size_t>(column * block + row % block);
  }
  bool factorise_diagonal(Eigen::Index at);

  Eigen::Index blocks_ = 0;
  Eigen::Index all_blocks_ = 0;
  std::vector<std::size_t> offsets_;  ///< of every block of rows
  std::vector<float> values_;
  std::vector<float> inverses_;  ///< of the diagonal blocks of the factor, a row after the other
  std::vector<float> sums_;
};

}  // namespace fringe::detail
