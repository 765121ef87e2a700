#include "maxwell_dictionary.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

namespace py = pybind11;
using namespace pybind11::literals;

namespace fringe::python {

py::dict maxwell_dictionary(const MaxwellMatrix& matrix, double rtol, double seconds) {
  py::dict changes;
  for (std::size_t s = 0; s < matrix.sensors; ++s) {
    const auto at = static_cast<Eigen::Index>(s);
    changes[py::str(matrix.conductors[s])] =
        py::dict("value"_a = matrix.delta_self[at], "error"_a = matrix.delta_self_errors[at]);
  }
  return py::dict("conductors"_a = matrix.conductors, "maxwell"_a = matrix.values, "error"_a = matrix.errors,
                  "delta_self"_a = changes, "floating"_a = matrix.floating,
                  "lower_bounds"_a = matrix.lower_bounds, "rtol"_a = rtol, "reached"_a = matrix.reached,
                  "unknowns"_a = matrix.unknowns, "seconds"_a = seconds);
}

py::dict capacitance_dictionary(const Scene& scene, const MaxwellMatrix& matrix, const std::string& method,
                                double rtol, double seconds) {
  py::list sensors;
  Eigen::Index row = 0;
  for (const SensorCapacitance& felt : capacitance(scene, matrix).sensors) {
    py::list objects;
    for (std::size_t k = 0; k < felt.objects.size(); ++k) {
      const ObjectCapacitance& object = felt.objects[k];
      const auto column = static_cast<Eigen::Index>(matrix.conductor_of(k));
      objects.append(py::dict("name"_a = object.name, "capacitance"_a = object.capacitance,
                              "error"_a = matrix.errors(row, column), "bound"_a = object.bound,
                              "skipped"_a = object.skipped));
    }
    sensors.append(py::dict("name"_a = felt.name, "total"_a = felt.total, "voltage"_a = felt.voltage,
                            "delta_voltage"_a = felt.delta_voltage, "contact"_a = felt.contact,
                            "self"_a = matrix.values(row, row), "self_error"_a = matrix.errors(row, row),
                            "delta_self"_a = matrix.delta_self[row],
                            "delta_self_error"_a = matrix.delta_self_errors[row], "objects"_a = objects));
    ++row;
  }
  return py::dict("options"_a = py::dict("method"_a = method, "rtol"_a = rtol), "seconds"_a = seconds,
                  "reached"_a = matrix.reached, "unknowns"_a = matrix.unknowns,
                  "conductors"_a = matrix.conductors, "floating"_a = matrix.floating,
                  "maxwell"_a = matrix.values, "error"_a = matrix.errors,
                  "lower_bounds"_a = matrix.lower_bounds, "sensors"_a = sensors);
}

}  // namespace fringe::python
