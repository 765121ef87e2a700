#include <fmt/format.h>

#include "fringe/capacitance.hpp"
#include "fringe/error.hpp"

namespace fringe {

PlateRule parse_plate_rule(std::string_view text) {
  if (text == "sum")
    return PlateRule::sum;
  if (text == "nearest")
    return PlateRule::nearest;
  throw InputError(fmt::format("plates '{}' is not known: it must be sum or nearest", text));
}

FaceRule parse_face_rule(std::string_view text) {
  if (text == "all")
    return FaceRule::all;
  if (text == "facing")
    return FaceRule::facing;
  throw InputError(fmt::format("faces '{}' is not known: it must be all or facing", text));
}

std::string to_string(PlateRule rule) {
  return rule == PlateRule::sum ? "sum" : "nearest";
}

std::string to_string(FaceRule rule) {
  return rule == FaceRule::all ? "all" : "facing";
}

}  // namespace fringe
