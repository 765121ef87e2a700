#pragma once

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace fringe::cli {

/// Replaces everything but ASCII letters, digits and the characters of `kept` by underscores.
inline std::string plain_name(std::string name, const std::string& kept = "") {
  std::replace_if(
      name.begin(), name.end(),
      [&](unsigned char letter) {
        return (letter >= 0x80 || std::isalnum(letter) == 0) &&
               kept.find(static_cast<char>(letter)) == std::string::npos;
      },
      '_');
  return name;
}

/// Replaces line breaks and other control characters, so that a name stays on one line of a file.
inline std::string on_one_line(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char letter) { return std::iscntrl(letter) != 0; }, '?');
  return name;
}

/// Makes names unique by appending a number to a name that is taken already.
class UniqueNames {
 public:
  /// States whether names that differ only in the case of letters are different names.
  enum class Case { counts, does_not_count };

  explicit UniqueNames(std::string separator = " ", Case letters = Case::counts)
      : separator_(std::move(separator)), letters_(letters) {}

  /// Returns the wanted name, or one with the first number that makes it unique.
  std::string take(const std::string& wanted) {
    // Numbers up to the last one of this name are taken; there may be a hundred thousand.
    int& number = last_numbers_.emplace(wanted, 1).first->second;
    std::string name = wanted;
    while (!taken_.insert(compared(name)).second)
      name = fmt::format("{}{}{}", wanted, separator_, ++number);
    return name;
  }

 private:
  std::string compared(std::string name) const {
    if (letters_ == Case::does_not_count)
      std::transform(name.begin(), name.end(), name.begin(),
                     [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return name;
  }

  std::string separator_;
  Case letters_;
  std::set<std::string> taken_;
  std::map<std::string, int> last_numbers_;  ///< by wanted names
};

}  // namespace fringe::cli
