#pragma once

#include <cstdint>
#include <span>

/// What a fuzzer feeds with bytes. Each target makes its input of them, and ends the process when what must
/// hold of the answer does not; a refusal by InputError is an answer.
namespace fringe::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// A scene file of these bytes: read, or refused in one line that can be printed.
void scene_reader(Bytes bytes);

/// The first byte chooses STL, OBJ or PLY, the rest is the file: read as finite triangles, or refused
/// likewise.
void mesh_reader(Bytes bytes);

/// A triangle and a plate: the integral is no less than area over the greatest distance, does not depend on
/// the vertex that comes first, and is the same in a batch.
void plate_integral(Bytes bytes);

/// Two sets of vertices: the answer is proven by its certificate, the same for either order, and that of the
/// distance.
void gjk_intersects(Bytes bytes);

/// Triangles and a cone: both methods see the same, at the same distance.
void cone_closest(Bytes bytes);

}  // namespace fringe::fuzz
