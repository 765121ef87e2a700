#pragma once

#include <string>

namespace fringe::cli {

/// Writes a name as a field of comma-separated values: in quotation marks where a comma, a quotation mark or
/// a line end needs them.
inline std::string csv_field(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos)
    return name;
  std::string text = "\"";
  for (const char letter : name)
    text += letter == '"' ? "\"\"" : std::string(1, letter);
  return text + '"';
}

}  // namespace fringe::cli
