#include "import_program.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "program.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

/// Finds the program beside this one, where it is built, or where it is installed.
fs::path find_program() {
  const fs::path folder = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path place : {"", FRINGE_LIBEXEC_FROM_BIN})
    if (fs::path program = folder / place / "fringe-import"; fs::is_regular_file(program))
      return program;
  throw std::runtime_error(fmt::format("there is no program fringe-import in {} or {}", folder.string(),
                                       (folder / FRINGE_LIBEXEC_FROM_BIN).lexically_normal().string()));
}

}  // namespace

int run_import(int argument_count, char** arguments) {
  const fs::path program = find_program();
  std::string name = program.string();
  std::vector<char*> forwarded{name.data()};
  forwarded.insert(forwarded.end(), arguments + 2, arguments + argument_count);
  forwarded.push_back(nullptr);
  pid_t child = 0;
  if (const int error = posix_spawn(&child, program.c_str(), nullptr, nullptr, forwarded.data(), environ);
      error != 0)
    throw std::runtime_error(fmt::format("{}: cannot be started", program.string()));
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR)
      throw std::runtime_error(fmt::format("{}: cannot be waited for", program.string()));
  if (WIFEXITED(status))
    return WEXITSTATUS(status);
  /// The shell's status of a program that a signal ended is larger than the signal's number by this.
  constexpr int by_signal = 128;
  const int ending = WTERMSIG(status);
  if (ending == SIGINT || ending == SIGTERM || ending == SIGKILL || ending == SIGPIPE || ending == SIGHUP)
    return by_signal + ending;
  fmt::print(stderr,
             "fringe: import {}: the file cannot be read: the library that reads it ended by signal {}\n",
             fmt::join(arguments + 2, arguments + argument_count, " "), ending);
  return wrong_input;
}

}  // namespace fringe::cli
