#include "truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fringe::stress {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double unit_in_the_last_place(double number) {
  const double size = std::abs(number);
  return std::nextafter(size, std::numeric_limits<double>::infinity()) - size;
}

double largest_unit(const Triangle& triangle, const Rectangle& plate) {
  double largest = plate.corner.lpNorm<Eigen::Infinity>();
  for (const Vector3d& vertex : triangle)
    largest = std::max(largest, vertex.lpNorm<Eigen::Infinity>());
  return unit_in_the_last_place(largest);
}

/// A point in double precision.
struct NearPoint {
  Vector3d position, barycentric, from_plate;

  explicit NearPoint(const Point& point)
      : position(point.position.cast<double>()), barycentric(point.barycentric.cast<double>()),
        from_plate(point.from_plate.cast<double>()) {}
};

/// Interpolates a + share·(b − a) for quantities that are linear in the point.
Vector3d mixed(const Vector3d& a, const Vector3d& b, double share) {
  return a + share * (b - a);
}

/// Moments of the vector field v/d³ on the surface, where v is the vector from the plate. With the point at
/// λ₀p₀ + λ₁p₁ + λ₂p₂ and the nearest point of the plate at corner + α·edge_u + β·edge_v, they are the
/// derivatives of the integral up to their signs.
struct Moments {
  Matrix3d vertices = Matrix3d::Zero();  ///< columns: ∫ λᵢ v/d³ dA
  Vector3d edge_u = Vector3d::Zero();    ///< ∫ α v/d³ dA
  Vector3d edge_v = Vector3d::Zero();    ///< ∫ β v/d³ dA
};

class MomentIntegrator {
 public:
  MomentIntegrator(const Dissection& dissection, double smallest_distance)
      : lengths_(static_cast<double>(dissection.frame.lengths[0]),
                 static_cast<double>(dissection.frame.lengths[1])),
        smallest_distance_(smallest_distance) {
    for (const Sector& sector : dissection.sectors)
      add(sector);
  }

  const Moments& moments() const { return moments_; }

 private:
  void add(const Sector& sector) {
    // v/d³ has a singularity of degree two in the distance, so the rules lose some of their digits.
    static const GradedRules rules(6);
    const NearPoint apex(sector.apex), start(sector.start), end(sector.end);
    const double twice_area = static_cast<double>(
        stress::twice_area(sector.apex.position, sector.start.position, sector.end.position));
    const double apex_distance = std::max(apex.from_plate.norm(), smallest_distance_);
    const double start_distance = std::max(start.from_plate.norm(), smallest_distance_);
    const Rule& across = rules.rule(start_distance / (end.from_plate - start.from_plate).norm());
    for (std::size_t i = 0; i < across.size(); ++i) {
      const double t = across.position_high[i];
      const Vector3d base = mixed(start.from_plate, end.from_plate, t) - apex.from_plate;
      const Vector3d base_barycentric = mixed(start.barycentric, end.barycentric, t);
      const Vector3d base_position = mixed(start.position, end.position, t);
      const Rule& along = rules.rule(apex_distance / base.norm());
      for (std::size_t j = 0; j < along.size(); ++j) {
        const double s = along.position_high[j];
        add(apex.from_plate + s * base, mixed(apex.barycentric, base_barycentric, s),
            mixed(apex.position, base_position, s),
            twice_area * across.weight_high[i] * along.weight_high[j] * s);
      }
    }
  }

  void add(const Vector3d& from_plate, const Vector3d& barycentric, const Vector3d& position, double weight) {
    const double squared_distance = from_plate.squaredNorm() + smallest_distance_ * smallest_distance_;
    const Vector3d force = weight / (squared_distance * std::sqrt(squared_distance)) * from_plate;
    moments_.vertices += force * barycentric.transpose();
    moments_.edge_u += std::clamp(position.x() / lengths_.x(), 0.0, 1.0) * force;
    moments_.edge_v += std::clamp(position.y() / lengths_.y(), 0.0, 1.0) * force;
  }

  Eigen::Vector2d lengths_;
  double smallest_distance_;
  Moments moments_;
};

/// Returns the largest change caused by moving a component of a vector by one unit in its last place.
double largest_change(const Vector3d& derivative, const Vector3d& input) {
  double largest = 0;
  for (int k = 0; k < 3; ++k)
    largest = std::max(largest, std::abs(derivative[k]) * unit_in_the_last_place(input[k]));
  return largest;
}

}  // namespace

double conditioning(const Dissection& dissection, const Triangle& triangle, const Rectangle& plate,
                    double value) {
  const double smallest_distance = largest_unit(triangle, plate);
  const Moments moments = MomentIntegrator(dissection, smallest_distance).moments();
  Matrix3d axes;  // rows: the plate's x, y, z; the transpose maps a gradient to world coordinates
  for (int i = 0; i < 3; ++i)
    axes.row(i) = dissection.frame.axes[static_cast<std::size_t>(i)].cast<double>();
  const auto& p = dissection.vertices;
  const RealVector normal = RealVector(p[1] - p[0]).cross(RealVector(p[2] - p[0])) / dissection.twice_area;

  double largest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const RealVector opposite = p[(i + 1) % 3] - p[(i + 2) % 3];
    const RealVector area_gradient = opposite.cross(normal) / dissection.twice_area;
    const Vector3d gradient =
        value * area_gradient.cast<double>() - moments.vertices.col(static_cast<Eigen::Index>(i));
    largest = std::max(largest, largest_change(axes.transpose() * gradient, triangle[i]));
  }
  const Vector3d corner = moments.vertices.rowwise().sum();
  largest = std::max(largest, largest_change(axes.transpose() * corner, plate.corner));

  // y is the part of edge_v perpendicular to edge_u: a component of edge_v along edge_u has no effect, and
  // rotating edge_u towards y rotates y the opposite way.
  const double ratio = static_cast<double>(dissection.frame.lengths[1] / dissection.frame.lengths[0]);
  Vector3d edge_u = moments.edge_u, edge_v = moments.edge_v;
  edge_u.y() -= ratio * moments.edge_v.x();
  edge_v.x() = 0;
  largest = std::max({largest, largest_change(axes.transpose() * edge_u, plate.edge_u),
                      largest_change(axes.transpose() * edge_v, plate.edge_v)});
  return largest / value;
}

}  // namespace fringe::stress
