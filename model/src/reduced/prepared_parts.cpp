#include "reduced/prepared_parts.hpp"

namespace fringe::detail {

std::string bytes_of_bodies(const ChargedBodies& bodies) {
  ArchiveWriter archive;
  archive(bodies.conductors.size());
  for (const ChargedConductor& conductor : bodies.conductors)
    archive(conductor.name, conductor.role, conductor.members, conductor.is_named, conductor.is_asked,
            conductor.to_ground);
  archive(bodies.bodies.size());
  for (const ChargedBody& body : bodies.bodies)
    archive(body.conductor, body.member, body.is_target, triangulated(body.surface).triangles);
  archive(bodies.are_entries_asked);
  return archive.bytes() + bytes_of_readings(bodies.readings);
}

}  // namespace fringe::detail
