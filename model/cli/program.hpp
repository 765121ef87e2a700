#pragma once

#include <string>
#include <vector>

namespace fringe::cli {

/// The exit status of the programs, which are the same for all subcommands.
enum ExitCode { answered = 0, failed = 1, wrong_input = 2, not_reached = 3, interrupted = 130 };

/// Prints an answer on standard output, with a line end. Throws std::runtime_error when it cannot be written.
void print(std::string answer);

/// Prints remarks on standard error, a line each.
void print_remarks(const std::vector<std::string>& remarks);

/// Calls `run` with the arguments of main() and returns its exit status. Prints the message of an exception
/// on standard error and returns `wrong_input` for an InputError and `failed` for any other.
int run_program(int (*run)(int, char**), int argument_count, char** arguments);

}  // namespace fringe::cli
