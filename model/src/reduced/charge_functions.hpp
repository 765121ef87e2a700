#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "bem/conductors_at_rest.hpp"

/// Charges that conductors at rest may carry, as combinations of some hundred functions
/// (model/CORRECTIONS.md, section 8).
namespace fringe::detail {

/// Coordinate of points that only fill a block, in m: 1/distance is negligible.
constexpr float padded_coordinate = 1e15F;

/// The charges of all functions as points, one function after the other.
struct FunctionPoints {
  std::vector<std::size_t> first;   ///< for each function its first point, and the end
  std::vector<Eigen::Vector3f> at;  ///< m
  std::vector<float> shares;        ///< charges at the points of a function with unit charge
  Eigen::MatrixXf given;            ///< the given charges at the points (rows)

  /// Returns the number of points of a function.
  std::size_t count(std::size_t function) const { return first[function + 1] - first[function]; }

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.first, self.at, self.shares, self.given);
  }
};

/// The charges of all functions on their panels, one function after the other.
struct FunctionPanels {
  std::vector<std::size_t> first;  ///< for each function its first panel, and the end
  std::vector<Triangle> corners;   ///< m
  std::vector<float> shares;       ///< charges of the panels of a function with unit charge
  Eigen::MatrixXf given;           ///< the given charges of the panels (rows)

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.first, self.corners, self.shares, self.given);
  }
};

/// Sums of neighbouring functions: the parts that were there when there were half as many.
struct CoarseFunctions {
  std::vector<Eigen::Index> of;  ///< for each function the sum that it belongs to
  Eigen::VectorXd shares;        ///< the charge of each function in a sum of unit charge
  Eigen::Index count = 0;

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.of, self.shares, self.count);
  }
};

/// Functions of unit charge on parts of the bodies' surfaces. Within a part they are proportional to the
/// charge of all conductors at one potential, which has the singularities of the edges.
class ChargeFunctions {
 public:
  /// Numbers of points of a function, the coarsest first. A function of a few panels may have up to four
  /// times as many, since all its panels get equally many.
  static constexpr std::array<std::size_t, 4> points_per_function{1, 4, 16, 64};
  /// The first level whose points give the given charges their dipole moments.
  static constexpr std::size_t first_with_moments = 1;

  /// A part of a surface while it is divided.
  struct Part {
    Eigen::AlignedBox3d box;  ///< around its panels
    double density;           ///< mean charge per area at unit potential
    double density_of_body;
  };

  /// Makes none, for an archive that has them.
  ChargeFunctions() = default;
  /// Divides the surfaces, the part of greatest `importance` first, until there are `most` parts.
  ///
  /// @param given charges of all panels (rows), which get points as the functions do
  ChargeFunctions(const ConductorsAtRest& conductors, const Eigen::MatrixXd& given,
                  const std::function<double(const Part&)>& importance, std::size_t most);

  std::size_t count() const { return centres_.size(); }
  const Eigen::Vector3d& centre(std::size_t function) const { return centres_[function]; }
  /// Returns the radius of a sphere about the centre that contains the part of the surface.
  double radius(std::size_t function) const { return radii_[function]; }
  std::size_t conductor(std::size_t function) const { return conductors_[function]; }
  const FunctionPoints& points(std::size_t level) const { return points_[level]; }
  const FunctionPanels& panels() const { return panels_; }
  /// Returns boxes around the bodies.
  const std::vector<Eigen::AlignedBox3d>& boxes() const { return boxes_; }

  /// Returns the single-layer matrix of the functions, in 1/m.
  const Eigen::MatrixXd& energies() const { return energies_; }
  const CoarseFunctions& coarse() const { return coarse_; }
  /// Returns the error (m) of an energy by the facets of round bodies, in first order, for the functions'
  /// charges of two loads.
  double facet_effect(const Eigen::Ref<const Eigen::VectorXf>& charges,
                      const Eigen::Ref<const Eigen::VectorXf>& others) const;
  /// Returns the largest error of a given charge's energy by the facets, relative to that energy.
  double facet_effect_of_given() const { return facet_effect_of_given_; }
  /// Returns the functions' net charges on each conductor (columns).
  Eigen::MatrixXd net(std::size_t conductors) const;

  /// Returns the level whose points resolve a function's charge beside other bodies.
  /// @param to_others the pose in the frame of the boxes around these
  std::size_t level(std::size_t function, const Eigen::Isometry3d& to_others,
                    std::span<const Eigen::AlignedBox3d> others) const;

  /// Calls a function with every point of all functions in a pose, the number of its function, the points of
  /// this one's level, and its place among them.
  /// @param level_of the level of a function
  template <typename Level, typename Visit>
  void visit_points(const Eigen::Isometry3d& pose, const Level& level_of, const Visit& visit) const {
    for (std::size_t function = 0; function < count(); ++function) {
      const FunctionPoints& points = points_[level_of(function)];
      for (std::size_t k = points.first[function]; k < points.first[function + 1]; ++k)
        visit(pose * points.at[k].cast<double>(), function, points, k);
    }
  }

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.centres_, self.radii_, self.conductors_, self.points_, self.panels_, self.boxes_,
            self.energies_, self.coarse_, self.facets_, self.facet_effect_of_given_);
  }

 private:
  void find_facets(const ConductorsAtRest& conductors, const Eigen::MatrixXd& given,
                   const std::vector<std::size_t>& order);
  void add_function(const PanelMesh& mesh, std::span<std::size_t> panels, std::size_t conductor,
                    const Eigen::VectorXd& weights, const Eigen::MatrixXd& given);

  std::vector<Eigen::Vector3d> centres_;
  std::vector<double> radii_;
  std::vector<std::size_t> conductors_;
  std::array<FunctionPoints, points_per_function.size()> points_;
  FunctionPanels panels_;
  std::array<std::vector<Eigen::VectorXd>, points_per_function.size()> given_;  ///< while it is made
  std::vector<Eigen::AlignedBox3d> boxes_;
  Eigen::MatrixXd energies_;
  CoarseFunctions coarse_;
  Eigen::VectorXf facets_;  ///< error of an energy (m) per squared charge, by facets
  double facet_effect_of_given_ = 0;
};

}  // namespace fringe::detail
