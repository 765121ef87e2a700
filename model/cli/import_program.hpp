#pragma once

namespace fringe::cli {

/// Runs the program of `fringe import` with the arguments after `import` and returns its exit status. One
/// that a signal ends, as a damaged file may do to the libraries that read it, is reported as wrong input
/// (2). Throws std::runtime_error when the program is not there.
int run_import(int argument_count, char** arguments);

}  // namespace fringe::cli
