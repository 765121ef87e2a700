#pragma once

#include <optional>
#include <string>

namespace fringe {

/// A capacitance and how far off it may be. What a method does not know is empty.
struct Estimate {
  std::optional<double> value = {};  ///< F
  std::optional<double> error = {};  ///< F, an estimate of the error of the value
  std::optional<double> lower = {};  ///< F, a bound that is proven
  std::optional<double> upper = {};  ///< F, a bound that is proven
};

/// The answer of a reading: the charge on the conductor that it senses, per volt on those that it drives;
/// times −1 if it does not drive the one that it senses.
struct ReadingAnswer {
  std::string name;
  Estimate value;
  Estimate background;           ///< the value without the targets
  Estimate change;               ///< value − background; errors common to both cancel
  std::string answered_by = {};  ///< the method; "formula" for the correction of that name
};

}  // namespace fringe
