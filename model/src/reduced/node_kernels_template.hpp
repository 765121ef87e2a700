#pragma once

#include "reduced/node_kernels.hpp"

/// The node kernels for one instruction set, which `Lanes` stands for.
namespace fringe::detail {

template <class Lanes>
class NodeKernelsFor {
  using Count = std::ptrdiff_t;

 public:
  static void ellipses(const NodePoints& points, const FaceMap& map, float* least) {
    const Vector one = Vector(1), ratio = Vector(map.ratio), inverse = Vector(1 / map.ratio);
    Vector least_u = Vector(3e38F), least_v = least_u;
    for (Count k = 0; k < whole_blocks(points.count); k += Lanes::width) {
      const Vector px = Vector::load_unaligned(points.x + k), py = Vector::load_unaligned(points.y + k),
                   pz = Vector::load_unaligned(points.z + k);
      const auto row = [&](Count at) {
        const Vector first = fma(Vector(map.rows[at]), px, Vector(map.offset[at / 3]));
        return fma(Vector(map.rows[at + 1]), py, fma(Vector(map.rows[at + 2]), pz, first));
      };
      const Vector x = abs(row(0)), y = abs(row(3)), z = row(6);
      const Vector beside_u = max(x - one, Vector(0));
      const Vector beside_v = max(y - one, Vector(0)) * ratio;
      const Vector square = z * z;
      const Vector from_u = fma(beside_v, beside_v, square);
      const Vector from_v = fma(beside_u, beside_u, square) * inverse * inverse;
      least_u = min(least_u, distances(x, from_u));
      least_v = min(least_v, distances(y, from_v));
    }
    least[0] = Lanes::smallest(least_u);
    least[1] = Lanes::smallest(least_v);
  }

  static void lay(const NodeGrid& grid, const NodeFace& face, float* x, float* y, float* z) {
    float* const coordinates[3] = {x, y, z};
    for (Count axis = 0; axis < 3; ++axis) {
      float* to = coordinates[axis];
      const Vector v(face.v[axis]);
      for (Count i = 0; i < grid.u.points; ++i, to += grid.v.points) {
        const Vector line(face.centre[axis] + grid.u.nodes[i] * face.u[axis]);
        // The next row overwrites what reaches beyond this one.
        for (Count j = 0; j < grid.v.points; j += Lanes::width)
          fma(Vector::load_unaligned(grid.v.nodes + j), v, line).store_unaligned(to + j);
      }
    }
  }

  static void fill(const NodePoints& rows, const NodePoints& columns, float* matrix) {
    const Count padded = whole_blocks(columns.count);
    for (Count row = 0; row < rows.count; ++row, matrix += padded) {
      const Vector x = Vector(rows.x[row]), y = Vector(rows.y[row]), z = Vector(rows.z[row]);
      for (Count k = 0; k < padded; k += Lanes::width) {
        const Vector dx = Vector::load_unaligned(columns.x + k) - x;
        const Vector dy = Vector::load_unaligned(columns.y + k) - y;
        const Vector dz = Vector::load_unaligned(columns.z + k) - z;
        const Vector square = fma(dx, dx, fma(dy, dy, dz * dz));
        Lanes::inverse_square_root(square).store_unaligned(matrix + k);
      }
    }
  }

  static void add_up(const NodePoints& rows, const float* row_charges, const NodePoints& columns,
                     float* column_potentials) {
    add_up_by(rows, row_charges, columns, column_potentials,
              [](Vector square, Count) { return Lanes::inverse_square_root(square); });
  }

  static void add_up_limited(const NodePoints& rows, const float* row_charges, float row_limit,
                             const NodePoints& columns, const float* column_limits,
                             float* column_potentials) {
    const Vector of_rows(row_limit), least(least_square);
    add_up_by(rows, row_charges, columns, column_potentials, [&](Vector square, Count k) {
      return min(min(of_rows, Vector::load_unaligned(column_limits + k)),
                 Lanes::inverse_square_root(max(square, least)));
    });
  }

  static void apply(const NodeMatrix& matrix, const float* row_charges, const float* column_charges,
                    float* row_potentials, float* column_potentials) {
    const Count padded = whole_blocks(matrix.columns);
    for (Count k = 0; k < padded; k += Lanes::width)
      Vector(0).store_unaligned(column_potentials + k);
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
        Vector sums[parts];
        for (Count part = 0; part < parts; ++part)
          sums[part] = Vector(0);
        for (Count l = 0; l < n; ++l) {
          const Vector coefficient(coefficients[m * n + l]);
          for (Count part = 0; part < parts; ++part)
            sums[part] =
                fma(coefficient,
                    Vector::load_unaligned(grid.v.weights + l * columns + from + part * Lanes::width),
                    sums[part]);
        }
        for (Count part = 0; part < parts; ++part)
          across[m][part] = sums[part];
      }
      write_rows(grid, n, rows, from, across, charges);
    }
  }

  static void gather(const NodeGrid& grid, const float* potentials, float* moments) {
    const Count n = grid.functions, rows = whole_blocks(grid.u.points);
    for (Count m = 0; m < n; ++m) {
      Vector sums[parts];
      for (Count part = 0; part < parts; ++part)
        sums[part] = Vector(0);
      for (Count from = 0; from < grid.v.points; from += node_block) {
        Vector along[parts];
        for (Count part = 0; part < parts; ++part)
          along[part] = Vector(0);
        for (Count r = 0; r < grid.u.points; ++r) {
          const Vector weight(grid.u.weights[m * rows + r]);
          for (Count part = 0; part < parts; ++part)
            along[part] = fma(
                weight, Vector::load_unaligned(potentials + r * grid.v.points + from + part * Lanes::width),
                along[part]);
        }
        alignas(64) float at_nodes[node_block];
        for (Count part = 0; part < parts; ++part)
          along[part].store_unaligned(at_nodes + part * Lanes::width);
        const Count here = grid.v.points - from < node_block ? grid.v.points - from : node_block;
        for (Count s = 0; s < here; ++s) {
          const Vector potential(at_nodes[s]);
          for (Count part = 0; part < parts; ++part)
            sums[part] =
                fma(potential,
                    Vector::load_unaligned(grid.v.values + (from + s) * node_block + part * Lanes::width),
                    sums[part]);
        }
      }
      // What is written beyond n is overwritten by the next m.
      for (Count part = 0; part < parts; ++part)
        sums[part].store_unaligned(moments + m * n + part * Lanes::width);
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
    Vector sum(0);
    for (Count k = 0; k < padded; k += Lanes::width)
      sum = fma(Vector::load_unaligned(a + k), Vector::load_unaligned(b + k), sum);
    return Lanes::sum(sum);
  }

  static void add(float factor, const float* a, float* to, Count padded) {
    const Vector times(factor);
    for (Count k = 0; k < padded; k += Lanes::width)
      fma(times, Vector::load_unaligned(a + k), Vector::load_unaligned(to + k)).store_unaligned(to + k);
  }

  static void combine(const NodeRows& rows, const NodeFactors& factors, float* sums) {
    combine_from<most_sets>(rows, factors, 0, sums);
  }

  static constexpr NodeKernels kernels{&ellipses, &lay,      &fill, &add_up, &add_up_limited, &apply, &spread,
                                       &gather,   &multiply, &dot,  &add,    &combine};

 private:
  using Vector = typename Lanes::Vector;

  static constexpr Count parts = node_block / Lanes::width;

  /// Square of a distance in m² below which points coincide: its inverse root is still a number.
  static constexpr float least_square = 1e-30F;

  template <class InverseDistance>
  static void add_up_by(const NodePoints& rows, const float* row_charges, const NodePoints& columns,
                        float* column_potentials, const InverseDistance& inverse_distance) {
    for (Count k = 0; k < whole_blocks(columns.count); k += Lanes::width) {
      const Vector x = Vector::load_unaligned(columns.x + k), y = Vector::load_unaligned(columns.y + k),
                   z = Vector::load_unaligned(columns.z + k);
      Vector sum(0);
      for (Count row = 0; row < rows.count; ++row) {
        const Vector dx = x - Vector(rows.x[row]), dy = y - Vector(rows.y[row]), dz = z - Vector(rows.z[row]);
        const Vector square = fma(dx, dx, fma(dy, dy, dz * dz));
        sum = fma(Vector(row_charges[row]), inverse_distance(square, k), sum);
      }
      sum.store_unaligned(column_potentials + k);
    }
  }

  /// Number of rows that share the loads of the columns' charges and potentials.
  static constexpr Count together = 4;

  /// Number of sets of factors whose sums are held in registers.
  static constexpr Count most_sets = parts < 2 ? 16 : parts < 8 ? 8 / parts : 1;

  static Vector distances(Vector x, Vector square) {
    const Vector one(1);
    const Vector far = x + one, near = x - one;
    return sqrt(fma(far, far, square)) + sqrt(fma(near, near, square));
  }

  template <Count count>
  static void apply_rows(const float* values, Count padded, const float* row_charges,
                         const float* column_charges, float* row_potentials, float* column_potentials) {
    Vector sums[count], charges[count];
    for (Count row = 0; row < count; ++row) {
      sums[row] = Vector(0);
      charges[row] = Vector(row_charges[row]);
    }
    for (Count k = 0; k < padded; k += Lanes::width) {
      const Vector charge = Vector::load_unaligned(column_charges + k);
      Vector potential = Vector::load_unaligned(column_potentials + k);
      for (Count row = 0; row < count; ++row) {
        const Vector value = Vector::load_unaligned(values + row * padded + k);
        sums[row] = fma(value, charge, sums[row]);
        potential = fma(value, charges[row], potential);
      }
      potential.store_unaligned(column_potentials + k);
    }
    for (Count row = 0; row < count; ++row)
      row_potentials[row] = Lanes::sum(sums[row]);
  }

  static void write_rows(const NodeGrid& grid, Count n, Count rows, Count from,
                         const Vector (&across)[most_reduced_functions][parts], float* charges) {
    // The first block of a row may extend into the next row, which is written afterwards. The last of several
    // blocks must not: the first block of the next row is already there.
    const Count here = grid.v.points - from;
    for (Count r = 0; r < grid.u.points; ++r) {
      Vector sums[parts];
      for (Count part = 0; part < parts; ++part)
        sums[part] = Vector(0);
      for (Count m = 0; m < n; ++m) {
        const Vector weight(grid.u.weights[m * rows + r]);
        for (Count part = 0; part < parts; ++part)
          sums[part] = fma(weight, across[m][part], sums[part]);
      }
      float* to = charges + r * grid.v.points + from;
      if (here >= node_block || from == 0) {
        for (Count part = 0; part < parts; ++part)
          sums[part].store_unaligned(to + part * Lanes::width);
        continue;
      }
      alignas(64) float block[node_block];
      for (Count part = 0; part < parts; ++part)
        sums[part].store_unaligned(block + part * Lanes::width);
      for (Count s = 0; s < here; ++s)
        to[s] = block[s];
    }
  }

  /// Combines with the sets from `set` on, so many at a time and the remaining ones in smaller numbers.
  template <Count at_once>
  static void combine_from(const NodeRows& rows, const NodeFactors& factors, Count set, float* sums) {
    for (; set + at_once <= factors.sets; set += at_once) {
      Vector all[at_once * parts];
      for (Count k = 0; k < at_once * parts; ++k)
        all[k] = Vector(0);
      for (Count row = 0; row < rows.count; ++row)
        for (Count part = 0; part < parts; ++part) {
          const Vector value = Vector::load_unaligned(rows.values + row * node_block + part * Lanes::width);
          for (Count k = 0; k < at_once; ++k)
            all[k * parts + part] =
                fma(Vector(factors.values[row * factors.stride + set + k]), value, all[k * parts + part]);
        }
      for (Count k = 0; k < at_once * parts; ++k)
        all[k].store_unaligned(sums + set * node_block + k * Lanes::width);
    }
    if constexpr (at_once > 1)
      combine_from<at_once / 2>(rows, factors, set, sums);
  }

  template <Count blocks>
  static void multiply_rows(const float* matrix, Count padded, Count count, const float* vector,
                            float* product) {
    constexpr Count all = blocks * parts;
    Vector sums[all];
    for (Count part = 0; part < all; ++part)
      sums[part] = Vector(0);
    for (Count column = 0; column < count; ++column, matrix += padded) {
      const Vector factor(vector[column]);
      for (Count part = 0; part < all; ++part)
        sums[part] = fma(Vector::load_unaligned(matrix + part * Lanes::width), factor, sums[part]);
    }
    for (Count part = 0; part < all; ++part)
      sums[part].store_unaligned(product + part * Lanes::width);
  }
};

}  // namespace fringe::detail
