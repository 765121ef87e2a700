#include "scene_module.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "answers/answers.hpp"
#include "conversion.hpp"
#include "fringe/conductors.hpp"
#include "fringe/error.hpp"
#include "fringe/evaluation.hpp"
#include "fringe/machine_potentials.hpp"
#include "fringe/motion.hpp"
#include "fringe/pose.hpp"
#include "fringe/reading.hpp"
#include "fringe/remarks.hpp"
#include "fringe/scene_info.hpp"
#include "fringe/scene_reader.hpp"
#include "fringe/surface_charges.hpp"
#include "readings.hpp"
#include "shared_scene.hpp"

namespace py = pybind11;

namespace fringe::python {
namespace {

using namespace fringe::answers;
using namespace pybind11::literals;

/// The options of the methods as keywords of Python.
struct Asked {
  std::optional<std::string> method = {};
  std::optional<double> rtol = {};
  bool entries = false;
  std::optional<double> max_seconds = {};
  bool derivatives = false;
  std::optional<std::filesystem::path> prepared = {};
  double tolerance = 0;
};

/// Reads the options. Throws InputError for those that are unknown or cannot be combined.
EvaluationOptions options_of(const Asked& asked) {
  EvaluationOptions options;
  if (asked.method)
    options = with_method(std::move(options), *asked.method);
  options.tolerance = asked.tolerance;
  options.rtol = asked.rtol;
  options.entries = asked.entries ? Entries::of_sensors : Entries::of_readings;
  options.max_seconds = asked.max_seconds;
  options.derivatives = asked.derivatives;
  options.prepared = asked.prepared;
  validate(options);
  return options;
}

/// Refuses keywords that the functions had before, and any others.
void refuse(const py::kwargs& others) {
  /// What to write now.
  static const std::map<std::string, std::string> former{
      {"correction", R"(method="formula", or "auto" for what was recommended)"},
      {"plates", R"(+nearest after the method, as in "exact+nearest")"},
      {"faces", R"(+facing after the method, as in "exact+facing")"},
      {"nearest", R"(+nearest after the method, as in "exact+nearest")"},
      {"facing", R"(+facing after the method, as in "exact+facing")"},
      {"only_readings", "nothing: readings are what is asked for, unless entries=True"},
  };
  for (const auto& [key, value] : others) {
    const auto name = key.cast<std::string>();
    const auto known = former.find(name);
    throw py::type_error(known != former.end() ? fmt::format("{} is gone: write {}", name, known->second)
                                               : fmt::format("there is no keyword \"{}\"", name));
  }
}

py::dict maxwell_of(SharedScene& shared, const std::string& method, std::optional<double> rtol,
                    std::optional<double> max_seconds) {
  EvaluationOptions options = options_of({.method = method, .rtol = rtol, .max_seconds = max_seconds});
  return python_object(shared.locked([&](LiveScene& live) {
    const auto start = std::chrono::steady_clock::now();
    const MaxwellMatrix& matrix = live.maxwell(options);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    return with_remarks(maxwell_answer(matrix, rtol_of(options), elapsed.count()),
                        shared.remarks_once("", [&] { return remarks(live.scene()); }));
  }));
}

py::dict capacitance_of(SharedScene& shared, const std::optional<std::string>& method,
                        std::optional<double> rtol, bool entries, std::optional<double> max_seconds,
                        bool derivatives, const std::optional<std::filesystem::path>& prepared,
                        double tolerance, const py::kwargs& others) {
  refuse(others);
  const EvaluationOptions options =
      options_of({method, rtol, entries, max_seconds, derivatives, prepared, tolerance});
  return python_object(shared.locked([&](LiveScene& live) {
    const auto start = std::chrono::steady_clock::now();
    const Evaluation& answer = live.evaluate(options);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    return with_remarks(
        capacitance_answer(answer, options, elapsed.count()),
        shared.remarks_once(answer.answered_by, [&] { return remarks(live.scene(), options, answer); }));
  }));
}

std::map<std::string, PythonReading> readings_of(SharedScene& scene, const std::string& method,
                                                 std::optional<double> rtol, bool entries,
                                                 std::optional<double> max_seconds, bool derivatives,
                                                 const std::optional<std::filesystem::path>& prepared,
                                                 const py::kwargs& others) {
  refuse(others);
  const EvaluationOptions options = options_of({method, rtol, entries, max_seconds, derivatives, prepared});
  return scene.locked([&](LiveScene& live) { return python_readings(live.readings(options)); });
}

/// Returns the pose in the 16 numbers of a (4, 4) matrix.
Eigen::Isometry3d pose_of(const double* numbers) {
  const Eigen::Matrix4d matrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>(numbers);
  if (matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
    throw InputError("the last row of a (4, 4) pose must be 0, 0, 0, 1");
  return pose_from_matrix(matrix.topLeftCorner<3, 3>(), matrix.topRightCorner<3, 1>());
}

/// Returns the frames of a motion: a file, or poses of all links, (frames, links, 4, 4).
std::vector<Frame> frames_of(const py::object& motion, const Scene& scene) {
  if (!py::isinstance<py::array>(motion) && !py::isinstance<py::list>(motion))
    return load_motion(motion.cast<std::filesystem::path>(), scene);
  const auto poses = motion.cast<Array>();
  const auto links = static_cast<py::ssize_t>(scene.links.size());
  if (poses.ndim() != 4 || poses.shape(1) != links || poses.shape(2) != 4 || poses.shape(3) != 4)
    throw InputError(fmt::format("poses must have shape (frames, {}, 4, 4), a pose for each link", links));
  std::vector<Frame> frames;
  for (py::ssize_t frame = 0; frame < poses.shape(0); ++frame) {
    Frame& entry = frames.emplace_back(Frame{fmt::format("{}", frame + 1), {}});
    for (py::ssize_t link = 0; link < links; ++link)
      entry.poses.push_back(pose_of(poses.data() + 16 * (frame * links + link)));
  }
  return frames;
}

MotionTable readings_of_motion(SharedScene& scene, const py::object& motion, const std::string& method,
                               std::optional<double> rtol, bool entries, std::optional<double> max_seconds,
                               const std::optional<std::filesystem::path>& prepared, std::size_t threads,
                               const py::kwargs& others) {
  refuse(others);
  const EvaluationOptions options = options_of(
      {.method = method, .rtol = rtol, .entries = entries, .max_seconds = max_seconds, .prepared = prepared});
  const Scene present = scene.locked([](const LiveScene& live) { return live.scene(); });
  const std::vector<Frame> frames = frames_of(motion, present);
  std::vector<std::string> names, of_readings;
  for (const Frame& frame : frames)
    names.push_back(frame.name);
  for (const Reading& reading : readings(present))
    of_readings.push_back(reading.name);
  const auto answers =
      scene.locked([&](LiveScene& live) { return live.readings_of(frames, options, threads); });
  // Where the time ended before the last frame, there are fewer answers.
  names.resize(answers.size());
  return motion_table(std::move(names), of_readings, answers);
}

/// Describes an answer by `describe`, a function of the scene, with the remarks on the scene.
template <typename Describe>
py::dict described_geometry(SharedScene& shared, const Describe& describe) {
  return python_object(shared.locked([&](LiveScene& live) {
    return with_remarks(describe(live), shared.remarks_once("", [&] { return remarks(live.scene()); }));
  }));
}

std::vector<std::string> remarks_of(SharedScene& scene) {
  return scene.locked([](LiveScene& live) { return remarks(live.scene()); });
}

py::dict surface_charges_of(SharedScene& scene, double rtol, std::size_t most_panels) {
  const SurfaceCharges found = scene.locked([&](const LiveScene& live) {
    return surface_charges(live.scene(), {rtol, most_panels, 0});
  });
  return py::dict("panels"_a = array_of(found.panels), "conductors"_a = found.conductors,
                  "conductor_of"_a = py::array_t<std::size_t>(
                      static_cast<py::ssize_t>(found.conductor_of.size()), found.conductor_of.data()),
                  "charges"_a = found.charges, "error"_a = found.error);
}

MachinePotentials machine_potentials_of(SharedScene& scene, double rtol, std::size_t most_panels,
                                        std::size_t functions) {
  return scene.locked([&](const LiveScene& live) {
    return MachinePotentials(live.scene(), {rtol, most_panels, functions, 0});
  });
}

TrianglePotentials potentials_at(const MachinePotentials& machine, const Array& positions) {
  const std::vector<Eigen::Vector3d> points = points_of(positions, "points");
  const py::gil_scoped_release unlocked;
  return machine.at(points);
}

Eigen::MatrixXf answers_about(const MachinePotentials& machine, const Array& positions) {
  const std::vector<Eigen::Vector3d> places = points_of(positions, "points");
  const py::gil_scoped_release unlocked;
  return machine.answers(places);
}

py::tuple changes_by(const MachinePotentials& machine, const Array& positions,
                     const Eigen::MatrixXd& potentials, const Array& rotations, const Array& translations,
                     const Eigen::MatrixXf& answers, std::optional<double> to_ground) {
  const MachinePotentials::Body body{points_of(positions, "points"), potentials};
  const std::vector<Eigen::Vector3d> origins = points_of(translations, "translations");
  if (rotations.ndim() != 3 || static_cast<std::size_t>(rotations.shape(0)) != origins.size() ||
      rotations.shape(1) != 3 || rotations.shape(2) != 3)
    throw InputError("rotations must have shape (n, 3, 3), as many as translations");
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t k = 0; k < origins.size(); ++k) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotations.data() + 9 * k);
    pose.translation() = origins[k];
    poses.push_back(pose);
  }
  const MachinePotentials::Changes changes = [&] {
    const py::gil_scoped_release unlocked;
    return machine.changes(body, poses, answers, to_ground);
  }();
  py::array_t<bool> clears(static_cast<py::ssize_t>(changes.clears.size()));
  std::copy(changes.clears.begin(), changes.clears.end(), clears.mutable_data());
  return py::make_tuple(changes.values, clears);
}

void add_machine_potentials(py::module_& module) {
  py::class_<MachinePotentials>(module, "MachinePotentials",
                                "A machine at rest as others feel it: the potentials of its readings at any "
                                "points, and how it answers "
                                "charges there. Scene.machine_potentials makes it.")
      .def_property_readonly(
          "readings",
          [](const MachinePotentials& machine) {
            py::list found;
            for (const MachinePotentials::OfReading& reading : machine.readings())
              found.append(py::make_tuple(reading.sense, reading.drive, reading.sign));
            return found;
          },
          "For each reading of the scene the columns of what it senses and drives, and the sign of its value "
          "when a "
          "grounded body comes near.")
      .def_property_readonly("error", &MachinePotentials::error,
                             "The largest stated error of the energies of what is sensed, driven or floats.")
      .def_property_readonly("panels", &MachinePotentials::panels, "The number of panels.")
      .def("at", &potentials_at, "points"_a,
           "The potentials (n, columns) at points (n, 3), in single precision, of 1 V on what is sensed or "
           "driven.")
      .def("answers", &answers_about, "places"_a,
           "Charges on the parts of the surface (parts, k) by which the machine answers charges about places "
           "(n, 3).")
      .def(
          "changes", &changes_by, "points"_a, "potentials"_a, "rotations"_a, "translations"_a, "answers"_a,
          "to_ground"_a = py::none(),
          R"(The changes of the readings by a body in poses, (n, readings) in m, to be multiplied by 4 pi epsilon; and whether it
is apart from the machine, (n,).

The body is a few points (p, 3) in its frame that stand for it, and the matrix (p, p) in 1/m that maps charges at them to
potentials with no one else there. rotations (n, 3, 3) and translations (n, 3) map its frame to the world; answers are
those about such places. The body is grounded, or else connected to ground through to_ground, over 4 pi epsilon in m.)");
}

py::dict sense_of(SharedScene& scene, const std::string& method) {
  const ConeMethod how = parse_cone_method(method);
  return described_geometry(scene, [&](LiveScene& live) { return sensing_answer(live.sense(how)); });
}

py::dict collide_of(SharedScene& shared) {
  std::shared_ptr<CollisionAnswers> answers = shared.collision_answers;
  Json description;
  std::vector<ObjectPair> pairs;
  std::uint64_t beginning = 0;
  const SceneCollision collision = shared.locked([&](LiveScene& live) {
    const SceneCollision& found = live.collide();
    beginning = shared.beginning();
    if (!answers || answers->beginning() != beginning) {
      description = with_remarks(collision_answer(found, live.scene()),
                                 shared.remarks_once("", [&] { return remarks(live.scene()); }));
      pairs = all_pairs(found, live.scene());
    }
    return found;
  });
  if (!description.is_null())
    shared.collision_answers = answers =
        std::make_shared<CollisionAnswers>(description, std::move(pairs), beginning);
  return answers->answer(collision);
}

py::dict conductors_of(SharedScene& scene) {
  const auto surfaces = [](const LiveScene& live) { return conductors(live.scene()); };
  py::dict result;
  for (const auto& [name, triangles] : scene.locked(surfaces))
    result[py::str(name)] = array_of(triangles);
  return result;
}

py::dict info_of(SharedScene& scene) {
  return described_geometry(
      scene, [](LiveScene& live) { return info_answer(scene_info(live.scene()), live.scene()); });
}

py::dict roles_of(SharedScene& scene) {
  return python_object(scene.locked([](LiveScene& live) { return scene_roles(live.scene()); }));
}

/// Returns the pose of a rotation, a matrix or a quaternion, and a translation.
Eigen::Isometry3d pose_of(const Eigen::Vector3d& translation, const Array& rotation) {
  if (rotation.ndim() == 2 && rotation.shape(0) == 3 && rotation.shape(1) == 3)
    return pose_from_matrix(Eigen::Matrix<double, 3, 3, Eigen::RowMajor>(rotation.data()), translation);
  if (rotation.ndim() != 1 || rotation.shape(0) != 4)
    throw InputError("rotation must be a matrix of shape (3, 3) or a quaternion (w, x, y, z) of shape (4,)");
  const double* wxyz = rotation.data();
  const Eigen::Quaterniond quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!quaternion.coeffs().allFinite() || !translation.allFinite())
    throw InputError("a pose must be finite");
  if (quaternion.coeffs().isZero(0))
    throw InputError("a quaternion must not be zero");
  return pose_from_quaternion(quaternion, translation);
}

/// Returns the link of this name. Throws InputError when there is none.
const Link& link_of(const Scene& scene, const std::string& name) {
  const auto link = std::ranges::find(scene.links, name, &Link::name);
  if (link == scene.links.end())
    throw InputError(fmt::format("there is no link \"{}\"", name));
  return *link;
}

void set_link_pose(SharedScene& scene, const std::string& link, const Array& translation,
                   const std::optional<Array>& rotation) {
  const bool is_pose = translation.ndim() == 2 && translation.shape(0) == 4 && translation.shape(1) == 4;
  if (is_pose && rotation)
    throw InputError("a (4, 4) pose has its rotation: leave `rotation` out");
  if (is_pose || rotation) {
    const Eigen::Isometry3d pose =
        is_pose ? pose_of(translation.data()) : pose_of(vector3(translation, "translation"), *rotation);
    scene.locked([&](LiveScene& live) { live.set_pose(link, pose); });
    return;
  }
  const Eigen::Vector3d shifted = vector3(translation, "translation");
  if (!shifted.allFinite())
    throw InputError("a pose must be finite");
  scene.locked([&](LiveScene& live) {
    Eigen::Isometry3d pose = link_of(live.scene(), link).pose;
    pose.translation() = shifted;
    live.set_pose(link, pose);
  });
}

Eigen::Matrix4d link_pose(SharedScene& scene, const std::string& link) {
  return scene.locked(
      [&](const LiveScene& live) { return Eigen::Matrix4d(link_of(live.scene(), link).pose.matrix()); });
}

/// Returns the names of a scene's links, sensors or objects.
template <auto elements>
std::vector<std::string> names_of(SharedScene& scene) {
  return scene.locked([](const LiveScene& live) {
    std::vector<std::string> names;
    for (const auto& element : live.scene().*elements)
      names.push_back(element.name);
    return names;
  });
}

std::vector<std::string> joint_names(SharedScene& scene) {
  return scene.locked([](const LiveScene& live) {
    std::vector<std::string> names;
    for (const Link& link : live.scene().links)
      if (link.joint)
        names.push_back(link.joint->name);
    return names;
  });
}

std::string representation(SharedScene& shared) {
  return shared.locked([](const LiveScene& live) {
    const Scene& scene = live.scene();
    return fmt::format("<fringe.Scene of {} links, {} sensors, {} objects, {} readings>", scene.links.size(),
                       scene.sensors.size(), scene.objects.size(), scene.readings.size());
  });
}

/// Returns what a pickle holds of a scene.
py::tuple pickled(SharedScene& scene) {
  const SharedScene::State state = scene.state();
  py::list poses;
  for (const Eigen::Isometry3d& pose : state.poses)
    poses.append(Eigen::Matrix4d(pose.matrix()));
  return py::make_tuple(state.text, state.folder.string(), state.hidden, poses);
}

std::unique_ptr<SharedScene> unpickled(const py::tuple& pickle) {
  SharedScene::State state{pickle[0].cast<std::string>(),
                           pickle[1].cast<std::string>(),
                           pickle[2].cast<std::set<std::string>>(),
                           {}};
  for (const py::handle pose : pickle[3])
    state.poses.emplace_back(pose.cast<Eigen::Matrix4d>());
  return SharedScene::from(state);
}

void set_joint_position(SharedScene& scene, const std::string& joint, double position) {
  scene.locked([&](LiveScene& live) { live.set_joint(joint, position); });
}

}  // namespace

void add_scene(py::module_& module) {
  module.def(
      "by_name",
      [](const py::list& entries) {
        py::dict result;
        for (const py::handle entry : entries)
          result[entry["name"]] = entry;
        return result;
      },
      "entries"_a,
      R"(The entries of a list of an answer by their names: fringe.by_name(answer["sensors"])["front"].)");

  add_readings(module);
  add_machine_potentials(module);
  py::class_<SharedScene>(module, "Scene", "A scene of links, sensors and objects (geometries/SCENE.md).")
      .def_static("load", &SharedScene::load, "path"_a, py::call_guard<py::gil_scoped_release>(),
                  "Reads a scene file and the mesh files it names. Raises InputError for a wrong one.")
      .def_static(
          "loads",
          [](const py::object& description, const std::filesystem::path& folder) {
            const std::string text = scene_text(description);
            const py::gil_scoped_release unlocked;
            return std::make_unique<SharedScene>(text, folder);
          },
          "description"_a, "folder"_a = ".",
          "Reads the text of a scene file, or a dictionary with its keys, as tomllib.loads makes it of such "
          "a "
          "text; mesh files are looked for in `folder`. Raises InputError for a wrong one.")
      .def_property_readonly("links", &names_of<&Scene::links>,
                             "Names of the links, in the order of the scene.")
      .def_property_readonly("joints", &joint_names, "Names of the joints, in the order of their links.")
      .def_property_readonly("sensors", &names_of<&Scene::sensors>, "Names of the sensors.")
      .def_property_readonly("objects", &names_of<&Scene::objects>, "Names of the objects.")
      .def(
          "pose", &link_pose, "link"_a,
          "The present pose of a link relative to its parent, (4, 4). Raises InputError for an unknown link.")
      .def("copy", &SharedScene::copy, "A scene of its own, in the same poses.")
      .def("__copy__", &SharedScene::copy)
      .def("__deepcopy__", [](SharedScene& scene, const py::dict& /*memo*/) { return scene.copy(); })
      .def(py::pickle(&pickled, &unpickled))
      .def(
          "hide", [](SharedScene& scene, const std::string& object) { scene.set_hidden(object, true); },
          "object"_a,
          R"(Hides an object: until show() all answers are as if it were not there.

`objects` does not name it then. Where it is the only target, the others count as targets of the readings. Raises
InputError for an unknown object, for an electrode, and when nothing would be left.)")
      .def(
          "show", [](SharedScene& scene, const std::string& object) { scene.set_hidden(object, false); },
          "object"_a, "Shows a hidden object again. Raises InputError for an unknown object.")
      .def(
          "add",
          [](SharedScene& scene, const py::object& description) { scene.add(scene_text(description)); },
          "description"_a,
          R"(Adds objects, or anything else that a scene file may contain, by its text or dictionary: `[[object]]` tables, or
{"object": [{…}]}, for example.

Links stay where they are. Raises InputError, with the scene as it was, for a text with which the scene would be wrong.)")
      .def("__repr__", &representation)
      .def("capacitance", &capacitance_of, "method"_a = py::none(), "rtol"_a = py::none(),
           "entries"_a = false, "max_seconds"_a = py::none(), "derivatives"_a = false,
           "prepared"_a = py::none(), "tolerance"_a = 0.0,
           R"(What every sensor feels, as the dictionary that `fringe capacitance --json` prints; F and V.

method: "exact", "split:N" or "gauss:K", as for plate_integral, each with "+nearest" (only the plate of a sensor that is
nearest to a point counts it) and "+facing" (only triangles whose outward side sees the plate count, and those in contact with
it; of the shape "plate" the side that faces) after it; or one of readings(). If not given, "auto" where rtol is given, else
"exact".
tolerance: what may be left out of a sensor's total, relative to it; each object's "bound" says how much of it was left
out at most. 0: nothing is left out but by "+nearest", 1e-12. Only with "exact".
The other options are those of readings().

Asked again with the same options, only what moved since is evaluated; "counts" says what that was.

Raises InputError (a ValueError) for unknown or inconsistent options and for objects that the method does not know.)")
      .def("readings", &readings_of, "method"_a = "auto", "rtol"_a = py::none(), "entries"_a = false,
           "max_seconds"_a = py::none(), "derivatives"_a = false, "prepared"_a = py::none(),
           R"(What the scene's readings measure in the present poses, {name: Reading}; F.

A scene without readings has one for every sensor, which senses and drives it. A reading's value is the charge on what it
senses per volt on what it drives, times -1 if it does not drive that, too; background is the same without the targets,
the objects that are marked as such, or all but electrodes; change is value - background.

method: "reduced", the reduced boundary element method, which prepares the scene once and then takes micro- to milliseconds
for each pose; "boundary-elements"; or "auto", the cheaper of these that states the accuracy asked for. "exact", "split:N",
"gauss:K" and "formula" know only the change of a reading that drives the sensor it senses, the sum over
the targets, and no error.
rtol: the largest relative error of value and change asked for, from 1e-6 to 0.5; if not given, 1e-2. Reading.reached says whether
it was reached; the errors are honest if not.
entries: whether each entry of the Maxwell matrix in the rows of sensors and electrodes is to be as accurate, too.
max_seconds: end after this time with the best answer so far; RuntimeError is raised where there is none.
derivatives: fill in Reading.derivatives, {link: (6,) array}, the derivatives of the change as the link moves with all
links that hang on it: in F/m along the axes of the world, then in F/rad about the axes of the world through the link's
origin. They are NaN in contact, and Reading.derivative_errors estimates their errors where the method knows them. Not with
"formula", "split:N" and "gauss:K".
prepared: a folder in which "reduced" and "auto" keep what takes long to prepare, and find it again for the same bodies,
readings, poses and accuracy, also in another process. The answers are the same, to the bit.

Raises InputError (a ValueError) for unknown or inconsistent options and for scenes that the method refuses.)")
      .def(
          "readings_of", &readings_of_motion, "motion"_a, "method"_a = "auto", "rtol"_a = py::none(),
          "entries"_a = false, "max_seconds"_a = py::none(), "prepared"_a = py::none(), "threads"_a = 0,
          R"(The readings in every frame of a motion, MotionReadings: a file, or an array (frames, links, 4, 4) of the links' poses
relative to their parents. Options as for readings(); max_seconds is for all frames together.

"reduced" prepares for all frames at once and answers them by all processors if threads is 0, with the same bits for any
number. Where max_seconds ends before the last frame, the frames answered by then are returned. A frame that the method
refuses, as boundary elements do in contact, has no numbers (NaN). The scene keeps its present poses. Raises InputError for a
file that cannot be used with the scene, and as readings() does if all frames are refused.)")
      .def("maxwell", &maxwell_of, "method"_a = "boundary-elements", "rtol"_a = py::none(),
           "max_seconds"_a = py::none(),
           R"(The Maxwell matrix of the sensors and objects in free space. F.

method: "boundary-elements", "reduced" or "auto", as for readings().
rtol: the error to be reached in every entry, relative to it (to 1e-3 of the geometric mean of its diagonal entries
where that is larger); from 1e-6 to 0.5, if not given 1e-2.

Returns "conductors" (names, the sensors first), "maxwell" and "error" (n, n): charge on the row's conductor per volt on
the column's, and an estimate of its error; "delta_self" by sensor, its own entry less what it is without the objects;
"lower_bounds", which entries of the diagonal are not above the truth; "floating", objects without charge and so without
a row; "reached", whether the errors are within rtol; "unknowns", "seconds"; "members", the sensor or the objects of each
conductor, and "charges", for each conductor the charges on its members (rows) per volt on each conductor.

Grounded objects that touch, overlap or contain each other are one conductor. "reduced" prepares them together, again
for every pose in which they have moved relative to each other, which takes seconds.

Raises InputError (a ValueError) for conductors that may have different potentials and touch, cross or are inside each
other, with "reduced" also for dielectric objects that touch several conductors or another link, and for bodies of more than
2,500 triangles, those that touch them included.)")
      .def(
          "sense", &sense_of, "method"_a = "field_of_view",
          R"(The closest point that every distance sensor sees, as the dictionary that `fringe sense --json` prints.

For each sensor "distance" (m), "point" (world frame), "object" and "triangle", the index into conductors()[object]; all
None when nothing is in its cone. Every object is seen, whatever it is made of and also on the sensor's own link.
method: as for cone_closest.)")
      .def("collide", &collide_of,
           R"(Which objects collide, as the dictionary that `fringe collide --json` prints.

Of each pair that can collide, "status" is "clear", "bounds" when only the bounding boxes meet, or "collision"; touching
counts. Left out are objects of the same link, those of a link and its parent (unless the former has
collides_with_parent = true) and those with collides = false. Asked again, only what moved since is
looked at; "tests" says how many bounding boxes ("broad") and convex shapes ("narrow") were tested.)")
      .def("conductors", &conductors_of,
           "Name to (n, 3, 3) triangles in the world frame, the sensors first, each in the file's order.")
      .def("set_pose", &set_link_pose, "link"_a, "translation"_a, "rotation"_a = py::none(),
           R"(Replaces a link's pose relative to its parent.

translation: (3,), m; or the whole pose, (4, 4), without `rotation`. rotation: a (3, 3) rotation matrix or a quaternion
(w, x, y, z) of any length but zero; if not given, it stays as it is. Raises InputError for an unknown link or a pose that
is none.)")
      .def(
          "set_joint", &set_joint_position, "joint"_a, "position"_a,
          "Moves the link of a joint, and the links of all joints that follow it, to a position in rad or m. "
          "Limits are not "
          "checked. Raises InputError for a joint that does not exist or follows another one.")
      .def(
          "surface_charges", &surface_charges_of, "rtol"_a = 1e-2, "most_panels"_a = 4000,
          R"(The charges on the surfaces of all conductors, by boundary elements: "panels" (n, 3, 3), triangles in m;
"conductors", sensors first, floating ones last; "conductor_of" (n,), the place of each panel's conductor among them;
"charges" (n, k), divided by 4 pi epsilon (m), a column for each conductor at 1 V and all others at 0; and "error", an
estimate of the relative error of the charges' energies. Panels are refined until it is at most rtol, or there are
most_panels.

With the weights w of the conductors, fringe.triangle_potentials(points, panels) @ (charges @ w) is the potential.)")
      .def(
          "machine_potentials", &machine_potentials_of, "rtol"_a = 2e-2, "most_panels"_a = 12000,
          "functions"_a = 600,
          R"(The scene as a machine at rest, a MachinePotentials: the charges of what its readings sense and drive, by
boundary elements as in surface_charges, and its surfaces divided into at most so many parts by which it answers a
charge outside.)")
      .def("roles", &roles_of,
           R"(What each object is to the readings, and what is measured, with the defaults filled in.

"objects" by name: "potential" ("grounded", "floating", "electrode", or "dielectric" with its "relative_permittivity"),
"conductor", "to_ground" (F, None if not connected through a capacitance) and "target". "readings" by name: "sense" and
"drive", names of sensors and of electrodes' conductors, "noise" and "threshold" (F or None).)")
      .def_property_readonly("remarks", &remarks_of,
                             R"(Remarks on the scene in its present poses, a list of sentences.

They are on what can be answered, but is probably not what was meant. Answers have those on the scene and on themselves
under "remarks"; they are looked for once for every method.)")
      .def("info", &info_of,
           "Counts, areas (m2), volumes (m3, None for open surfaces) and bounding boxes (m).");
}

}  // namespace fringe::python
