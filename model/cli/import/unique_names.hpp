#pragma once

#include <set>
#include <string>

#include <fmt/format.h>

namespace fringe::cli {

/// Makes names unique by appending a number to a name that is taken already.
class UniqueNames {
 public:
  /// Returns the wanted name, or one with the first number that makes it unique.
  std::string take(const std::string& wanted) {
    std::string name = wanted;
    for (int number = 2; !taken_.insert(name).second; ++number)
      name = fmt::format("{} {}", wanted, number);
    return name;
  }

 private:
  std::set<std::string> taken_;
};

}  // namespace fringe::cli
