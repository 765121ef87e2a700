#pragma once

#include <string>

#include <pybind11/pybind11.h>

namespace fringe::python {

/// Returns the text of a scene file: a text as it is, or that of a dictionary with the keys of the format,
/// whose lists of dictionaries are its arrays of tables. NumPy's arrays and numbers stand for lists and
/// numbers.
/// @throws InputError for a value of another type, with its key.
std::string scene_text(const pybind11::handle& description);

}  // namespace fringe::python
