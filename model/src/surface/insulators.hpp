#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/scene.hpp"
#include "surface/bodies.hpp"

/// Dielectric bodies beside conductors (model/BOUNDARY_ELEMENTS.md, section 13).
namespace fringe::detail {

/// A dielectric body.
struct Insulator {
  std::string name;               ///< for messages
  std::vector<Triangle> surface;  ///< closed, in world coordinates
  Eigen::AlignedBox3d box;        ///< around `surface`
  double ratio;                   ///< its permittivity over the medium's
  bool is_target = false;
  std::optional<RoundShape> round = {};  ///< what the triangles stand for, unless they have it exactly
};

/// A dielectric layer so thin that only the potential along it matters, as a sheet: the face on which it lies
/// on conductors, or its middle.
struct ThinFilm {
  std::string name;             ///< for messages
  std::vector<Triangle> sheet;  ///< in world coordinates, with equal normals
  Eigen::AlignedBox3d box;      ///< around `sheet`
  double thickness;
  double ratio;   ///< its permittivity over the medium's
  double behind;  ///< thickness of the part of the layer behind the sheet
  bool is_target = false;
};

/// Conductors, whose surfaces are of triangles, and dielectric bodies. Of dielectric bodies that overlap, the
/// later one fills the common space; conductors displace all of them.
struct InsulatedBodies {
  ChargedBodies conductors;
  std::vector<Insulator> insulators;
  std::vector<ThinFilm> films = {};  ///< insulators as sheets; they touch conductors only
};

/// Returns true if a scene has a dielectric body.
bool has_insulators(const Scene& scene);

/// Returns a scene without its dielectric bodies and readings.
Scene without_insulators(const Scene& scene);

/// A dielectric body in the frame of the link that carries it.
struct LinkedInsulator {
  Insulator body;
  std::optional<std::size_t> link;
};

/// Returns the dielectric bodies of a scene in the frames of their links. Throws InputError for one whose
/// surface is not closed.
std::vector<LinkedInsulator> insulators_on_links(const Scene& scene);

/// Returns a dielectric body moved by a pose.
Insulator moved(const Insulator& insulator, const Eigen::Isometry3d& pose);

/// Returns the body of a dielectric surface as contact() takes it.
ChargedBody surface_of(const Insulator& insulator);

/// Throws InputError, with both names, if a conductor reaches into a sensor's cover: it is thicker than the
/// gap.
void refuse_thick_covers(const Scene& scene);

/// Returns the bodies of a scene in world coordinates. Throws InputError as charged_bodies() does, for a
/// dielectric body whose surface is not closed, and for a sensor's cover that a conductor reaches into.
InsulatedBodies insulated_bodies(const Scene& scene, bool with_readings = false);

/// Tells whether the panels of a dielectric body that stands apart follow its round shape.
bool follows_shape(const Insulator& insulator);

/// Returns the bodies with few triangles for round dielectric bodies whose boxes meet no others: their panels
/// follow the shape where they are divided, which says better where triangles are needed than their number of
/// segments.
InsulatedBodies with_few_facets(InsulatedBodies bodies);

/// Which bodies are there.
struct Presence {
  std::vector<bool> conductors;  ///< for each body of a conductor
  std::vector<bool> insulators;
  std::vector<bool> films = {};
};

Presence everything(const InsulatedBodies& bodies);
Presence without_targets(const InsulatedBodies& bodies);
Presence sensors_alone(const InsulatedBodies& bodies);

/// The relative permittivities behind a panel and before it, where its normal points to.
struct Ratios {
  double behind;
  double before;
  bool operator==(const Ratios&) const = default;
};

/// What a part of a surface is when some of the bodies are there.
enum class PartKind {
  conductor,  ///< it carries charge at a known potential
  interface,  ///< two dielectrics meet, at an unknown potential
  film,       ///< a thin film that lies on no conductor carries bound charge
  absent      ///< nothing
};

struct PartState {
  PartKind kind = PartKind::absent;
  Ratios ratios{1, 1};
  bool operator==(const PartState&) const = default;
};

/// Tells what parts of surfaces are. Bodies are numbered: those of conductors, then the dielectric ones, then
/// thin films.
class Surroundings {
 public:
  Surroundings(const InsulatedBodies& bodies, Presence presence);

  PartState state(const Triangle& part, std::size_t body) const;

  /// Tells whether the box around a body meets that of no other body. The panels of such a body may leave its
  /// triangles for the round shape that these stand for.
  bool is_apart(std::size_t body) const { return are_apart_[body]; }

  /// Returns the thin film that lies on a part of a conductor's surface, and whether it lies on the side to
  /// which the part's normal points.
  std::optional<std::pair<std::size_t, bool>> film_on(const Triangle& part) const;

  /// Returns the body of a conductor that has a point of a body in the box `own` on its surface.
  std::optional<std::size_t> conductor_at(const Eigen::Vector3d& point, const Eigen::AlignedBox3d& own) const;

  /// Returns true if one side of a part borders on the space outside of all bodies.
  bool is_outermost(const Triangle& part) const;

  /// Returns true if all corners of a dielectric body are inside conductors.
  bool is_inside_conductor(std::size_t insulator) const;

 private:
  struct Closed {
    const std::vector<Triangle>* surface;
    Eigen::AlignedBox3d box;
  };
  bool is_in_conductor(const Eigen::Vector3d& point) const;
  /// Returns the last dielectric body that contains a point; null: none does.
  const Insulator* insulator_at(const Eigen::Vector3d& point) const;
  bool is_outside(const Eigen::Vector3d& point) const;
  /// Returns the first body of a conductor near a point for which `touches` is true of its triangles and the
  /// distance below which a body in the box `own` touches it.
  template <class Touches>
  std::optional<std::size_t> conductor_near(const Eigen::Vector3d& point, const Eigen::AlignedBox3d& own,
                                            const Touches& touches) const;
  bool lies_on_conductor(const Triangle& part, const Eigen::AlignedBox3d& own) const;
  double ratio_at(const Eigen::Vector3d& point) const;

  const InsulatedBodies& bodies_;
  Presence presence_;
  std::vector<bool> are_apart_;
  std::vector<Closed> closed_;  ///< the conductors' closed surfaces that are there
};

/// Returns the bodies with wide thin layers, which touch nothing but conductors and those with one face only,
/// as films.
InsulatedBodies with_thin_films(InsulatedBodies bodies);

/// Returns the surface of every body in the order of Surroundings, divided where the surface of another body
/// meets it if one of both is dielectric: every part is either on or off the other surface, and inside or
/// outside it. Throws InputError where that takes too many parts.
std::vector<std::vector<Triangle>> divided_surfaces(const InsulatedBodies& bodies);

}  // namespace fringe::detail
