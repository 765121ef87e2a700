#include "import/urdf_text.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pugixml.hpp>

#include "fringe/error.hpp"
#include "import/formats.hpp"
#include "io/input_file.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

bool is_number(const std::string& text) {
  std::string_view rest = text;
  try {
    detail::parse_number(detail::take_word(rest));
  } catch (const InputError&) {
    return false;
  }
  return detail::take_word(rest).empty();
}

void remove_children(pugi::xml_node element, const char* name) {
  while (element.remove_child(name)) {
  }
}

/// Simplifies one robot.
class Robot {
 public:
  Robot(const fs::path& path, pugi::xml_node robot, std::vector<std::string>& warnings)
      : path_(path), robot_(robot), warnings_(warnings) {}

  void simplify(const std::string& taken) {
    if (std::string_view(robot_.attribute("name").value()).empty()) {
      robot_.remove_attribute("name");
      robot_.append_attribute("name") = "robot";
      warn("robot", "has no name");
    }
    robot_.remove_attribute("version");
    remove_children(robot_, "material");
    for (const pugi::xml_node& child : robot_.children()) {
      const std::string_view name = child.name();
      if (name == "link")
        simplify_link(child, taken);
      else if (name == "joint")
        simplify_joint(child);
      if (name == "link" || name == "joint" || name.starts_with("xacro:"))
        require_expanded(child);
    }
    require_tree();
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw InputError(fmt::format("{}: {}", path_.string(), reason));
  }

  void warn(const std::string& what, const std::string& text) const {
    warnings_.push_back(fmt::format("{}: {}: {}", path_.string(), what, text));
  }

  static void simplify_link(pugi::xml_node link, const std::string& taken) {
    for (const char* name : {"inertial", "visual", "collision"})
      if (name != taken)
        remove_children(link, name);
    for (const pugi::xml_node& body : link.children(taken.c_str()))
      remove_children(body, "material");
  }

  void simplify_joint(pugi::xml_node joint) const {
    for (const char* name : {"dynamics", "safety_controller", "calibration"})
      remove_children(joint, name);
    const std::string what = fmt::format("joint \"{}\"", joint.attribute("name").value());
    if (const pugi::xml_node mimic = joint.child("mimic"); mimic && !mimic.attribute("joint")) {
      joint.remove_child(mimic);
      warn(what, "mimics no joint, and is one of its own");
    }
    const std::string_view type = joint.attribute("type").value();
    if (type != "revolute" && type != "prismatic") {
      remove_children(joint, "limit");
      return;
    }
    // The parser requires limits.
    pugi::xml_node limit = joint.child("limit");
    if (!limit)
      limit = joint.append_child("limit");
    for (const char* unneeded : {"effort", "velocity"}) {
      limit.remove_attribute(unneeded);
      limit.append_attribute(unneeded) = "0";
    }
    for (const char* end : {"lower", "upper"})
      if (const pugi::xml_attribute value = limit.attribute(end); value && !is_number(value.value())) {
        warn(what, fmt::format("its limits are left out: {} is no number", detail::quoted(value.value())));
        limit.remove_attribute("lower");
        limit.remove_attribute("upper");
      }
  }

  /// Throws InputError for what xacro replaces.
  void require_expanded(const pugi::xml_node& element) const {
    const auto refuse = [&](const std::string& what) {
      fail(fmt::format("{}: it is written in xacro and has to be expanded first: xacro {} > robot.urdf", what,
                       path_.filename().string()));
    };
    if (std::string_view(element.name()).starts_with("xacro:"))
      refuse(fmt::format("holds the element {}", element.name()));
    for (const pugi::xml_attribute& found : element.attributes())
      if (const std::string_view value = found.value();
          value.find("${") != std::string_view::npos || value.find("$(") != std::string_view::npos)
        refuse(fmt::format("holds {} = {}", found.name(), detail::quoted(value)));
    for (const pugi::xml_node& child : element.children())
      require_expanded(child);
  }

  /// Throws InputError for links with two parents and for links in a circle, of which the parser names none.
  void require_tree() const {
    std::map<std::string, std::pair<std::string, std::string>> parents;  // By child: parent and joint.
    for (const pugi::xml_node& joint : robot_.children("joint")) {
      const std::string name = joint.attribute("name").value(),
                        child = joint.child("child").attribute("link").value(),
                        parent = joint.child("parent").attribute("link").value();
      if (child.empty() || parent.empty())
        continue;  // The parser refuses it.
      const auto [known, is_new] = parents.emplace(child, std::pair(parent, name));
      if (!is_new)
        fail(fmt::format(
            R"(link "{}": has two parents, "{}" by joint "{}" and "{}" by joint "{}"; a robot is a tree of links)",
            child, known->second.first, known->second.second, parent, name));
    }
    std::set<std::string> rooted;
    for (const auto& [start, above] : parents) {
      std::vector<std::string> chain{start};
      std::set<std::string> passed{start};
      for (auto at = parents.find(start); at != parents.end() && !rooted.contains(at->first);
           at = parents.find(chain.back())) {
        chain.push_back(at->second.first);
        if (!passed.insert(chain.back()).second)
          fail(fmt::format(
              "the links \"{}\" are each other's parents, in a circle; a robot is a tree of links",
              fmt::join(std::find(chain.begin(), chain.end() - 1, chain.back()), chain.end() - 1, "\", \"")));
      }
      rooted.merge(passed);
    }
  }

  const fs::path& path_;
  pugi::xml_node robot_;
  std::vector<std::string>& warnings_;
};

}  // namespace

std::string simplified_urdf(const fs::path& path, const std::string& taken,
                            std::vector<std::string>& warnings) {
  std::string text;
  try {
    text = content_of(path);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.what()));
  }
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  const pugi::xml_node robot = document.child("robot");
  // The parser says what is wrong with the rest.
  if (!parsed || !robot)
    return text;
  Robot(path, robot, warnings).simplify(taken);
  std::ostringstream simplified;
  document.save(simplified, "", pugi::format_raw);
  return simplified.str();
}

}  // namespace fringe::cli
