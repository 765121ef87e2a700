#include "sensing/cone_line.hpp"

namespace fringe::detail {

bool FieldOfView::contains(const PreciseVector& point) const {
  const DoubleDouble ahead = dot(cone_.axis, point), square = dot(point, point);
  // In a narrow cone cosines hardly differ but sines do; in a wide cone it is the other way round.
  if (cone_.cosine.high < cone_.sine.high)
    return (ahead - (cone_.cosine - DoubleDouble{precise_noise, 0}) * square_root(square)).high >= 0;
  const PreciseVector aside = cross(cone_.axis, point);
  return ahead.high >= 0 &&
         (dot(aside, aside) - (1 + precise_noise) * (cone_.sine * cone_.sine * square)).high <= 0;
}

Crossings FieldOfView::crossings(const PreciseLine& line) const {
  // The plane through the line and the apex contains two rays of the cone's surface, at equal angles to the
  // axis' projection, whose components are `towards` and `along`; the tangents of these angles are `width`
  // over the cosine. This finds crossings with the cone only and never with its mirror image, which also
  // solves the squared equation.
  const DoubleDouble towards = dot(cone_.axis, line.to_foot), along = dot(cone_.axis, line.along);
  DoubleDouble square, largest;
  if (cone_.cosine.high < cone_.sine.high) {
    const DoubleDouble projection = towards * towards + along * along, limit = cone_.cosine * cone_.cosine;
    square = projection - limit;
    largest = projection + limit;
  } else {
    const DoubleDouble out_of_plane = dot(cone_.axis, cross(line.to_foot, line.along));
    const DoubleDouble height = out_of_plane * out_of_plane, limit = cone_.sine * cone_.sine;
    square = limit - height;
    largest = limit + height;
  }
  if (square.high < -precise_noise * largest.high)
    return {};
  const DoubleDouble width = square.high > 0 ? square_root(square) : DoubleDouble{};
  Crossings result;
  for (const DoubleDouble side : {width, -width}) {
    const DoubleDouble cosine = towards * cone_.cosine - along * side,
                       sine = along * cone_.cosine + towards * side;
    if (cosine.high > 0)
      result.add(line.distance * sine / cosine);
  }
  return result;
}

}  // namespace fringe::detail
