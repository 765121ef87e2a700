#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "correction/charge_functions.hpp"

/// Potentials between the charge functions of two groups of bodies that move against each other
/// (model/CORRECTIONS.md, section 8, "Links that move").
namespace fringe::detail {

/// The potentials of each of two groups' charges on the functions of the other.
struct LinkCoupling {
  Eigen::Isometry3d relative;    ///< from the frame of the first group to that of the second
  Eigen::MatrixXf functions;     ///< of the first one's functions (columns) on the second one's (rows)
  Eigen::MatrixXf given_first;   ///< of the first one's given charges (columns) on the second one's functions
  Eigen::MatrixXf given_second;  ///< of the second one's given charges (columns) on the first one's functions
};

/// Evaluates couplings, with arrays that are used again. Charges are points, the finer the nearer the other
/// group is. Points that are closer than their parts of the surface are large count as spheres of the parts'
/// own potential: surfaces of two links of one conductor may cross at a joint.
class LinkCoupler {
 public:
  /// Evaluates the coupling of two groups in a pose.
  void couple(const ChargeFunctions& first, const ChargeFunctions& second, const Eigen::Isometry3d& relative,
              LinkCoupling& coupling);

 private:
  void place(const ChargeFunctions& functions, const Eigen::Isometry3d& to_other,
             std::span<const Eigen::AlignedBox3d> others);
  void gather(const ChargeFunctions& functions, float* of_functions) const;
  void sweep(const ChargeFunctions& rows, const ChargeFunctions& columns, const Eigen::Isometry3d& relative,
             Eigen::MatrixXf& functions, Eigen::MatrixXf& given);
  void limit(float row_limit, std::size_t rows);

  std::vector<std::size_t> levels_;  ///< of the placed functions
  std::vector<float> x_, y_, z_, shares_, limits_;
  std::vector<std::vector<float>> given_;
  std::size_t count_ = 0;
  std::vector<float> row_x_, row_y_, row_z_, inverse_distances_, potentials_;
  Eigen::MatrixXf transposed_;
};

}  // namespace fringe::detail
