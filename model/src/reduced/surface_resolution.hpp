#pragma once

#include <cstddef>

namespace fringe::detail {

/// How finely conductors are prepared.
struct SurfaceResolution {
  double rtol;              ///< stated error at which the refinement of their charges ends
  std::size_t most_panels;  ///< refinement ends there, too
  std::size_t functions;    ///< largest number of parts of their surfaces
  std::size_t least_panels = 0;
  std::size_t threads = 1;  ///< 0: as many as this process may run at once

  /// Describes what the charges depend on: they are the same for any number of threads.
  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.rtol, self.most_panels, self.functions, self.least_panels);
  }
};

}  // namespace fringe::detail
