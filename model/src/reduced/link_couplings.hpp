#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "reduced/charge_functions.hpp"
#include "reduced/table_forces.hpp"

/// Potentials between the charge functions of two groups of bodies that move against each other
/// (model/CORRECTIONS.md, section 8, "Links that move").
namespace fringe::detail {

/// The potentials of each of two groups' charges on the functions of the other.
struct LinkCoupling {
  Eigen::Isometry3d relative;  ///< from the frame of the first group to that of the second
  Eigen::MatrixXf functions;   ///< of the first one's functions (columns) on the second one's (rows)
  /// Potentials of the first one's given charges (columns) on the second one's functions, and below these the
  /// energies of these charges with those that the second one carries for loads.
  Eigen::MatrixXf given_first;
  Eigen::MatrixXf given_second;  ///< the same of the second one's given charges and the first one
};

/// Returns the level of a function's points beside the other group's bodies, of which `to_other` is the
/// frame.
std::size_t level_beside(const ChargeFunctions& functions, std::size_t function,
                         const Eigen::Isometry3d& to_other, std::span<const Eigen::AlignedBox3d> others);

/// Tells whether a relative pose is the same up to rounding.
bool keep_relative_pose(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

/// Evaluates couplings, with arrays that are used again. Charges are points, the finer the nearer the other
/// group is. Points that are closer than their parts of the surface are large count as spheres of the parts'
/// own potential: surfaces of two links of one conductor may cross at a joint.
class LinkCoupler {
 public:
  /// Finds the potentials of the functions of one group (columns) on those of another (rows).
  /// @param relative from the frame of the rows' group to that of the columns'
  void couple(const ChargeFunctions& rows, const ChargeFunctions& columns, const Eigen::Isometry3d& relative,
              Eigen::MatrixXf& functions);

  /// Finds the forces on unit charges of the functions of one group, in the frame of the other, in the fields
  /// of charges on the other's functions: the derivatives of the potentials that couple() finds.
  /// @param relative from the frame of the group on which they act to that of the other
  /// @param charges of the other's functions (rows), for each field (column)
  void find_forces(const ChargeFunctions& on, const ChargeFunctions& of, const Eigen::Isometry3d& relative,
                   const Eigen::MatrixXf& charges, Forces& forces);

 private:
  void add_fields(std::size_t fields, Forces& forces);

  void place(const ChargeFunctions& functions, const Eigen::Isometry3d& to_other,
             std::span<const Eigen::AlignedBox3d> others);
  void gather(const ChargeFunctions& functions, float* of_functions) const;

  std::vector<std::size_t> levels_;  ///< of the placed functions
  std::vector<float> x_, y_, z_, shares_, limits_;
  std::size_t count_ = 0;
  std::vector<float> row_x_, row_y_, row_z_, inverse_distances_, potentials_;
  /// Up to one block of points on which forces act, with the functions that they are parts of.
  struct ForcePoint {
    Eigen::Vector3f at;
    Eigen::Index function;
    float share;
    float limit;  ///< largest 1/r; infinite where it is not limited, also not by the sources
  };
  std::vector<ForcePoint> force_points_;
  std::vector<float> field_charges_;             ///< of every placed point for all fields
  std::array<std::vector<float>, 3> gradients_;  ///< of 1/r, for some sources a block each
  std::vector<float> fields_;                    ///< a block for each component and field
  std::vector<float> sums_;
};

}  // namespace fringe::detail
