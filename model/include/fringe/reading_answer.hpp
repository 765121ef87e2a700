#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace fringe {

/// A capacitance and how far off it may be. What a method does not know is empty.
struct Estimate {
  std::optional<double> value = {};  ///< F
  std::optional<double> error = {};  ///< F, an estimate of the error of the value
  std::optional<double> lower = {};  ///< F, a bound that is proven
  std::optional<double> upper = {};  ///< F, a bound that is proven
};

/// The six derivatives with respect to a link's pose: in F/m along the axes of the world, then in F/rad about
/// the axes of the world through the link's origin.
using PoseDerivatives = Eigen::Matrix<double, 6, 1>;

/// How the change of a reading alters as a link moves, and with it all links that hang on it, as
/// LiveScene::set_pose moves them. A joint's own derivative is the product of its axis in the world and the
/// derivatives along it (prismatic) or about it (revolute).
struct LinkDerivatives {
  std::string link;
  PoseDerivatives change;                ///< NaN where they are not known: in contact
  std::optional<PoseDerivatives> error;  ///< an estimate; none by the methods that integrate over triangles
};

/// The answer of a reading: the charge on the conductor that it senses, per volt on those that it drives;
/// times −1 if it does not drive the one that it senses.
struct ReadingAnswer {
  std::string name;
  Estimate value;
  Estimate background;           ///< the value without the targets
  Estimate change;               ///< value − background; errors common to both cancel
  std::string answered_by = {};  ///< the method that found the change
  /// Tells whether all readings of the answer reached the accuracy asked for: relative to the values, and to
  /// the changes or 1e-5 of the values, whichever is more, since electronics resolve no less. None for
  /// methods that state no errors, and where there is no answer.
  std::optional<bool> reached = {};
  /// In the order of the links; empty unless they were asked for, and where the change is not known.
  std::vector<LinkDerivatives> derivatives = {};
};

}  // namespace fringe
