#pragma once

namespace fringe::detail {

/// Returns a digest of the library's sources, made by the build: what one state of them has prepared may be
/// something else to another.
const char* sources_digest();

}  // namespace fringe::detail
