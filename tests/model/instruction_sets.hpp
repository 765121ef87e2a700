#pragma once

#include <string>

#include <gtest/gtest.h>

#include "simd/dispatch.hpp"

namespace fringe::test {

/// Names a test that runs once for every instruction set of this machine.
inline std::string name_of_set(const testing::TestParamInfo<detail::InstructionSet>& info) {
  std::string name(detail::name_of(info.param));
  std::erase(name, '-');
  return name;
}

}  // namespace fringe::test
