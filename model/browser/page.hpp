#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "answers/answers.hpp"
#include "fringe/live_scene.hpp"
#include "fringe/triangle.hpp"

namespace fringe::browser {

/// A scene on a live page: what the page draws, moves and asks. Answers have the form of the command's JSON.
class Page {
 public:
  /// Reads the text of a scene file; mesh files are looked for in the folder.
  /// @throws InputError as parse_scene() does.
  Page(std::string_view text, std::string_view folder);

  /// Describes what the page needs once: links, sensors, distance sensors, objects with the triangles that
  /// are drawn of each (9 numbers in metres, in the frame of the link), readings and electrical roles.
  answers::Json description() const;

  /// Replaces a link's pose relative to its parent; links are given by their index.
  void set_pose(std::size_t link, const Eigen::Isometry3d& pose);

  /// Moves the link of a joint, in rad or m.
  void set_joint(std::string_view joint, double position);

  /// Makes an object grounded, floating ("floating") or connected to the ground by a capacitor, given in F.
  /// @throws InputError for an unknown object and for one that is neither grounded nor floating.
  void set_floating(std::string_view object, bool is_floating, double to_ground);

  /// Returns the poses of all links in the world: the rows of (R | t), 12 numbers for each link.
  const std::vector<double>& poses();

  /// Evaluates the scene by "exact", "formula", "reduced" or "boundary-elements". Only the last two take
  /// `rtol`, the relative error asked for; 0: the method's own.
  answers::Json capacitance(const std::string& method, double rtol);

  answers::Json collisions();
  answers::Json distances();

  /// Computes for each drawn triangle of the objects, in the order of the description, the charge per area
  /// that the model finds on it: ε·(∫dA/d)/A in C/m², summed over the plates of a sensor, for one volt on it.
  /// It is infinite where a triangle touches a plate, and is computed to a relative error of 1e-3.
  const std::vector<float>& densities(std::size_t sensor);

 private:
  /// The drawn triangles of an object or a sensor, in the frame of its link.
  struct Drawn {
    std::optional<std::size_t> link;
    std::vector<Triangle> triangles;
  };

  /// Where a sensor and an object stood when the densities on the object were computed.
  struct Placed {
    Eigen::Matrix4d object, sensor;
  };

  /// Applies an action to all copies of the scene.
  template <class Action>
  void for_each_copy(const Action& action);

  LiveScene live_;
  /// A copy for each method that was asked: a live scene keeps what it prepared for the last one only.
  std::map<std::string, LiveScene> copies_;
  std::vector<Drawn> objects_;
  std::vector<double> poses_;
  std::vector<float> densities_;
  std::optional<std::size_t> densities_of_;  ///< the sensor that they were computed for
  std::vector<Placed> placed_;               ///< for each object, with `densities_of_`
};

}  // namespace fringe::browser
