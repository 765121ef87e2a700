#include <unistd.h>

#include <sys/mman.h>

#include <array>
#include <cctype>
#include <string>

#include "fringe/error.hpp"
#include "fringe/scene_reader.hpp"
#include "fuzz_targets.hpp"
#include "io/mesh_formats.hpp"

namespace fringe::fuzz {
namespace {

void require_one_line(const InputError& error) {
  const std::string_view message = error.what();
  require(!message.empty() && message.size() < 20'000, "a message is not empty and can be read");
  for (const char letter : message)
    require(std::iscntrl(static_cast<unsigned char>(letter)) == 0, "a message is one line");
}

void require_sound(const Scene& scene) {
  require(!scene.sensors.empty() || !scene.objects.empty(), "a scene has a sensor or an object");
  for (const Link& link : scene.links)
    require(link.pose.matrix().allFinite(), "a link has a pose");
  for (const Object& object : scene.objects)
    require(object.pose.matrix().allFinite() && !object.name.empty() && object.conductor != "",
            "an object has a name and a pose, and so has its conductor a name");
  for (const Sensor& sensor : scene.sensors)
    require(!sensor.plates.empty() && !sensor.name.empty(), "a sensor has a name and plates");
  for (const Reading& reading : scene.readings)
    require(!reading.name.empty() && !reading.sense.empty() && !reading.drive.empty(),
            "a reading has a name, and senses and drives something");
}

/// A file in memory with the given bytes.
class MemoryFile {
 public:
  explicit MemoryFile(Bytes bytes) : descriptor_(memfd_create("scene", 0)) {
    require(descriptor_ >= 0, "a file can be made in memory");
    require(write(descriptor_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()),
            "a file in memory can be written");
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

 private:
  int descriptor_;
};

}  // namespace

void scene_reader(Bytes bytes) {
  const MemoryFile file(bytes);
  try {
    require_sound(load_scene(file.path()));
  } catch (const InputError& error) {
    require_one_line(error);
  }
}

void mesh_reader(Bytes bytes) {
  if (bytes.empty())
    return;
  using Reader = detail::MeshContent (*)(std::string_view);
  constexpr std::array<Reader, 3> readers{detail::read_stl, detail::read_obj, detail::read_ply};
  const std::string content(bytes.begin() + 1, bytes.end());
  try {
    for (const Triangle& triangle : readers[bytes[0] % readers.size()](content).triangles)
      for (const Eigen::Vector3d& vertex : triangle)
        require(vertex.allFinite(), "vertices are finite");
  } catch (const InputError& error) {
    require_one_line(error);
  }
}

}  // namespace fringe::fuzz
