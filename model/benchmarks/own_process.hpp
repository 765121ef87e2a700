#pragma once

#include <array>
#include <chrono>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <type_traits>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

namespace fringe::benchmarks {

/// The answer of a computation, its time and the largest memory of its process.
template <class Answer>
struct Measured {
  Answer answer;
  double seconds;
  double mebibytes;
};

/// Computes in a process of its own: the largest memory of a process never decreases, so that one process
/// cannot tell that of several computations. Call it before this process starts threads, which a copy of it
/// would not have.
template <class Computation>
auto in_own_process(const Computation& compute) {
  using Result = Measured<decltype(compute())>;
  static_assert(std::is_trivially_copyable_v<Result>);
  std::array<int, 2> pipe_ends{};
  if (pipe(pipe_ends.data()) != 0)
    throw std::runtime_error("no pipe to a process that computes");
  // What is not printed yet would be printed by both.
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0)
    throw std::runtime_error("no process to compute in");
  if (child == 0) {
    bool written = false;
    try {
      const auto start = std::chrono::steady_clock::now();
      Result result{compute(), 0, 0};
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      result.seconds = elapsed.count();
      written = write(pipe_ends[1], &result, sizeof result) == sizeof result;
    } catch (const std::exception& error) {
      fmt::print(stderr, "{}\n", error.what());
    }
    _exit(written ? 0 : 1);
  }
  close(pipe_ends[1]);
  Result result{};
  const bool is_read = read(pipe_ends[0], &result, sizeof result) == sizeof result;
  close(pipe_ends[0]);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  if (!is_read)
    throw std::runtime_error("a computation has no answer");
  /// Linux counts the memory in kibibytes.
  constexpr double kibibytes_in_mebibyte = 1024;
  result.mebibytes = static_cast<double>(usage.ru_maxrss) / kibibytes_in_mebibyte;
  return result;
}

}  // namespace fringe::benchmarks
