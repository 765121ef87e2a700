#pragma once

namespace fringe {

/// The version of this library, "major.minor.patch".
const char* version();

}  // namespace fringe
