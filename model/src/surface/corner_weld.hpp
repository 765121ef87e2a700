#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

#include <Eigen/Core>

namespace fringe::detail {

/// Merges corners that are nearer to each other than a distance: each becomes the first of them. Corners that
/// have no others near stay as they are.
class CornerWeld {
 public:
  explicit CornerWeld(double distance) : distance_(distance) {}

  /// Returns the number of the corner that this one becomes.
  std::size_t add(const Eigen::Vector3d& corner) {
    // Corners whose coordinates differ by rounding may fall into cells beside each other.
    const Cell cell = cell_of(corner);
    for (long x = -1; x <= 1; ++x)
      for (long y = -1; y <= 1; ++y)
        for (long z = -1; z <= 1; ++z)
          if (const auto here = cells_.find({cell[0] + x, cell[1] + y, cell[2] + z}); here != cells_.end())
            for (const std::size_t known : here->second)
              if ((corners_[known] - corner).norm() <= distance_)
                return known;
    cells_[cell].push_back(corners_.size());
    corners_.push_back(corner);
    return corners_.size() - 1;
  }

  /// Returns the corners that are left.
  const std::vector<Eigen::Vector3d>& corners() const { return corners_; }

 private:
  using Cell = std::array<long, 3>;

  Cell cell_of(const Eigen::Vector3d& corner) const {
    Cell cell;
    for (std::size_t axis = 0; axis < 3; ++axis)
      cell[axis] = std::lround(corner[static_cast<Eigen::Index>(axis)] / (2 * distance_));
    return cell;
  }

  double distance_;
  std::vector<Eigen::Vector3d> corners_;
  std::map<Cell, std::vector<std::size_t>> cells_;
};

}  // namespace fringe::detail
