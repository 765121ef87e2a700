#include "import/formats.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "import/panel_statement.hpp"
#include "io/input_file.hpp"
#include "unique_names.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

/// Largest number of panels.
constexpr std::size_t most_panels = 10'000'000;

/// Largest number of included files: files that include each other can multiply without end.
constexpr std::size_t most_files = 100'000;

/// Largest depth to which files include each other.
constexpr std::size_t most_open = 100;

/// A line of a file, for messages.
struct Place {
  std::shared_ptr<const std::string> file;  ///< common to the lines, of which there may be millions
  std::size_t line;

  std::string text() const { return fmt::format("{}:{}", *file, line); }
};

[[noreturn]] void fail(const Place& place, const std::string& reason) {
  throw InputError(fmt::format("{}: {}", place.text(), reason));
}

/// The statements of a file or of a file within a file, without comments.
using Section = std::vector<std::pair<Place, PanelStatement>>;

/// The sections of a file: its own, without a name, and those of the files within it.
using File = std::map<std::string, Section>;

/// Returns the text of a file. Throws InputError with its name.
std::string text_of(const fs::path& path) {
  try {
    return detail::plain_text(content_of(path));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

/// Returns whether a text begins as neutral files of PATRAN do, with the packet 25, their title, or 26.
bool seems_to_be_patran(std::string_view text) {
  const std::string_view packet = detail::take_word(text);
  return packet == "25" || packet == "26";
}

File read_file(const fs::path& path) {
  File file;
  // Between the files in a file, where anything may stand, there is no section.
  Section* section = &file[""];
  const std::string content = text_of(path);
  std::string_view rest = content;
  Place place{std::make_shared<const std::string>(path.string()), 0};
  while (!rest.empty()) {
    const std::string_view line = detail::take_line(rest);
    ++place.line;
    PanelStatement statement;
    try {
      statement = parse_panel_statement(line, place.line == 1);
    } catch (const InputError& error) {
      if (section != nullptr && seems_to_be_patran(content))
        fail(place, "the file seems to be a neutral file of PATRAN, which is not read");
      if (section != nullptr)
        fail(place, error.what());
    }
    if (const auto* end = std::get_if<EndOfFile>(&statement)) {
      if (end->next && file.contains(*end->next))
        fail(place, fmt::format("begins the file {} again", detail::quoted(*end->next)));
      section = end->next ? &file[*end->next] : nullptr;
    } else if (section != nullptr && !std::holds_alternative<Comment>(statement)) {
      section->emplace_back(place, std::move(statement));
    }
  }
  return file;
}

/// A conductor, and the group of files that it is from, as FastCap names it.
struct ListedConductor {
  std::string name;
  std::string group;
  std::vector<Triangle> triangles;
};

class ListReader {
 public:
  explicit ListReader(std::vector<std::string>& warnings) : warnings_(warnings) {}

  void read(const fs::path& path) {
    folder_ = path.parent_path();
    read_section({path, ""}, "", Eigen::Vector3d::Zero());
  }

  /// Returns the conductors with panels. Those of one name in several groups have the group in their names.
  std::vector<ListedConductor> conductors() const;

  /// Returns the relative permittivity around the conductors.
  double permittivity() const { return medium_ ? medium_->second : 1; }

 private:
  /// A file, and the name of the file within it; empty for the file itself.
  using SectionName = std::pair<fs::path, std::string>;

  const File& file(const fs::path& path) {
    const auto known = files_.find(path);
    return known != files_.end() ? known->second : files_.emplace(path, read_file(path)).first->second;
  }

  SectionName find(const Place& place, const std::string& name, const fs::path& from);
  void read_section(const SectionName& section, const std::string& group, const Eigen::Vector3d& offset);
  void include(const Place& place, const IncludedConductor& statement, const fs::path& from,
               const std::string& group, const Eigen::Vector3d& offset);
  ListedConductor& conductor(const std::string& name, const std::string& group);
  void rename(const Place& place, const Renamed& statement, const std::string& group);
  void require_one_medium(const Place& place, double permittivity);
  void warn(const Place& place, const std::string& text);

  std::vector<std::string>& warnings_;
  std::set<std::string> warned_;
  fs::path folder_;  ///< of the list: names of files are relative to it
  std::map<fs::path, File> files_;
  std::vector<SectionName> open_;  ///< those being read
  std::vector<ListedConductor> conductors_;
  /// Indices of the conductors by group and name; renamed ones have several.
  std::map<std::pair<std::string, std::string>, std::size_t> indices_;
  std::optional<std::pair<Place, double>> medium_;
  std::size_t panels_ = 0;
  std::size_t included_ = 0;
};

/// Returns what a file name in the file `from` means: a file within that file, or else a file in the folder.
ListReader::SectionName ListReader::find(const Place& place, const std::string& name, const fs::path& from) {
  SectionName found{from, name};
  if (file(from).contains(name))
    return found;
  found = {folder_ / name, ""};
  if (!detail::is_file(found.first))
    fail(place, fmt::format("the file {} does not exist", found.first.string()));
  return found;
}

/// Reads the statements of a section, moved by an offset. Its panels belong to a group of conductors.
void ListReader::read_section(const SectionName& section, const std::string& group,
                              const Eigen::Vector3d& offset) {
  open_.push_back(section);
  std::size_t number = 1;
  std::optional<std::string> given;
  for (const auto& [place, statement] : file(section.first).at(section.second)) {
    if (const auto* panel = std::get_if<Panel>(&statement)) {
      if (++panels_ > most_panels)
        fail(place, fmt::format("there are more than {} panels", most_panels));
      // Panels of the list itself are in a vacuum.
      if (group.empty())
        require_one_medium(place, 1);
      std::vector<Triangle>& triangles = conductor(panel->conductor, group).triangles;
      for (Triangle triangle : panel->triangles) {
        for (Eigen::Vector3d& corner : triangle)
          corner += offset;
        triangles.push_back(triangle);
      }
    } else if (const auto* included = std::get_if<IncludedConductor>(&statement)) {
      const std::string outer = group.empty() ? "GROUP" : group + "_";
      include(place, *included, section.first, given.value_or(fmt::format("{}{}", outer, number)), offset);
      if (!included->continues) {
        ++number;
        given.reset();
      }
    } else if (std::holds_alternative<DielectricInterface>(statement)) {
      warn(place, "a dielectric interface is left out, as if the medium of the conductors were everywhere");
      ++number;
      given.reset();
    } else if (const auto* name = std::get_if<GroupName>(&statement)) {
      given = name->name;
    } else if (const auto* renamed = std::get_if<Renamed>(&statement)) {
      rename(place, *renamed, group);
    }
  }
  open_.pop_back();
}

void ListReader::include(const Place& place, const IncludedConductor& statement, const fs::path& from,
                         const std::string& group, const Eigen::Vector3d& offset) {
  require_one_medium(place, statement.outer_permittivity);
  if (statement.is_interface)
    warn(place, "the dielectric interface on which a conductor lies is left out, as if its outer medium were "
                "everywhere");
  if (++included_ > most_files)
    fail(place, fmt::format("there are more than {} included files", most_files));
  const SectionName section = find(place, statement.file, from);
  if (std::find(open_.begin(), open_.end(), section) != open_.end())
    fail(place, fmt::format("the file {} includes itself", statement.file));
  if (open_.size() > most_open)
    fail(place, fmt::format("files include each other to a depth of more than {}", most_open));
  read_section(section, group, offset + statement.offset);
}

/// Returns a conductor of a group, which is added if it is new.
ListedConductor& ListReader::conductor(const std::string& name, const std::string& group) {
  const auto [found, is_new] = indices_.emplace(std::pair(group, name), conductors_.size());
  if (is_new)
    conductors_.push_back({name, group, {}});
  return conductors_[found->second];
}

/// Gives a conductor another name; if a conductor has it already, the two become one.
void ListReader::rename(const Place& place, const Renamed& statement, const std::string& group) {
  const auto known = indices_.find({group, statement.from});
  if (known == indices_.end())
    fail(place, fmt::format("there is no conductor {} to be renamed", detail::quoted(statement.from)));
  const std::size_t from = known->second;
  const auto [target, is_new] = indices_.emplace(std::pair(group, statement.to), from);
  const std::size_t to = target->second;
  if (is_new)
    conductors_[from].name = statement.to;
  if (from == to)
    return;
  std::vector<Triangle>& all = conductors_[to].triangles;
  all.insert(all.end(), conductors_[from].triangles.begin(), conductors_[from].triangles.end());
  conductors_[from].triangles.clear();
  for (auto& [name, index] : indices_)
    if (index == from)
      index = to;
}

void ListReader::require_one_medium(const Place& place, double permittivity) {
  if (!medium_)
    medium_.emplace(place, permittivity);
  if (medium_->second != permittivity)
    fail(place,
         fmt::format("the conductor is in a medium of permittivity {}, that of {} in one of {}; a scene "
                     "has one medium",
                     permittivity, medium_->first.text(), medium_->second));
}

/// Warns once of a line, however often its file is included.
void ListReader::warn(const Place& place, const std::string& text) {
  std::string warning = fmt::format("{}: {}", place.text(), text);
  if (warned_.insert(warning).second)
    warnings_.push_back(std::move(warning));
}

std::vector<ListedConductor> ListReader::conductors() const {
  std::map<std::string, std::size_t> counts;
  std::vector<ListedConductor> result;
  for (const ListedConductor& conductor : conductors_)
    if (!conductor.triangles.empty()) {
      ++counts[conductor.name];
      result.push_back(conductor);
    }
  for (ListedConductor& conductor : result)
    if (counts[conductor.name] > 1 && !conductor.group.empty())
      conductor.name += '%' + conductor.group;
  return result;
}

}  // namespace

Scene read_panel_list(const fs::path& path, std::vector<std::string>& warnings) {
  ListReader reader(warnings);
  reader.read(path);
  Scene scene;
  scene.medium.relative_permittivity = reader.permittivity();
  UniqueNames names;
  for (ListedConductor& conductor : reader.conductors())
    scene.objects.push_back({names.take(conductor.name), std::nullopt,
                             Mesh{{}, 1, std::move(conductor.triangles)}, Eigen::Isometry3d::Identity(),
                             Electrode{}});
  if (scene.objects.empty())
    throw InputError(fmt::format("{}: holds no panels of conductors", path.string()));
  return scene;
}

}  // namespace fringe::cli
