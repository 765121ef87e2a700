#include "truth.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace fringe::stress {
namespace {

using Polygon = std::vector<Point>;

RealVector normalized(const RealVector& vector) {
  return vector / Real(sqrt(vector.squaredNorm()));
}

/// The strips into which two parallel border planes divide space.
enum class Strip { below, within, above };

constexpr std::array<Strip, 3> strips{Strip::below, Strip::within, Strip::above};

/// Clips a convex polygon to side·(coordinate − bound) ≥ 0.
Polygon half(const Polygon& polygon, int axis, const Real& bound, int side) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &current = polygon[i], &next = polygon[(i + 1) % polygon.size()];
    const Real here = side * (current.position[axis] - bound), there = side * (next.position[axis] - bound);
    if (here >= 0)
      kept.push_back(current);
    if ((here > 0 && there < 0) || (here < 0 && there > 0)) {
      kept.push_back(between(current, next, here / (here - there)));
      kept.back().position[axis] = bound;
    }
  }
  return kept;
}

bool lies_in(const Polygon& polygon, int axis, const Real& bound) {
  return std::all_of(polygon.begin(), polygon.end(),
                     [&](const Point& point) { return point.position[axis] == bound; });
}

/// Clips a convex polygon to a strip; the result is empty if the polygon only touches the strip. A polygon in
/// a border plane belongs to the lower of the two strips that meet there, so that it is counted once.
Polygon in_strip(const Polygon& polygon, int axis, Strip strip, const Real& length) {
  Polygon kept = polygon;
  if (strip != Strip::below) {
    const Real lower = strip == Strip::within ? Real(0) : length;
    kept = half(kept, axis, lower, 1);
    if (lies_in(kept, axis, lower))
      return {};
  }
  if (strip != Strip::above) {
    const Real upper = strip == Strip::below ? Real(0) : length;
    kept = half(kept, axis, upper, -1);
    if (lies_in(kept, axis, upper) && !lies_in(polygon, axis, upper))
      return {};
  }
  return kept;
}

Real from_interval(const Real& coordinate, Strip strip, const Real& length) {
  return strip == Strip::below ? coordinate : strip == Strip::within ? Real(0) : Real(coordinate - length);
}

/// Returns whether a polygon in one cell meets the plate in more than a point. Outside region I the plate
/// meets the cells only at their border, so the ends of a common segment are two corners of the polygon.
bool meets_plate_along_a_segment(const Polygon& polygon, bool in_front) {
  std::vector<RealVector> contacts;
  bool above = false, below = false;
  for (const Point& point : polygon) {
    above = above || point.from_plate.z() > 0;
    below = below || point.from_plate.z() < 0;
    if (point.from_plate.squaredNorm() == 0)
      contacts.push_back(point.position);
  }
  const bool two_contacts = std::any_of(contacts.begin(), contacts.end(), [&](const RealVector& contact) {
    return contact != contacts.front();
  });
  return two_contacts || (in_front && above && below);
}

/// Returns the point of a segment nearest to the plate.
Point nearest_on_segment(const Point& a, const Point& b) {
  const RealVector edge = b.from_plate - a.from_plate;
  const Real squared_length = edge.squaredNorm();
  if (squared_length == 0)
    return a;
  const Real share = -a.from_plate.dot(edge) / squared_length;
  return share <= 0 ? a : share >= 1 ? b : between(a, b, share);
}

/// Returns the point inside a triangle where the distance is stationary, if there is one.
std::optional<Point> stationary_point(const Point& a, const Point& b, const Point& c) {
  const RealVector u = b.from_plate - a.from_plate, v = c.from_plate - a.from_plate;
  const Real uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const Real ua = -u.dot(a.from_plate), va = -v.dot(a.from_plate);
  const Real determinant = uu * vv - uv * uv;
  if (determinant <= 0)
    return std::nullopt;
  const Real share_b = (ua * vv - va * uv) / determinant, share_c = (va * uu - ua * uv) / determinant;
  const Real share = share_b + share_c;
  if (share_b < 0 || share_c < 0 || share > 1 || share == 0)
    return std::nullopt;
  return between(a, between(b, c, share_c / share), share);
}

/// The point of a polygon nearest to the plate, and the edges that do not contain it.
struct Nearest {
  Point point;
  Real squared_distance;
  std::vector<std::size_t> other_edges;
};

/// Returns the indices of all edges except the excluded ones; edge i leads from corner i to the next.
std::vector<std::size_t> edges_without(std::size_t size, std::initializer_list<std::size_t> excluded) {
  std::vector<std::size_t> edges;
  for (std::size_t i = 0; i < size; ++i)
    if (std::find(excluded.begin(), excluded.end(), i) == excluded.end())
      edges.push_back(i);
  return edges;
}

Nearest nearest(const Polygon& polygon) {
  const std::size_t size = polygon.size();
  std::optional<Nearest> best;
  const auto consider = [&](const Point& point, std::initializer_list<std::size_t> on_edges) {
    const Real squared_distance = point.from_plate.squaredNorm();
    if (!best || squared_distance < best->squared_distance)
      best = Nearest{point, squared_distance, edges_without(size, on_edges)};
  };
  for (std::size_t i = 0; i < size; ++i)
    consider(polygon[i], {i, (i + size - 1) % size});
  for (std::size_t i = 0; i < size; ++i)
    consider(nearest_on_segment(polygon[i], polygon[(i + 1) % size]), {i});
  for (std::size_t i = 1; i + 1 < size; ++i)
    if (const auto point = stationary_point(polygon[0], polygon[i], polygon[i + 1]))
      consider(*point, {});
  return *best;
}

void add_sectors(std::vector<Sector>& sectors, const Polygon& polygon) {
  const Nearest apex = nearest(polygon);
  for (const std::size_t edge : apex.other_edges) {
    const Point &first = polygon[edge], &second = polygon[(edge + 1) % polygon.size()];
    // The distance decreases along an edge up to its nearest point and increases from there.
    const Point foot = nearest_on_segment(first, second);
    for (const Point* end : {&first, &second})
      if (end->position != foot.position && twice_area(apex.point.position, foot.position, end->position) > 0)
        sectors.push_back({apex.point, foot, *end});
  }
}

}  // namespace

ExactFrame exact_frame(const Rectangle& plate) {
  const RealVector u = plate.edge_u.cast<Real>(), v = plate.edge_v.cast<Real>();
  const RealVector along_u = normalized(u), normal = normalized(u.cross(v));
  return {plate.corner.cast<Real>(),
          {along_u, normal.cross(along_u), normal},
          {Real(sqrt(u.squaredNorm())), Real(sqrt(v.squaredNorm()))}};
}

Point between(const Point& a, const Point& b, const Real& share) {
  return {a.position + share * (b.position - a.position),
          a.barycentric + share * (b.barycentric - a.barycentric),
          a.from_plate + share * (b.from_plate - a.from_plate)};
}

Real twice_area(const RealVector& a, const RealVector& b, const RealVector& c) {
  const RealVector u = b - a, v = c - a;
  return sqrt(u.cross(v).squaredNorm());
}

Dissection dissect(const Triangle& triangle, const Rectangle& plate) {
  Dissection result;
  result.frame = exact_frame(plate);
  Polygon whole;
  for (int i = 0; i < 3; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const RealVector from_corner = triangle[index].cast<Real>() - result.frame.corner;
    for (int axis = 0; axis < 3; ++axis)
      result.vertices[index][axis] = from_corner.dot(result.frame.axes[static_cast<std::size_t>(axis)]);
    whole.push_back({result.vertices[index], RealVector::Unit(i), RealVector::Zero()});
  }
  result.twice_area = twice_area(result.vertices[0], result.vertices[1], result.vertices[2]);
  if (result.twice_area == 0)
    return result;

  for (const Strip u : strips) {
    const Polygon in_u = in_strip(whole, 0, u, result.frame.lengths[0]);
    for (const Strip v : strips) {
      Polygon piece = in_strip(in_u, 1, v, result.frame.lengths[1]);
      for (Point& point : piece)
        point.from_plate = {from_interval(point.position.x(), u, result.frame.lengths[0]),
                            from_interval(point.position.y(), v, result.frame.lengths[1]),
                            point.position.z()};
      if (meets_plate_along_a_segment(piece, u == Strip::within && v == Strip::within))
        result.divergent = true;
      if (!piece.empty())
        add_sectors(result.sectors, piece);
    }
  }
  return result;
}

}  // namespace fringe::stress
