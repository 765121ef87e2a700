// The size of the cells at a point: a list of operations that `fem_reference.mesh.tape` records, and gmsh's
// callback that runs it.
#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace sizes {

using Vector = std::array<double, 3>;
using Triangle = std::array<Vector, 3>;

/// Distances of points from the nearest of some triangles, by a tree of bounding boxes. Triangles with two
/// equal corners are segments.
class NearestTriangle {
 public:
  /// Builds the tree of the triangles given, of which there is at least one. An offset belongs to each.
  NearestTriangle(std::span<const Triangle> given, std::span<const double> offsets);

  /// Returns the least sum of the distance of `point` from a triangle and the triangle's offset.
  double distance(const Vector& point) const;

 private:
  struct Box {
    Vector low, high;
  };
  struct Placed {
    Triangle triangle;
    double offset;
    auto operator<=>(const Placed&) const = default;
  };
  struct Node {
    Box box;
    double least_offset;
    /// The triangles from `first` to `last`, of which a leaf has few; the first child follows its parent, and
    /// leaves have no second one.
    std::size_t first, last, second_child;
  };

  std::size_t build(std::size_t first, std::size_t last);
  void search(std::size_t node, const Vector& point, double& nearest) const;

  std::vector<Placed> triangles;
  std::vector<Node> nodes;
};

namespace {

constexpr std::size_t most_in_leaf = 4;

Vector minus(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Vector along(const Vector& a, double share, const Vector& side) {
  return {a[0] + share * side[0], a[1] + share * side[1], a[2] + share * side[2]};
}

double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double square(const Vector& a) {
  return dot(a, a);
}

/// Returns the square of the distance from a segment.
double from_segment(const Vector& point, const Vector& a, const Vector& b) {
  const Vector side = minus(b, a), to = minus(point, a);
  const double length = square(side);
  const double share = length > 0 ? std::clamp(dot(to, side) / length, 0.0, 1.0) : 0.0;
  return square(minus(point, along(a, share, side)));
}

/// Returns the square of the distance from a triangle: that from its plane, if the point is above it, else
/// that from its nearest side.
double from_triangle(const Vector& point, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const Vector ab = minus(b, a), ac = minus(c, a), to = minus(point, a);
  const double bb = square(ab), cc = square(ac), bc = dot(ab, ac);
  const double determinant = bb * cc - bc * bc;
  if (determinant > 0) {
    const double u = (cc * dot(to, ab) - bc * dot(to, ac)) / determinant;
    const double v = (bb * dot(to, ac) - bc * dot(to, ab)) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1)
      return square(minus(to, along(along({0, 0, 0}, u, ab), v, ac)));
  }
  return std::min({from_segment(point, a, b), from_segment(point, b, c), from_segment(point, c, a)});
}

double middle(const Triangle& triangle, std::size_t axis) {
  return triangle[0][axis] + triangle[1][axis] + triangle[2][axis];
}

}  // namespace

NearestTriangle::NearestTriangle(std::span<const Triangle> given, std::span<const double> offsets) {
  for (std::size_t k = 0; k < given.size(); ++k)
    triangles.push_back({given[k], offsets[k]});
  build(0, triangles.size());
}

std::size_t NearestTriangle::build(std::size_t first, std::size_t last) {
  Box box{triangles[first].triangle[0], triangles[first].triangle[0]};
  double least_offset = triangles[first].offset;
  for (std::size_t k = first; k < last; ++k) {
    least_offset = std::min(least_offset, triangles[k].offset);
    for (const Vector& corner : triangles[k].triangle)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] = std::min(box.low[axis], corner[axis]);
        box.high[axis] = std::max(box.high[axis], corner[axis]);
      }
  }
  const std::size_t node = nodes.size();
  nodes.push_back({box, least_offset, first, last, 0});
  if (last - first <= most_in_leaf)
    return node;
  const Vector extent = minus(box.high, box.low);
  const auto axis = static_cast<std::size_t>(std::ranges::max_element(extent) - extent.begin());
  const std::size_t half = first + (last - first) / 2;
  const auto at = [this](std::size_t k) { return triangles.begin() + static_cast<std::ptrdiff_t>(k); };
  std::nth_element(at(first), at(half), at(last), [axis](const Placed& one, const Placed& other) {
    return std::pair(middle(one.triangle, axis), one) < std::pair(middle(other.triangle, axis), other);
  });
  build(first, half);
  nodes[node].second_child = build(half, last);
  return node;
}

double NearestTriangle::distance(const Vector& point) const {
  double nearest = std::numeric_limits<double>::infinity();
  search(0, point, nearest);
  return nearest;
}

void NearestTriangle::search(std::size_t node, const Vector& point, double& nearest) const {
  const auto& [box, least_offset, first, last, second_child] = nodes[node];
  if (second_child == 0) {
    for (std::size_t k = first; k < last; ++k)
      nearest =
          std::min(nearest, std::sqrt(from_triangle(point, triangles[k].triangle)) + triangles[k].offset);
    return;
  }
  const auto least = [&](std::size_t child) {
    const Box& of_child = nodes[child].box;
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double beyond =
          std::max({of_child.low[axis] - point[axis], point[axis] - of_child.high[axis], 0.0});
      sum += beyond * beyond;
    }
    return std::sqrt(sum) + nodes[child].least_offset;
  };
  std::array<std::pair<double, std::size_t>, 2> children{
      {{least(node + 1), node + 1}, {least(second_child), second_child}}};
  std::ranges::sort(children);
  for (const auto& [lower_bound, child] : children)
    if (lower_bound < nearest)
      search(child, point, nearest);
}

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
