#include "vtu_file.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "fringe/conductors.hpp"
#include "fringe/error.hpp"
#include "fringe/triangulation.hpp"
#include "whole_files.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

/// Number of triangles evaluated together: each one is temporarily an object of about a kilobyte.
constexpr std::size_t triangles_at_once = 4096;

/// For each sensor the contributions of all triangles (F).
using Contributions = std::vector<std::vector<double>>;

/// Appends the contributions of an object's triangles. Each triangle is evaluated as an object of its own, so
/// that every option has the same meaning as for the whole scene.
void add_contributions(const Scene& scene, const Object& object, EvaluationOptions options,
                       Contributions& contributions) {
  options.faces = rule_for(object.shape, options.faces);
  const std::vector<Triangle> triangles = triangulate(object.shape);
  Scene part{scene.medium, scene.has_room, scene.links, scene.sensors, {}, {}};
  for (std::size_t first = 0; first < triangles.size(); first += triangles_at_once) {
    part.objects.clear();
    for (std::size_t i = first; i < std::min(first + triangles_at_once, triangles.size()); ++i)
      part.objects.push_back(
          {object.name, object.link, Mesh{{}, 1, {triangles[i]}}, object.pose, object.role, false});
    const SceneCapacitance answer = capacitance(part, options);
    for (std::size_t sensor = 0; sensor < contributions.size(); ++sensor)
      for (const ObjectCapacitance& single : answer.sensors[sensor].objects)
        contributions[sensor].push_back(single.capacitance);
  }
}

/// Escapes text for an XML attribute; characters that XML does not allow become question marks.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char letter : text)
    if (letter == '&' || letter == '<' || letter == '"')
      result += fmt::format("&#{};", static_cast<int>(letter));
    else
      result += static_cast<unsigned char>(letter) < 0x20 ? '?' : letter;
  return result;
}

/// The data arrays of a file: XML elements that refer to the bytes appended at the end.
class Arrays {
 public:
  /// Appends an array and returns its XML element; `type` contains the attributes that describe the numbers.
  template <typename Number>
  std::string add(const std::string& type, const std::string& name, const std::vector<Number>& numbers) {
    std::string text = fmt::format("<DataArray {} Name=\"{}\" format=\"appended\" offset=\"{}\"/>\n", type,
                                   escaped(name), bytes_.size());
    const std::uint64_t size = numbers.size() * sizeof(Number);
    bytes_.append(reinterpret_cast<const char*>(&size), sizeof size);
    bytes_.append(reinterpret_cast<const char*>(numbers.data()), size);
    return text;
  }

  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace

void write_vtu(const Scene& scene, const EvaluationOptions& options, const fs::path& target) {
  if (options.tolerance > 0)
    throw InputError(
        "--output cannot be combined with a tolerance, which does not evaluate single triangles");
  std::vector<double> points;
  std::vector<std::int32_t> bodies;
  for (const Conductor& conductor : conductors(scene)) {
    const std::int32_t body = bodies.empty() ? 1 : bodies.back() + 1;
    bodies.insert(bodies.end(), conductor.triangles.size(), body);
    for (const Triangle& triangle : conductor.triangles)
      for (const Eigen::Vector3d& vertex : triangle)
        points.insert(points.end(), vertex.begin(), vertex.end());
  }
  std::size_t sensor_triangles = 0;
  for (const Sensor& sensor : scene.sensors)
    sensor_triangles += 2 * sensor.plates.size();
  Contributions contributions(scene.sensors.size(), std::vector<double>(sensor_triangles));
  for (const Object& object : scene.objects)
    add_contributions(scene, object, options, contributions);

  const std::size_t count = bodies.size();
  std::vector<std::int64_t> corners(3 * count), ends(count);
  std::iota(corners.begin(), corners.end(), 0);
  for (std::size_t i = 0; i < count; ++i)
    ends[i] = static_cast<std::int64_t>(3 * (i + 1));
  constexpr std::uint8_t vtk_triangle = 5;

  Arrays arrays;
  std::string head = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" "
      "header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
      std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian", 3 * count, count);
  head += "<Points>\n" + arrays.add(R"(type="Float64" NumberOfComponents="3")", "Points", points) +
          "</Points>\n<Cells>\n";
  head += arrays.add(R"(type="Int64")", "connectivity", corners);
  head += arrays.add(R"(type="Int64")", "offsets", ends);
  head += arrays.add(R"(type="UInt8")", "types", std::vector<std::uint8_t>(count, vtk_triangle));
  head += "</Cells>\n<CellData>\n" + arrays.add(R"(type="Int32")", "body", bodies);
  for (std::size_t sensor = 0; sensor < contributions.size(); ++sensor)
    head +=
        arrays.add(R"(type="Float64")", "capacitance " + scene.sensors[sensor].name, contributions[sensor]);
  head += "</CellData>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
  write_whole({{target, head + arrays.bytes() + "\n</AppendedData>\n</VTKFile>\n"}});
}

}  // namespace fringe::cli
