#pragma once

#include "bem/bodies.hpp"

namespace fringe::detail {

/// Throws InputError if two bodies in world coordinates have a point in common, or if one is inside the other
/// and that is closed.
void refuse_contact(const ChargedBody& a, const ChargedBody& b);

}  // namespace fringe::detail
