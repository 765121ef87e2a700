#include "answers/json_text.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

namespace fringe::answers {
namespace {

using Json = nlohmann::ordered_json;

constexpr int format_version = 1;
constexpr std::size_t indentation = 4;

/// Writes a value without parts. The library's own writer replaces infinity with null.
std::string scalar(const Json& value) {
  if (value.is_number_float() && std::isinf(value.get<double>()))
    return value.get<double>() > 0 ? "1e999" : "-1e999";
  return value.dump();
}

/// Appends a value that stands at a depth of nesting, each of its parts on a line of its own.
void append(std::string& text, const Json& value, std::size_t depth) {
  if (!value.is_structured() || value.empty()) {
    text += scalar(value);
    return;
  }
  const bool object = value.is_object();
  char separator = object ? '{' : '[';
  for (const auto& [key, part] : value.items()) {
    text += separator;
    text += '\n' + std::string(indentation * (depth + 1), ' ');
    if (object)
      text += Json(key).dump() + ": ";
    append(text, part, depth + 1);
    separator = ',';
  }
  text += '\n' + std::string(indentation * depth, ' ') + (object ? '}' : ']');
}

}  // namespace

std::string json_text(const Json& answer) {
  Json document{{"format", format_version}};
  document.update(answer);
  std::string text;
  append(text, document, 0);
  return text;
}

}  // namespace fringe::answers
