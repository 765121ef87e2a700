#pragma once

#include <string_view>

#include "bem/bodies.hpp"

namespace fringe::detail {

/// Throws InputError, with both names, if two bodies in world coordinates have a point in common, or if one
/// is inside the other and that is closed. The message ends with the reason and, if the first is a plate,
/// with how far it would have to be moved.
void refuse_contact(const ChargedBody& a, const ChargedBody& b, std::string_view reason);

/// Makes one conductor of grounded bodies that touch, overlap or contain each other, named after the first of
/// them. Bodies that touch others of their conductor get triangles in place of faces. Throws InputError for
/// contact between bodies that may have different potentials.
ChargedBodies joined(ChargedBodies bodies);

}  // namespace fringe::detail
