#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/scene.hpp"
#include "surface/face.hpp"
#include "surface/round_shape.hpp"

/// The bodies of a scene as boundary elements see them, and the conductors that they belong to.
namespace fringe::detail {

/// Distance, relative to the size of two bodies, below which their surfaces touch: rounding of their poses.
constexpr double touching_surfaces = 1e-9;

/// A thin rectangular plate.
struct FlatPlate {
  ChargedFace face;
};

/// A rectangular box; its faces are in the order of faces_of_box().
struct BoxSurface {
  std::array<ChargedFace, box_faces> faces;
  Eigen::Vector3d half_sides;
};

/// A surface of triangles, closed or open.
struct TriangleSurface {
  std::vector<Triangle> triangles;
  std::optional<RoundShape> round = {};  ///< what the triangles stand for, unless they have it exactly
};

using BodySurface = std::variant<FlatPlate, BoxSurface, TriangleSurface>;

/// Returns a plate in z = 0 with its centre at the origin.
FlatPlate plate_at_origin(double half_u, double half_v);

/// Returns a box with its centre at the origin and its sides along the axes.
BoxSurface box_at_origin(const Eigen::Vector3d& half_sides);

/// A body of a conductor.
struct ChargedBody {
  std::size_t conductor;
  std::size_t member;   ///< which of the conductor's members it belongs to
  BodySurface surface;  ///< in world coordinates, or in the link's frame
  std::string name;     ///< for messages
  std::optional<std::size_t> link;
  bool is_target = false;  ///< whether readings compare with the scene without it
};

/// Returns the faces of a plate or a box; none of a surface of triangles.
std::span<const ChargedFace> faces_of(const BodySurface& surface);

/// Returns the triangles of a surface of triangles; none of a plate or a box.
std::span<const Triangle> triangles_of(const BodySurface& surface);

/// Returns the round shape that a surface stands for; nullptr if it has its body's exactly.
const RoundShape* round_shape_of(const BodySurface& surface);

/// What sets a conductor's potential. All but floating ones have a row in the Maxwell matrix.
enum class Role {
  sensor,     ///< driven and measured, and compared with itself without the objects
  electrode,  ///< an object that may be driven and measured
  grounded,
  floating,  ///< whatever makes its net charge vanish
};

struct ChargedConductor {
  std::string name;
  Role role;
  std::vector<std::string> members;  ///< the sensor or the objects that it consists of, by name
  bool is_named = false;             ///< whether its objects name it by their key `conductor`
  bool is_asked = true;              ///< whether the charges for its unit potential have to be accurate
  double to_ground = 0;  ///< m, capacitance between a floating conductor and the ground, divided by 4πε
};

/// A reading by the potentials of the conductors: what is sensed, with the sign of the reading, and what is
/// driven.
struct ChargedReading {
  std::string name;
  Eigen::VectorXd sense;
  Eigen::VectorXd drive;
};

/// The conductors of a scene: sensors first, then other ones in the order of their first objects, floating
/// ones last.
struct ChargedBodies {
  std::vector<ChargedConductor> conductors;
  std::vector<ChargedBody> bodies;
  /// The readings whose changes have to be accurate; none if the scene does not ask for changes.
  std::vector<ChargedReading> readings = {};
  bool are_entries_asked = true;  ///< whether more has to be accurate than the readings

  Role role(const ChargedBody& body) const { return conductors[body.conductor].role; }
};

/// Divides the faces of a plate or a box into triangles. Corners that differ only by rounding become one.
TriangleSurface triangulated(const BodySurface& surface);

/// Returns the number of conductors that have a role.
std::size_t count_of(const ChargedBodies& bodies, Role role);

/// Returns a mesh as boundary elements take it: corners that differ only by rounding become one, triangles
/// without area, slivers and duplicates are left out. Throws InputError with the name if nothing is left.
std::vector<Triangle> cleaned(const std::string& name, std::span<const Triangle> triangles);

/// Returns the triangles of an object in its own frame; those of a mesh are cleaned.
std::vector<Triangle> surface_triangles(const Object& object);

/// Returns the surface of an object in its own frame, as surface_triangles() does, with its round shape.
TriangleSurface surface_of(const Object& object);

/// Returns true if a sensor's plate is divided into triangles.
bool sensors_have_panels(const ChargedBodies& bodies);

/// Returns the bodies in the frames of their links. Objects with the same key `conductor` are members of one
/// conductor. Throws InputError for a dielectric object, for an invalid rectangle or size, for meshes without
/// area, for a conductor whose objects differ in potential, and if all conductors are floating. Triangles
/// without area, slivers and duplicates are left out.
ChargedBodies bodies_on_links(const Scene& scene);

/// Returns the aligned box around a body.
Eigen::AlignedBox3d bounds_of(const ChargedBody& body);

/// Throws InputError for a body, in a box in world coordinates, that is so far from the origin that rounding
/// changes its shape.
void refuse_rounding(const std::string& name, const Eigen::AlignedBox3d& box);

/// Returns the body moved by a pose. Throws InputError if the pose is not finite.
ChargedBody moved(const ChargedBody& body, const Eigen::Isometry3d& pose);

/// Returns the bodies in world coordinates, joined where they touch, with the readings if the scene asks for
/// changes or `with_readings` does. Throws InputError as bodies_on_links and joined do.
ChargedBodies charged_bodies(const Scene& scene, bool with_readings = false);

}  // namespace fringe::detail
