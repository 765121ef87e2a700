#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <pybind11/pybind11.h>

#include "fringe/scene_collision.hpp"

namespace fringe::python {

/// Makes the answers of Scene.collide() while links move. They differ only in the statuses of the pairs and
/// in the tests, and a scene of 30 objects has some hundred pairs, so that making all dictionaries anew would
/// take far longer than to find the collisions. Dictionaries of an earlier answer are therefore given out
/// again if nobody else holds them and they are as they were made. Every call needs Python's lock.
class CollisionAnswers {
 public:
  /// Takes the description of an answer, its pairs, and the number of the scene's beginning that it belongs
  /// to.
  CollisionAnswers(const nlohmann::ordered_json& description, std::vector<ObjectPair> pairs,
                   std::uint64_t beginning);

  std::uint64_t beginning() const { return beginning_; }

  /// Returns the answer in Python's types, equal to what python_object() makes of its description.
  pybind11::dict answer(const SceneCollision& collision);

 private:
  bool can_be_given_again(PyObject* entry, PyObject* prototype) const;
  pybind11::list list_to_fill();

  std::uint64_t beginning_;
  std::vector<ObjectPair> pairs_;
  pybind11::dict prototype_;
  pybind11::list prototypes_;  ///< of the pairs
  pybind11::str key_;          ///< "status"
  /// The lists of earlier answers: while one answer takes the place of another, both exist.
  std::array<pybind11::list, 2> lists_;
  std::size_t next_ = 0;
};

}  // namespace fringe::python
