#pragma once

#include <string>

#include <pybind11/pybind11.h>

#include "fringe/boundary_elements.hpp"

/// Converts Maxwell matrices to Python dictionaries.
namespace fringe::python {

/// Returns a dictionary like the reference's document: conductors, maxwell, error, delta_self by sensor.
pybind11::dict maxwell_dictionary(const MaxwellMatrix& matrix, double rtol, double seconds);

/// Returns a dictionary like the document of `fringe capacitance --method METHOD --json`.
pybind11::dict capacitance_dictionary(const Scene& scene, const MaxwellMatrix& matrix,
                                      const std::string& method, double rtol, double seconds);

}  // namespace fringe::python
