#pragma once

#include <nlohmann/json_fwd.hpp>
#include <pybind11/pybind11.h>

namespace fringe::python {

/// Converts a JSON value to Python's types, and arrays of doubles, or of equally long arrays of doubles, to
/// NumPy arrays.
pybind11::object python_object(const nlohmann::ordered_json& value);

}  // namespace fringe::python
