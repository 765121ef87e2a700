#include "fringe/thesis.hpp"

#include <algorithm>

#include <Eigen/Geometry>

#include "collision/convex_pair.hpp"

/// Algorithm 2.1 with appendix C as printed, including its mistakes; it serves for comparison only.
namespace fringe {
namespace {

using detail::Vertices;
using Eigen::Vector3d;

Vector3d farthest(Vertices vertices, const Vector3d& direction) {
  return *std::max_element(vertices.begin(), vertices.end(), [&](const Vector3d& p, const Vector3d& q) {
    return p.dot(direction) < q.dot(direction);
  });
}

/// Computes (u × v) × u.
Vector3d double_cross(const Vector3d& u, const Vector3d& v) {
  return u.cross(v).cross(u);
}

/// The points of the simplex besides the newest, A; B was added last.
struct ThesisSimplex {
  Vector3d b = Vector3d::Zero(), c = Vector3d::Zero(), d = Vector3d::Zero();
  int size = 0;

  void keep(const Vector3d& new_b) {
    b = new_b;
    size = 1;
  }
  void keep(const Vector3d& new_b, const Vector3d& new_c) {
    keep(new_b);
    c = new_c;
    size = 2;
  }
  void keep(const Vector3d& new_b, const Vector3d& new_c, const Vector3d& new_d) {
    keep(new_b, new_c);
    d = new_d;
    size = 3;
  }
};

/// Handles the regions 3 to 6 of the triangle ABC. The points are copies, so that the simplex can be changed.
void update_triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c, ThesisSimplex& simplex,
                     Vector3d& v) {
  const Vector3d ab = b - a, ac = c - a, ao = -a, normal = ab.cross(ac);
  if (ab.cross(normal).dot(ao) > 0) {
    simplex.keep(a, b);
    v = double_cross(ab, ao);
  } else if (normal.cross(ac).dot(ao) > 0) {
    simplex.keep(a, c);
    v = double_cross(ac, ao);
  } else if (normal.dot(ao) > 0) {
    simplex.keep(a, b, c);
    v = normal;
  } else {
    simplex.keep(a, c, b);
    v = -normal;
  }
}

/// The thesis' CheckAndUpdateSimplex: updates the simplex and the direction; true if it contains the origin.
bool check_and_update(const Vector3d& a, ThesisSimplex& simplex, Vector3d& v) {
  const Vector3d ao = -a;
  if (simplex.size == 0) {
    simplex.keep(a);
    v = ao;
    return false;
  }
  const auto [b, c, d, size] = simplex;
  const Vector3d ab = b - a;
  if (size == 1) {
    v = double_cross(ab, ao);
    simplex.keep(a, b);
    return false;
  }
  if (size == 2) {
    update_triangle(a, b, c, simplex, v);
    return false;
  }
  // The origin counts as in front of a face wherever it is not in region 5; the sign printed for region 4
  // contradicts region 5.
  const Vector3d ac = c - a, ad = d - a;
  if (ac.cross(ad).dot(ao) > 0)
    update_triangle(a, c, d, simplex, v);
  else if (ad.cross(ab).dot(ao) > 0)
    update_triangle(a, d, b, simplex, v);
  else if (ab.cross(ac).dot(ao) > 0)
    update_triangle(a, b, c, simplex, v);
  else
    return true;
  return false;
}

}  // namespace

std::optional<bool> thesis_gjk_intersects(Vertices a, Vertices b, int most_rounds) {
  detail::check_vertices(a, 'A');
  detail::check_vertices(b, 'B');
  ThesisSimplex simplex;
  Vector3d v = Vector3d::UnitX();
  for (int round = 0; round < most_rounds; ++round) {
    const Vector3d s = farthest(a, v) - farthest(b, -v);
    if (s.dot(v) <= 0)
      return false;
    if (check_and_update(s, simplex, v))
      return true;
  }
  return std::nullopt;
}

}  // namespace fringe
