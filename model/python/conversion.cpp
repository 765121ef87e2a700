#include "conversion.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <pybind11/numpy.h>

#include "fringe/error.hpp"

namespace py = pybind11;

namespace fringe::python {
namespace {

using Json = nlohmann::ordered_json;

bool is_vector(const Json& value) {
  return value.is_array() && !value.empty() &&
         std::all_of(value.begin(), value.end(), [](const Json& part) { return part.is_number_float(); });
}

bool is_matrix(const Json& value) {
  return value.is_array() && !value.empty() && std::all_of(value.begin(), value.end(), [&](const Json& row) {
           return is_vector(row) && row.size() == value.front().size();
         });
}

/// Copies the numbers of a value to a place in memory, from which it returns the end.
double* copy_numbers(const Json& value, double* target) {
  if (!value.is_array()) {
    *target = value.get<double>();
    return target + 1;
  }
  for (const Json& part : value)
    target = copy_numbers(part, target);
  return target;
}

py::object array(const Json& value, const std::vector<std::size_t>& shape) {
  py::array_t<double> result(shape);
  copy_numbers(value, result.mutable_data());
  return result;
}

py::object list(const Json& array) {
  py::list result;
  for (const Json& part : array)
    result.append(python_object(part));
  return result;
}

py::object dictionary(const Json& object) {
  py::dict result;
  for (const auto& [key, part] : object.items()) {
    // Keys are few and return in every answer. A name may hold the character NUL.
    PyObject* name = py::str(key).release().ptr();
    PyUnicode_InternInPlace(&name);
    result[py::reinterpret_steal<py::str>(name)] = python_object(part);
  }
  return result;
}

}  // namespace

py::object python_object(const Json& value) {
  if (is_vector(value))
    return array(value, {value.size()});
  if (is_matrix(value))
    return array(value, {value.size(), value.front().size()});
  if (value.is_array())
    return list(value);
  if (value.is_object())
    return dictionary(value);
  if (value.is_string())
    return py::str(value.get<std::string>());
  if (value.is_boolean())
    return py::bool_(value.get<bool>());
  if (value.is_number_integer())
    return py::int_(value.get<std::int64_t>());
  if (value.is_number_float())
    return py::float_(value.get<double>());
  return py::none();
}

namespace {

/// Writes a string of TOML: JSON escapes the same characters in the same way, but for the last of ASCII.
std::string quoted(const std::string& text) {
  std::string written;
  for (const char character : nlohmann::json(text).dump())
    written += character == '\x7f' ? std::string("\\u007f") : std::string(1, character);
  return written;
}

/// Returns the lists and numbers that NumPy's arrays and numbers stand for.
py::object plain(const py::handle& value) {
  return py::hasattr(value, "tolist") ? value.attr("tolist")() : py::reinterpret_borrow<py::object>(value);
}

bool is_list(const py::handle& value) {
  return py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value);
}

bool is_list_of_tables(const py::handle& value) {
  const auto is_table = [](const py::handle& element) { return py::isinstance<py::dict>(element); };
  return is_list(value) && py::len(value) > 0 && std::all_of(value.begin(), value.end(), is_table);
}

/// Writes a value within a line; `place` is its key for messages.
std::string inline_text(const py::handle& given, const std::string& place) {
  const py::object value = plain(given);
  if (py::isinstance<py::str>(value))
    return quoted(value.cast<std::string>());
  if (py::isinstance<py::bool_>(value))
    return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::int_>(value) || py::isinstance<py::float_>(value))
    return py::repr(value).cast<std::string>();
  std::vector<std::string> parts;
  if (is_list(value)) {
    for (const py::handle element : value)
      parts.push_back(inline_text(element, fmt::format("{}[{}]", place, parts.size())));
    return fmt::format("[{}]", fmt::join(parts, ", "));
  }
  if (py::isinstance<py::dict>(value)) {
    for (const auto& [key, inner] : value.cast<py::dict>()) {
      const auto name = py::str(key).cast<std::string>();
      parts.push_back(
          fmt::format("{} = {}", quoted(name), inline_text(inner, fmt::format("{}.{}", place, name))));
    }
    return fmt::format("{{ {} }}", fmt::join(parts, ", "));
  }
  throw InputError(fmt::format("{}: must be a text, a number, a truth value, a list or a dictionary, not {}",
                               place, py::str(py::type::of(value)).cast<std::string>()));
}

/// Writes the entries of a table, each on a line of its own.
std::string lines(const py::dict& table, const std::string& place) {
  std::string text;
  for (const auto& [key, value] : table) {
    const auto name = py::str(key).cast<std::string>();
    text += fmt::format("{} = {}\n", quoted(name), inline_text(value, fmt::format("{}.{}", place, name)));
  }
  return text;
}

}  // namespace

std::string scene_text(const py::handle& description) {
  if (py::isinstance<py::str>(description))
    return description.cast<std::string>();
  if (!py::isinstance<py::dict>(description))
    throw InputError("a scene must be a text or a dictionary");
  std::string entries, tables;
  for (const auto& [key, given] : description.cast<py::dict>()) {
    const auto name = py::str(key).cast<std::string>();
    const py::object value = plain(given);
    std::size_t number = 0;
    if (is_list_of_tables(value))
      for (const py::handle element : value)
        tables += fmt::format("[[{}]]\n{}", quoted(name),
                              lines(element.cast<py::dict>(), fmt::format("{}[{}]", name, number++)));
    else if (py::isinstance<py::dict>(value))
      tables += fmt::format("[{}]\n{}", quoted(name), lines(value.cast<py::dict>(), name));
    else
      entries += fmt::format("{} = {}\n", quoted(name), inline_text(value, name));
  }
  return entries + tables;
}

}  // namespace fringe::python
