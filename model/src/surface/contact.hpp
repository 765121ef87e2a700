#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "surface/bodies.hpp"

namespace fringe::detail {

/// Divides faces into triangles, those of a box anticlockwise seen from outside.
TriangleSurface oriented_triangles(const BodySurface& surface);

/// Throws InputError, with both names, if two bodies in world coordinates have a point in common, or if one
/// is inside the other and that is closed. The message ends with the reason and, if the first is a plate,
/// with how far it would have to be moved.
void refuse_contact(const ChargedBody& a, const ChargedBody& b, std::string_view reason);

/// Returns true if two bodies have one potential: if both are grounded, or of one conductor.
bool have_one_potential(const ChargedBodies& bodies, std::size_t a, std::size_t b);

/// Two bodies that touch, overlap or contain each other, up to rounding of their poses; the earlier one
/// first.
using Contact = std::array<std::size_t, 2>;

/// Returns true if two bodies in world coordinates touch, overlap or contain each other.
bool are_in_contact(const ChargedBody& a, const ChargedBody& b);

/// Returns the contacts between bodies in world coordinates that have one potential.
std::vector<Contact> contacts_at_one_potential(const ChargedBodies& bodies);

/// Makes one conductor of bodies in contact. It has the first name that one of its objects gives it by
/// `conductor`, else that of its first object. Bodies in contact get triangles in place of faces. Bodies keep
/// their order.
ChargedBodies joined(ChargedBodies bodies, const std::vector<Contact>& contacts);

/// Joins the bodies, in world coordinates, that are in contact at one potential. Throws InputError for
/// contact between bodies that may have different potentials.
ChargedBodies joined(ChargedBodies bodies);

}  // namespace fringe::detail
