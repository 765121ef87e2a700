#include "import/formats.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "fringe/error.hpp"
#include "import/archive.hpp"
#include "import/link_tree.hpp"
#include "io/input_file.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

/// Returns the part of a name behind the prefix of its namespace.
std::string_view local(std::string_view name) {
  return name.substr(name.find(':') + 1);
}

/// Returns the attribute of a name, whatever the prefix of its namespace.
std::string_view attribute(const pugi::xml_node& node, std::string_view name) {
  for (const pugi::xml_attribute& found : node.attributes())
    if (local(found.name()) == name)
      return found.value();
  return "";
}

/// Returns the first child of a name, whatever the prefix of its namespace.
pugi::xml_node child(const pugi::xml_node& node, std::string_view name) {
  return node.find_child([&](const pugi::xml_node& found) { return local(found.name()) == name; });
}

double number(const pugi::xml_node& node, std::string_view name) {
  return detail::parse_number(attribute(node, name));
}

/// Returns the length of a model's unit in metres.
double unit_of(const pugi::xml_node& model) {
  constexpr std::array<std::pair<std::string_view, double>, 7> units{{{"", 1e-3},
                                                                      {"micron", 1e-6},
                                                                      {"millimeter", 1e-3},
                                                                      {"centimeter", 1e-2},
                                                                      {"inch", 0.0254},
                                                                      {"foot", 0.3048},
                                                                      {"meter", 1}}};
  const std::string_view name = attribute(model, "unit");
  for (const auto& [known, length] : units)
    if (name == known)
      return length;
  throw InputError(fmt::format("has the unit \"{}\", which is none of 3MF", name));
}

/// Throws InputError if a model needs an extension of the format that changes its shape.
void require_known_extensions(const pugi::xml_node& model) {
  std::string_view needed = attribute(model, "requiredextensions");
  for (std::string_view prefix = detail::take_word(needed); !prefix.empty();
       prefix = detail::take_word(needed)) {
    const std::string_view name = model.attribute(fmt::format("xmlns:{}", prefix).c_str()).value();
    const bool is_known = name.find("/production/") != std::string_view::npos ||
                          name.find("/material/") != std::string_view::npos;
    if (!is_known)
      throw InputError(fmt::format("needs the extension {} ({}), which is not read", prefix, name));
  }
}

/// One model of the archive.
struct Model {
  std::string path;
  pugi::xml_document document;
  double unit = 0;                                             ///< m
  std::map<std::string, pugi::xml_node, std::less<>> objects;  ///< by their numbers
};

/// Reads one file.
class ThreeMfReader {
 public:
  ThreeMfReader(const fs::path& path, std::string content, std::vector<std::string>& warnings)
      : path_(path), warnings_(warnings), archive_(std::move(content)) {}

  Scene read() {
    const Model& model = model_at(path_of_model());
    const std::size_t root = tree_.add_link(path_.stem().string(), std::nullopt, {});
    for (const pugi::xml_node& item : child(model.document.document_element(), "build").children())
      if (local(item.name()) == "item")
        add_placed(item, model, root, 0);
    return tree_.take();
  }

 private:
  /// Returns the path of the model with which the archive begins.
  std::string path_of_model() const {
    if (const std::optional<std::string> relations = archive_.content("_rels/.rels")) {
      pugi::xml_document document;
      document.load_buffer(relations->data(), relations->size());
      for (const pugi::xml_node& relation : document.document_element().children())
        if (attribute(relation, "Type").ends_with("/3dmodel"))
          return std::string(attribute(relation, "Target"));
    }
    return "3D/3dmodel.model";
  }

  const Model& model_at(const std::string& path) {
    const auto [found, is_new] = models_.try_emplace(path);
    Model& model = found->second;
    if (!is_new)
      return model;
    const std::optional<std::string> content = archive_.content(path);
    if (!content)
      throw InputError(fmt::format("holds no model {}", path));
    const pugi::xml_parse_result parsed = model.document.load_buffer(content->data(), content->size());
    if (!parsed)
      throw InputError(fmt::format("{}: is damaged XML: {}", path, parsed.description()));
    const pugi::xml_node element = model.document.document_element();
    model.path = path;
    model.unit = unit_of(element);
    require_known_extensions(element);
    for (const pugi::xml_node& object : child(element, "resources").children())
      if (local(object.name()) == "object")
        model.objects.emplace(attribute(object, "id"), object);
    return model;
  }

  /// Adds the link of an item or a component, a placed object.
  void add_placed(const pugi::xml_node& placed, const Model& in, std::size_t parent, std::size_t depth) {
    const std::string path(attribute(placed, "path")), number(attribute(placed, "objectid"));
    const Model& model = path.empty() ? in : model_at(path);
    const auto found = model.objects.find(number);
    if (found == model.objects.end())
      throw InputError(fmt::format("object {}: does not exist in {}", number, model.path));
    const pugi::xml_node object = found->second;
    const std::string_view given = attribute(object, "name"), type = attribute(object, "type");
    const std::string name = given.empty() ? fmt::format("object {}", number) : std::string(given);
    if (depth > deepest)
      throw InputError(fmt::format("object \"{}\": is below more than {} others", name, deepest));
    if (++links_ > most_links)
      throw InputError(fmt::format("object \"{}\": there are more than {} parts", name, most_links));
    if (type == "support" || type == "solidsupport" || type == "other") {
      warn(
          fmt::format("object \"{}\": is of the type {}, no part of the model, and is left out", name, type));
      return;
    }
    try {
      const std::size_t link = tree_.add_link(name, parent, split(place_of(placed, in.unit)));
      tree_.add_object(tree_.name_of(link), link, triangles_of(child(object, "mesh"), model.unit, name));
      for (const pugi::xml_node& component : child(object, "components").children())
        if (local(component.name()) == "component")
          add_placed(component, model, link, depth + 1);
    } catch (const InputError& error) {
      if (std::string_view(error.what()).starts_with("object "))
        throw;
      throw InputError(fmt::format("object \"{}\": {}", name, error.what()));
    }
  }

  /// Reads the pose of an item or a component, twelve numbers: the images of the axes, then the place.
  static Eigen::Affine3d place_of(const pugi::xml_node& placed, double unit) {
    Eigen::Affine3d place = Eigen::Affine3d::Identity();
    std::string_view numbers = attribute(placed, "transform");
    if (numbers.empty())
      return place;
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 3; ++row)
        place.matrix()(row, column) = detail::parse_number(detail::take_word(numbers));
    place.translation() *= unit;
    return place;
  }

  std::vector<Triangle> triangles_of(const pugi::xml_node& mesh, double unit, const std::string& name) {
    std::vector<Eigen::Vector3d> vertices;
    for (const pugi::xml_node& vertex : child(mesh, "vertices").children())
      if (local(vertex.name()) == "vertex")
        vertices.emplace_back(unit * number(vertex, "x"), unit * number(vertex, "y"),
                              unit * number(vertex, "z"));
    std::vector<Triangle> triangles;
    for (const pugi::xml_node& triangle : child(mesh, "triangles").children()) {
      if (local(triangle.name()) != "triangle")
        continue;
      const auto corner = [&](const char* key) -> const Eigen::Vector3d& {
        const std::int64_t index = detail::parse_integer(attribute(triangle, key));
        if (index < 0 || index >= static_cast<std::int64_t>(vertices.size()))
          throw InputError(
              fmt::format("triangle {} names vertex {} of {}", triangles.size(), index, vertices.size()));
        return vertices[static_cast<std::size_t>(index)];
      };
      triangles.push_back({corner("v1"), corner("v2"), corner("v3")});
    }
    if (child(mesh, "beamlattice"))
      warn(fmt::format("object \"{}\": its lattice of beams is left out", name));
    return triangles;
  }

  void warn(const std::string& text) {
    std::string warning = fmt::format("{}: {}", path_.string(), text);
    if (warned_.insert(warning).second)
      warnings_.push_back(std::move(warning));
  }

  /// Limit of nesting, far above that of any model; objects are read recursively, which takes space on the
  /// stack.
  static constexpr std::size_t deepest = 1000;

  /// Limit of parts: components that hold each other can multiply without end.
  static constexpr std::size_t most_links = 10'000;

  const fs::path& path_;
  std::vector<std::string>& warnings_;
  std::size_t links_ = 0;
  std::set<std::string> warned_;  ///< an object may stand in several places
  Archive archive_;
  std::map<std::string, Model> models_;
  LinkTree tree_;
};

}  // namespace

Scene read_three_mf(const fs::path& path, std::string content, std::vector<std::string>& warnings) {
  return ThreeMfReader(path, std::move(content), warnings).read();
}

}  // namespace fringe::cli
