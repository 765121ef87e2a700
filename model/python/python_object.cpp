#include "python_object.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <pybind11/numpy.h>

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

}  // namespace fringe::python
