#pragma once

#include <Eigen/Geometry>

#include "io/table_reader.hpp"

namespace fringe::detail {

/// Reads a pose from `translation` and `rotation` or `quaternion`. What the table leaves out is as in
/// `otherwise`.
Eigen::Isometry3d read_pose(TableReader& table,
                            const Eigen::Isometry3d& otherwise = Eigen::Isometry3d::Identity());

}  // namespace fringe::detail
