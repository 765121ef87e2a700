#pragma once

namespace fringe {

/// Returns the version of this library, "major.minor.patch".
const char* version();

}  // namespace fringe
