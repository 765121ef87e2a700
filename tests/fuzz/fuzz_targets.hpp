#pragma once

#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>

#include <fmt/format.h>

/// The fuzz targets. Each decodes its input from bytes and aborts the process when a required property of the
/// answer is violated. A refusal by InputError is a valid answer.
namespace fringe::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// Aborts the process unless the claim holds, so that a fuzzer keeps the input.
inline void require(bool claim, std::string_view what) {
  if (claim)
    return;
  fmt::print(stderr, "does not hold: {}\n", what);
  std::abort();
}

/// Reads the bytes as a scene file. It must be accepted, or refused with a message of one printable line.
void scene_reader(Bytes bytes);

/// Reads the bytes after the first as an STL, OBJ or PLY file, as the first byte selects. The triangles must
/// be finite, or the file be refused likewise.
void mesh_reader(Bytes bytes);

/// Integrates over a triangle for a plate. The integral must be at least area over greatest distance, not
/// depend on which vertex comes first, and be the same in a batch.
void plate_integral(Bytes bytes);

/// Tests two sets of vertices for intersection. The certificate must prove the answer, which must not depend
/// on the order of the sets and must agree with their distance.
void gjk_intersects(Bytes bytes);

/// Searches triangles for the closest point in a cone. Both methods must find the same distance.
void cone_closest(Bytes bytes);

}  // namespace fringe::fuzz
