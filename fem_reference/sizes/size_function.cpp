// The size of the cells at a point: a list of operations that `fem_reference.mesh.tape` records, and gmsh's
// callback that runs it.
#include "nearest_triangle.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace sizes {

/// One operation on two registers, or on the constant or the surface of number `first`.
struct Step {
  int operation, first, second;
};

/// The operations, by the numbers that `tape.OPERATIONS` gives them.
enum Operation {
  constant,
  distance,
  add,
  subtract,
  multiply,
  divide,
  minimum,
  maximum,
  square_root,
  absolute
};

/// A list of operations. Step k fills register 3 + k; the first three registers hold the point. One thread at
/// a time may evaluate it.
class SizeFunction {
 public:
  SizeFunction(std::span<const Step> given, const double* constants, std::vector<NearestTriangle> known,
               std::size_t of_result)
      : registers(3 + given.size()), surfaces(std::move(known)), result(of_result) {
    for (std::size_t k = 0; k < given.size(); ++k) {
      if (given[k].operation == constant)
        registers[3 + k] = constants[given[k].first];
      else
        steps.push_back({given[k], 3 + k});
    }
  }

  /// Returns the register `result` at `point`.
  double at(const Vector& point) {
    std::ranges::copy(point, registers.begin());
    for (const auto& [step, target] : steps)
      registers[target] = value(step, point);
    return registers[result];
  }

 private:
  struct Placed {
    Step step;
    std::size_t target;
  };

  double value(const Step& step, const Vector& point) const {
    const auto first = static_cast<std::size_t>(step.first);
    if (step.operation == distance)
      return surfaces[first].distance(point);
    const double a = registers[first], b = registers[static_cast<std::size_t>(step.second)];
    switch (step.operation) {
    case add:
      return a + b;
    case subtract:
      return a - b;
    case multiply:
      return a * b;
    case divide:
      return a / b;
    case minimum:
      return std::min(a, b);
    case maximum:
      return std::max(a, b);
    case square_root:
      return std::sqrt(a);
    default:
      return std::abs(a);
    }
  }

  std::vector<double> registers;
  std::vector<Placed> steps;
  std::vector<NearestTriangle> surfaces;
  std::size_t result;
};

}  // namespace sizes

extern "C" {

/// Makes a size function of steps (operation, first, second), constants, and surfaces, the k-th of
/// `counts[k]` triangles, whose corners follow each other in `triangles`, and whose `offsets` are added to
/// the distances from them. Its value is the register `result`.
void* fringe_sizes_new(std::size_t steps, const int* step, const double* constants, std::size_t surfaces,
                       const std::size_t* counts, const double* triangles, const double* offsets,
                       std::size_t result) {
  std::vector<sizes::Step> given(steps);
  for (std::size_t k = 0; k < steps; ++k)
    given[k] = {step[3 * k], step[3 * k + 1], step[3 * k + 2]};
  std::vector<sizes::NearestTriangle> known;
  for (std::size_t k = 0; k < surfaces; ++k) {
    std::vector<sizes::Triangle> own(counts[k]);
    for (auto& triangle : own)
      for (auto& corner : triangle)
        for (double& coordinate : corner)
          coordinate = *triangles++;
    known.emplace_back(own, std::span(offsets, counts[k]));
    offsets += counts[k];
  }
  return new sizes::SizeFunction(given, constants, std::move(known), result);
}

/// Frees a size function.
void fringe_sizes_delete(void* function) {
  delete static_cast<sizes::SizeFunction*>(function);
}

/// Evaluates a size function at points x, y, z that follow each other.
void fringe_sizes_evaluate(void* function, std::size_t count, const double* points, double* values) {
  for (std::size_t k = 0; k < count; ++k)
    values[k] = static_cast<sizes::SizeFunction*>(function)->at(
        {points[3 * k], points[3 * k + 1], points[3 * k + 2]});
}

/// The size at a point in an entity of gmsh's model, for `gmshModelMeshSetSizeCallback`.
double fringe_sizes_at(int /*dimension*/, int /*tag*/, double x, double y, double z, void* function) {
  return static_cast<sizes::SizeFunction*>(function)->at({x, y, z});
}
}
