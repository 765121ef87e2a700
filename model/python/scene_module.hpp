#pragma once

#include <pybind11/pybind11.h>

namespace fringe::python {

/// Adds the classes Scene and Reading to the module.
void add_scene(pybind11::module_& module);

}  // namespace fringe::python
