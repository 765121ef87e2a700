#pragma once

#include "reduced/node_kernels.hpp"

/// The node kernels for one instruction set, which `Lanes` stands for.
namespace fringe::detail {

template <class Lanes>
class NodeKernelsFor {
  using Count = std::ptrdiff_t;

 public:
  static void ellipses(const NodePoints& points, const FaceMap& map, float* least) {
    const Vector one = Lanes::all(1), ratio = Lanes::all(map.ratio), inverse = Lanes::all(1 / map.ratio);
    Vector least_u = Lanes::all(3e38F), least_v = least_u;
    for (Count k = 0; k < whole_blocks(points.count); k += Lanes::width) {
      const Vector px = Lanes::load(points.x + k), py = Lanes::load(points.y + k),
                   pz = Lanes::load(points.z + k);
      const auto row = [&](Count at) {
        const Vector first =
            Lanes::multiply_add(Lanes::all(map.rows[at]), px, Lanes::all(map.offset[at / 3]));
        return Lanes::multiply_add(Lanes::all(map.rows[at + 1]), py,
                                   Lanes::multiply_add(Lanes::all(map.rows[at + 2]), pz, first));
      };
      const Vector x = Lanes::absolute(row(0)), y = Lanes::absolute(row(3)), z = row(6);
      const Vector beside_u = Lanes::larger(Lanes::subtract(x, one), Lanes::zero());
      const Vector beside_v = Lanes::multiply(Lanes::larger(Lanes::subtract(y, one), Lanes::zero()), ratio);
      const Vector square = Lanes::multiply(z, z);
      const Vector from_u = Lanes::multiply_add(beside_v, beside_v, square);
      const Vector from_v =
          Lanes::multiply(Lanes::multiply(Lanes::multiply_add(beside_u, beside_u, square), inverse), inverse);
      least_u = Lanes::smaller(least_u, distances(x, from_u));
      least_v = Lanes::smaller(least_v, distances(y, from_v));
    }
    least[0] = Lanes::least(least_u);
    least[1] = Lanes::least(least_v);
  }

  static void lay(const NodeGrid& grid, const NodeFace& face, float* x, float* y, float* z) {
    float* const coordinates[3] = {x, y, z};
    for (Count axis = 0; axis < 3; ++axis) {
      float* to = coordinates[axis];
      const Vector v = Lanes::all(face.v[axis]);
      for (Count i = 0; i < grid.u.points; ++i, to += grid.v.points) {
        const Vector line = Lanes::all(face.centre[axis] + grid.u.nodes[i] * face.u[axis]);
        // What reaches beyond the row is overwritten by the next.
        for (Count j = 0; j < grid.v.points; j += Lanes::width)
          Lanes::store(to + j, Lanes::multiply_add(Lanes::load(grid.v.nodes + j), v, line));
      }
    }
  }

  static void fill(const NodePoints& rows, const NodePoints& columns, float* matrix) {
    const Count padded = whole_blocks(columns.count);
    for (Count row = 0; row < rows.count; ++row, matrix += padded) {
      const Vector x = Lanes::all(rows.x[row]), y = Lanes::all(rows.y[row]), z = Lanes::all(rows.z[row]);
      for (Count k = 0; k < padded; k += Lanes::width) {
        const Vector dx = Lanes::subtract(Lanes::load(columns.x + k), x);
        const Vector dy = Lanes::subtract(Lanes::load(columns.y + k), y);
        const Vector dz = Lanes::subtract(Lanes::load(columns.z + k), z);
        const Vector square =
            Lanes::multiply_add(dx, dx, Lanes::multiply_add(dy, dy, Lanes::multiply(dz, dz)));
        Lanes::store(matrix + k, Lanes::inverse_root(square));
      }
    }
  }

  static void apply(const NodeMatrix& matrix, const float* row_charges, const float* column_charges,
                    float* row_potentials, float* column_potentials) {
    const Count padded = whole_blocks(matrix.columns);
    for (Count k = 0; k < padded; k += Lanes::width)
      Lanes::store(column_potentials + k, Lanes::zero());
    Count row = 0;
    const float* values = matrix.values;
    for (; row + together <= matrix.rows; row += together, values += together * padded)
      apply_rows<together>(values, padded, row_charges + row, column_charges, row_potentials + row,
                           column_potentials);
    for (; row < matrix.rows; ++row, values += padded)
      apply_rows<1>(values, padded, row_charges + row, column_charges, row_potentials + row,
                    column_potentials);
  }

  static void spread(const NodeGrid& grid, const float* coefficients, float* charges) {
    const Count n = grid.functions, columns = whole_blocks(grid.v.points), rows = whole_blocks(grid.u.points);
    for (Count from = 0; from < grid.v.points; from += node_block) {
      // The charges of every function along u, at the nodes of this block along v.
      Vector across[most_reduced_functions][parts];
      for (Count m = 0; m < n; ++m) {
        for (Count part = 0; part < parts; ++part)
          across[m][part] = Lanes::zero();
        for (Count l = 0; l < n; ++l) {
          const Vector coefficient = Lanes::all(coefficients[m * n + l]);
          for (Count part = 0; part < parts; ++part)
            across[m][part] = Lanes::multiply_add(
                coefficient, Lanes::load(grid.v.weights + l * columns + from + part * Lanes::width),
                across[m][part]);
        }
      }
      write_rows(grid, n, rows, from, across, charges);
    }
  }

  static void gather(const NodeGrid& grid, const float* potentials, float* moments) {
    const Count n = grid.functions, rows = whole_blocks(grid.u.points);
    for (Count m = 0; m < n; ++m) {
      Vector sums[parts];
      for (Count part = 0; part < parts; ++part)
        sums[part] = Lanes::zero();
      for (Count from = 0; from < grid.v.points; from += node_block) {
        Vector along[parts];
        for (Count part = 0; part < parts; ++part)
          along[part] = Lanes::zero();
        for (Count r = 0; r < grid.u.points; ++r) {
          const Vector weight = Lanes::all(grid.u.weights[m * rows + r]);
          for (Count part = 0; part < parts; ++part)
            along[part] = Lanes::multiply_add(
                weight, Lanes::load(potentials + r * grid.v.points + from + part * Lanes::width),
                along[part]);
        }
        alignas(64) float at_nodes[node_block];
        for (Count part = 0; part < parts; ++part)
          Lanes::store(at_nodes + part * Lanes::width, along[part]);
        const Count here = grid.v.points - from < node_block ? grid.v.points - from : node_block;
        for (Count s = 0; s < here; ++s) {
          const Vector potential = Lanes::all(at_nodes[s]);
          for (Count part = 0; part < parts; ++part)
            sums[part] = Lanes::multiply_add(
                potential, Lanes::load(grid.v.values + (from + s) * node_block + part * Lanes::width),
                sums[part]);
        }
      }
      // What is written beyond n is overwritten by the next m.
      for (Count part = 0; part < parts; ++part)
        Lanes::store(moments + m * n + part * Lanes::width, sums[part]);
    }
  }

  static void multiply(const float* matrix, Count count, const float* vector, float* product) {
    const Count padded = whole_blocks(count);
    Count row = 0;
    for (; row + 4 * node_block <= padded; row += 4 * node_block)
      multiply_rows<4>(matrix + row, padded, count, vector, product + row);
    for (; row < padded; row += node_block)
      multiply_rows<1>(matrix + row, padded, count, vector, product + row);
  }

  static float dot(const float* a, const float* b, Count padded) {
    Vector sum = Lanes::zero();
    for (Count k = 0; k < padded; k += Lanes::width)
      sum = Lanes::multiply_add(Lanes::load(a + k), Lanes::load(b + k), sum);
    return Lanes::sum(sum);
  }

  static void add(float factor, const float* a, float* to, Count padded) {
    const Vector times = Lanes::all(factor);
    for (Count k = 0; k < padded; k += Lanes::width)
      Lanes::store(to + k, Lanes::multiply_add(times, Lanes::load(a + k), Lanes::load(to + k)));
  }

 private:
  using Vector = typename Lanes::Vector;

  static constexpr Count parts = node_block / Lanes::width;

  /// Rows that share the loads of the columns' charges and potentials.
  static constexpr Count together = 4;

  static Vector distances(Vector x, Vector square) {
    const Vector one = Lanes::all(1);
    const Vector far = Lanes::add(x, one), near = Lanes::subtract(x, one);
    return Lanes::add(Lanes::root(Lanes::multiply_add(far, far, square)),
                      Lanes::root(Lanes::multiply_add(near, near, square)));
  }

  template <Count count>
  static void apply_rows(const float* values, Count padded, const float* row_charges,
                         const float* column_charges, float* row_potentials, float* column_potentials) {
    Vector sums[count], charges[count];
    for (Count row = 0; row < count; ++row) {
      sums[row] = Lanes::zero();
      charges[row] = Lanes::all(row_charges[row]);
    }
    for (Count k = 0; k < padded; k += Lanes::width) {
      const Vector charge = Lanes::load(column_charges + k);
      Vector potential = Lanes::load(column_potentials + k);
      for (Count row = 0; row < count; ++row) {
        const Vector value = Lanes::load(values + row * padded + k);
        sums[row] = Lanes::multiply_add(value, charge, sums[row]);
        potential = Lanes::multiply_add(value, charges[row], potential);
      }
      Lanes::store(column_potentials + k, potential);
    }
    for (Count row = 0; row < count; ++row)
      row_potentials[row] = Lanes::sum(sums[row]);
  }

  static void write_rows(const NodeGrid& grid, Count n, Count rows, Count from,
                         const Vector (&across)[most_reduced_functions][parts], float* charges) {
    // A block reaches into the next row, which is written after it; from the last, or from all but the last
    // block of a row, nothing but zeros and what this block itself is for is written.
    const Count here = grid.v.points - from;
    for (Count r = 0; r < grid.u.points; ++r) {
      Vector sums[parts];
      for (Count part = 0; part < parts; ++part)
        sums[part] = Lanes::zero();
      for (Count m = 0; m < n; ++m) {
        const Vector weight = Lanes::all(grid.u.weights[m * rows + r]);
        for (Count part = 0; part < parts; ++part)
          sums[part] = Lanes::multiply_add(weight, across[m][part], sums[part]);
      }
      float* to = charges + r * grid.v.points + from;
      if (here >= node_block || from == 0) {
        for (Count part = 0; part < parts; ++part)
          Lanes::store(to + part * Lanes::width, sums[part]);
        continue;
      }
      alignas(64) float block[node_block];
      for (Count part = 0; part < parts; ++part)
        Lanes::store(block + part * Lanes::width, sums[part]);
      for (Count s = 0; s < here; ++s)
        to[s] = block[s];
    }
  }

  template <Count blocks>
  static void multiply_rows(const float* matrix, Count padded, Count count, const float* vector,
                            float* product) {
    constexpr Count all = blocks * parts;
    Vector sums[all];
    for (Count part = 0; part < all; ++part)
      sums[part] = Lanes::zero();
    for (Count column = 0; column < count; ++column, matrix += padded) {
      const Vector factor = Lanes::all(vector[column]);
      for (Count part = 0; part < all; ++part)
        sums[part] = Lanes::multiply_add(Lanes::load(matrix + part * Lanes::width), factor, sums[part]);
    }
    for (Count part = 0; part < all; ++part)
      Lanes::store(product + part * Lanes::width, sums[part]);
  }
};

}  // namespace fringe::detail
