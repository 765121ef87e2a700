#pragma once

#include <vector>

#include "fringe/triangle.hpp"

/// A person: a closed surface on a lattice of cells, with the proportions that geometries/scene/person.py
/// gives with their sources; geometries/people has the meshes.
namespace fringe::detail {

enum class PersonAge { adult, child, infant };

enum class Posture { standing, lying, arm_stretched };

/// Returns the triangles of a person of this height (m), centred at the origin: standing along z with the
/// face towards +x, or lying on the back with the head towards −x and the face towards +z. With
/// `arm_stretched` the right arm, at −y, is stretched out forwards. The surface is closed, its triangles are
/// anticlockwise seen from outside.
std::vector<Triangle> triangles_of_person(double height, PersonAge age, Posture posture);

}  // namespace fringe::detail
