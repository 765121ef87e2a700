#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "fringe/triangle.hpp"
#include "geometry/plate_frame.hpp"

/// Clipping of a triangle: at the four border planes of a plate, which are those through an edge, normal to
/// the plate (model/NUMERICS.md, section 6), and along parallel lines.
namespace fringe::detail {

/// Position of a coordinate relative to the plate's extent [0, length].
enum class Strip { below, within, above };

constexpr std::array<Strip, 3> strips{Strip::below, Strip::within, Strip::above};

/// One of the nine cells of space in each of which the nearest point of the plate is an affine function of
/// the point: region I where both strips are `within`, II where one is, III where none is.
struct Cell {
  Strip u;
  Strip v;
};

/// A corner of a piece, with its barycentric coordinates in the whole triangle.
struct PieceVertex {
  Eigen::Vector3d position;
  Eigen::Vector3d barycentric;
};

/// Largest number of corners of a piece: a triangle cut by four planes has at most seven.
constexpr std::size_t most_corners = 7;

/// A convex piece of a triangle.
struct Piece {
  std::array<PieceVertex, most_corners> vertices;
  std::size_t size = 0;
};

/// Makes a piece of the whole triangle.
Piece whole(const LocalTriangle& triangle);

/// Computes the vector from the nearest point of the plate to a point in the cell.
inline Eigen::Vector3d from_plate(const PlateFrame& plate, Cell cell, const Eigen::Vector3d& point) {
  const auto beside = [](Strip strip, double coordinate, double length) {
    return strip == Strip::below ? coordinate : strip == Strip::within ? 0.0 : coordinate - length;
  };
  return {beside(cell.u, point.x(), plate.length_u), beside(cell.v, point.y(), plate.length_v), point.z()};
}

/// Range of a piece's coordinates along an axis; from +infinity to −infinity when the piece is empty.
struct Extent {
  double lowest;
  double highest;
};

Extent extent(const Piece& piece, int axis);

/// Returns whether a piece of this extent has a part in the strip. A piece that lies in a border plane
/// belongs to exactly one of the two strips that meet there.
bool has_share(Strip strip, Extent extent, double length);

/// Returns the strip that contains all of a piece of this extent, if there is one.
std::optional<Strip> only_strip(Extent extent, double length);

/// Returns the part of a piece whose coordinate along the axis (0 or 1) lies in the strip.
Piece clip_to_strip(const Piece& piece, int axis, Strip strip, double length);

/// Computes the area of the triangle of three corners as a share of the whole triangle's area, in [0, 1].
double share_of_area(const PieceVertex& a, const PieceVertex& b, const PieceVertex& c);

/// One of the parts into which two parallel lines cut a triangle, as at most three triangles.
struct Slice {
  std::array<Triangle, 3> triangles;
  std::size_t size = 0;

  const Triangle* begin() const { return triangles.data(); }
  const Triangle* end() const { return triangles.data() + size; }
};

/// The three parts of a triangle by the values of an affine function.
struct Slices {
  Slice below;
  Slice between;
  Slice above;
};

/// Cuts a triangle along the lines on which an affine function, given by its values at the vertices, equals
/// low and high, where low ≤ high. A triangle on which the function equals one of these values everywhere is
/// not `between`.
Slices slices(const Triangle& triangle, const Eigen::Vector3d& values, double low, double high);

/// Bisects a triangle along the median onto its longest edge.
std::array<Triangle, 2> halves(const Triangle& triangle);

}  // namespace fringe::detail
