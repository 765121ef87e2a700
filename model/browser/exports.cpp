#include <exception>
#include <functional>
#include <memory>
#include <string>

#include <emscripten/emscripten.h>
#include <nlohmann/json.hpp>

#include "answers/json_text.hpp"
#include "fringe/pose.hpp"
#include "page.hpp"

/// What JavaScript calls. Each function that answers returns a JSON document, valid until the next call for
/// the same page: the answer, or {"refused": the reason}.
namespace {

using fringe::answers::Json;
using fringe::browser::Page;

/// A page and its last answer.
struct OpenPage {
  std::unique_ptr<Page> page;
  std::string answer;
};

/// Answers by `ask`, a function of the page. No exception leaves it: JavaScript could not read its message.
const char* answered(OpenPage& open, const std::function<Json(Page&)>& ask) {
  try {
    open.answer = fringe::answers::json_text(open.page ? ask(*open.page) : Json{{"refused", "no scene"}});
  } catch (const std::exception& error) {
    open.answer = fringe::answers::json_text({{"refused", error.what()}});
  }
  return open.answer.c_str();
}

/// Runs an action that has no answer of its own.
const char* done(OpenPage& open, const std::function<void(Page&)>& act) {
  return answered(open, [&](Page& page) {
    act(page);
    return Json::object();
  });
}

}  // namespace

extern "C" {

/// Opens a page; fringe_describe() then answers with its description, or why the scene is refused.
EMSCRIPTEN_KEEPALIVE OpenPage* fringe_open(const char* text, const char* folder) {
  auto open = std::make_unique<OpenPage>();
  try {
    open->page = std::make_unique<Page>(text, folder);
    open->answer = fringe::answers::json_text(open->page->description());
  } catch (const std::exception& error) {
    open->answer = fringe::answers::json_text({{"refused", error.what()}});
  }
  return open.release();
}

EMSCRIPTEN_KEEPALIVE const char* fringe_describe(const OpenPage* open) {
  return open->answer.c_str();
}

EMSCRIPTEN_KEEPALIVE void fringe_close(OpenPage* open) {
  const std::unique_ptr<OpenPage> closed(open);
}

/// Places a link by its translation (m) and its quaternion, of any nonzero length.
EMSCRIPTEN_KEEPALIVE const char* fringe_set_pose(OpenPage* open, int link, double x, double y, double z,
                                                 double qw, double qx, double qy, double qz) {
  return done(*open, [&](Page& page) {
    page.set_pose(static_cast<std::size_t>(link),
                  fringe::pose_from_quaternion({qw, qx, qy, qz}, Eigen::Vector3d(x, y, z)));
  });
}

EMSCRIPTEN_KEEPALIVE const char* fringe_set_joint(OpenPage* open, const char* joint, double position) {
  return done(*open, [&](Page& page) { page.set_joint(joint, position); });
}

EMSCRIPTEN_KEEPALIVE const char* fringe_set_floating(OpenPage* open, const char* object, int is_floating,
                                                     double to_ground) {
  return done(*open, [&](Page& page) { page.set_floating(object, is_floating != 0, to_ground); });
}

EMSCRIPTEN_KEEPALIVE const char* fringe_capacitance(OpenPage* open, const char* method, double rtol) {
  return answered(*open, [&](Page& page) { return page.capacitance(method, rtol); });
}

EMSCRIPTEN_KEEPALIVE const char* fringe_collisions(OpenPage* open) {
  return answered(*open, [](Page& page) { return page.collisions(); });
}

EMSCRIPTEN_KEEPALIVE const char* fringe_distances(OpenPage* open) {
  return answered(*open, [](Page& page) { return page.distances(); });
}

/// Returns where the poses of all links are, 12 doubles for each.
EMSCRIPTEN_KEEPALIVE const double* fringe_poses(OpenPage* open) {
  return open->page->poses().data();
}

/// Returns where the charges per area of all drawn triangles are, floats; null when they are refused.
EMSCRIPTEN_KEEPALIVE const float* fringe_densities(OpenPage* open, int sensor) {
  try {
    return open->page->densities(static_cast<std::size_t>(sensor)).data();
  } catch (const std::exception&) {
    return nullptr;
  }
}

}  // extern "C"
