#include "collision_answers.hpp"

#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "conversion.hpp"

namespace py = pybind11;

namespace fringe::python {
namespace {

py::object checked(PyObject* made) {
  if (made == nullptr)
    throw py::error_already_set();
  return py::reinterpret_steal<py::object>(made);
}

/// Returns Python's text of a status, always the same object.
PyObject* text_of(PairStatus status) {
  static const auto interned = [](PairStatus named) {
    return PyUnicode_InternFromString(std::string(to_string(named)).c_str());
  };
  static PyObject* const clear = interned(PairStatus::clear);
  static PyObject* const bounds = interned(PairStatus::bounds);
  static PyObject* const collision = interned(PairStatus::collision);
  return status == PairStatus::clear ? clear : status == PairStatus::bounds ? bounds : collision;
}

}  // namespace

CollisionAnswers::CollisionAnswers(const nlohmann::ordered_json& description, std::vector<ObjectPair> pairs,
                                   std::uint64_t beginning)
    : beginning_(beginning), pairs_(std::move(pairs)), prototype_(python_object(description)),
      prototypes_(prototype_["pairs"]), key_(checked(PyUnicode_InternFromString("status"))) {}

/// Tests whether nobody but its list holds an entry and its keys and values, all but the status, are those of
/// its prototype.
bool CollisionAnswers::can_be_given_again(PyObject* entry, PyObject* prototype) const {
  if (Py_REFCNT(entry) != 1 || !PyDict_CheckExact(entry))
    return false;
  Py_ssize_t place = 0, known_place = 0;
  PyObject *key, *value, *known_key, *known_value;
  while (PyDict_Next(prototype, &known_place, &known_key, &known_value) != 0)
    if (PyDict_Next(entry, &place, &key, &value) == 0 || key != known_key ||
        (value != known_value && key != key_.ptr()))
      return false;
  return PyDict_Next(entry, &place, &key, &value) == 0;
}

/// Returns the list of an earlier answer that nobody else holds, or a new one.
py::list CollisionAnswers::list_to_fill() {
  next_ = 1 - next_;
  py::list& list = lists_[next_];
  const auto count = static_cast<Py_ssize_t>(pairs_.size());
  if (!list || list.ref_count() != 1 || PyList_GET_SIZE(list.ptr()) != count) {
    list = py::list();
    for (const py::handle prototype : prototypes_)
      list.append(checked(PyDict_Copy(prototype.ptr())));
  }
  return list;
}

py::dict CollisionAnswers::answer(const SceneCollision& collision) {
  py::list list = list_to_fill();
  auto marked = collision.marked.begin();
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const auto place = static_cast<Py_ssize_t>(i);
    PairStatus status = PairStatus::clear;
    if (marked != collision.marked.end() && marked->a == pairs_[i].a && marked->b == pairs_[i].b)
      status = (marked++)->status;
    PyObject* const prototype = PyList_GET_ITEM(prototypes_.ptr(), place);
    if (!can_be_given_again(PyList_GET_ITEM(list.ptr(), place), prototype))
      list[i] = checked(PyDict_Copy(prototype));
    PyObject* const entry = PyList_GET_ITEM(list.ptr(), place);
    if (PyDict_GetItemWithError(entry, key_.ptr()) != text_of(status) &&
        PyDict_SetItem(entry, key_.ptr(), text_of(status)) != 0)
      throw py::error_already_set();
  }
  auto result = py::reinterpret_steal<py::dict>(checked(PyDict_Copy(prototype_.ptr())).release());
  py::dict tests;
  tests["broad"] = collision.tests.broad;
  tests["narrow"] = collision.tests.narrow;
  result["tests"] = tests;
  result["pairs"] = list;
  result["remarks"] = py::list(py::tuple(prototype_["remarks"]));
  return result;
}

}  // namespace fringe::python
