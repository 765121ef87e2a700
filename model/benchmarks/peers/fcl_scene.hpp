#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "peer.hpp"

namespace fringe::benchmarks {

/// Moving objects in FCL's dynamic tree of axis-aligned boxes, with FCL's solver for pairs.
class FclScene {
 public:
  explicit FclScene(const PeerShapes& shapes);
  ~FclScene();
  FclScene(const FclScene&) = delete;
  FclScene& operator=(const FclScene&) = delete;

  /// Moves all objects and counts the pairs that collide.
  std::size_t collide(const std::vector<Eigen::Isometry3d>& poses);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace fringe::benchmarks
