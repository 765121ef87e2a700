#include "program.hpp"

#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <stdexcept>

#include <fmt/format.h>

#include "fringe/error.hpp"

namespace fringe::cli {

void print(std::string answer) {
  if (answer.empty() || answer.back() != '\n')
    answer += '\n';
  std::cout << answer << std::flush;
  if (!std::cout)
    throw std::runtime_error("the answer could not be written");
}

void print_remarks(const std::vector<std::string>& remarks) {
  for (const std::string& remark : remarks)
    fmt::print(stderr, "fringe: remark: {}\n", remark);
}

int run_program(int (*run)(int, char**), int argument_count, char** arguments) {
  try {
    return run(argument_count, arguments);
  } catch (const InputError& error) {
    fmt::print(stderr, "fringe: {}\n", error.what());
    return wrong_input;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "fringe: there is not enough memory\n");
    return failed;
  } catch (const std::exception& error) {
    fmt::print(stderr, "fringe: {}\n", error.what());
    return failed;
  }
}

}  // namespace fringe::cli
