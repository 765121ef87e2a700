#include "fringe/motion.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/joint.hpp"
#include "io/table_reader.hpp"

namespace fringe {
namespace {

using detail::Names;
using detail::TableReader;

/// Sets the poses of the links that a frame names, and notes the names.
void move_links(TableReader& frame, std::vector<Link>& links, Names& moved) {
  for (TableReader& table : frame.tables("poses")) {
    const std::string name = table.text("link");
    const auto link = std::ranges::find(links, name, &Link::name);
    if (link == links.end())
      table.fail("link", fmt::format("there is no link \"{}\"", name));
    if (!moved.insert(name).second)
      table.fail("link", fmt::format("\"{}\" has a pose in this frame already", name));
    link->pose = detail::read_pose(table, link->pose);
    table.finish();
  }
}

/// Sets the positions of the joints that a frame names, and the poses of the links that they move.
void move_joints(TableReader& frame, std::vector<Link>& links, Names& moved) {
  Names asked;
  for (TableReader& table : frame.tables("joints")) {
    const std::string name = table.text("joint");
    const auto moving =
        std::ranges::find_if(links, [&](const Link& link) { return link.joint && link.joint->name == name; });
    const bool shifts = moving != links.end() && moving->joint->kind == Joint::Kind::prismatic;
    const double position = shifts ? table.length("position") : table.number("position");
    if (!asked.insert(name).second)
      table.fail("joint", fmt::format("\"{}\" has a position in this frame already", name));
    std::vector<LinkPose> poses;
    try {
      poses = joint_poses(links, name, position);
    } catch (const InputError& error) {
      table.fail("joint", error.what());
    }
    for (const auto& [link, pose] : poses) {
      if (!moved.insert(links[link].name).second)
        frame.fail("joints", fmt::format("\"{}\" has a pose in this frame already", links[link].name));
      links[link].pose = pose;
    }
    moving->joint->position = position;
    table.finish();
  }
}

}  // namespace

std::vector<Frame> load_motion(const std::filesystem::path& path, const Scene& scene) {
  const toml::table document = detail::parse_document(path);
  TableReader root(document, path.string(), "");
  detail::require_known_format(root);
  detail::read_units(root);
  std::vector<Link> links = scene.links;
  std::vector<Frame> frames;
  for (TableReader& table : root.tables("frame")) {
    Frame frame{table.has("name") ? table.text("name") : fmt::format("frame {}", frames.size() + 1), {}};
    Names moved;
    move_links(table, links, moved);
    move_joints(table, links, moved);
    table.finish();
    for (const Link& link : links)
      frame.poses.push_back(link.pose);
    frames.push_back(std::move(frame));
  }
  root.finish();
  if (frames.empty())
    root.fail("frame", "a motion needs at least one frame");
  return frames;
}

std::size_t find_frame(const std::vector<Frame>& motion, const std::string& name_or_number) {
  const auto count = std::ranges::count(motion, name_or_number, &Frame::name);
  if (count == 1)
    return static_cast<std::size_t>(std::ranges::find(motion, name_or_number, &Frame::name) - motion.begin());
  if (count > 1)
    throw InputError(fmt::format("{} frames are named \"{}\": give a number from 1 to {}", count,
                                 name_or_number, motion.size()));
  std::size_t number = 0;
  const char* const end = name_or_number.data() + name_or_number.size();
  const auto [rest, failure] = std::from_chars(name_or_number.data(), end, number);
  if (failure != std::errc() || rest != end || number < 1 || number > motion.size())
    throw InputError(fmt::format("there is no frame \"{}\": give a name or a number from 1 to {}",
                                 name_or_number, motion.size()));
  return number - 1;
}

}  // namespace fringe
