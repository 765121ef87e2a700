#include "shared_scene.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/scene_reader.hpp"

namespace fringe::python {

SharedScene::SharedScene(std::string text, const std::filesystem::path& folder, Scene scene)
    : text_(std::move(text)), folder_(std::filesystem::absolute(folder)), whole_(std::move(scene)),
      live_(whole_) {}

SharedScene::SharedScene(const std::string& text, const std::filesystem::path& folder)
    : SharedScene(text, folder, parse_scene(text, folder)) {}

std::unique_ptr<SharedScene> SharedScene::load(const std::filesystem::path& path) {
  // Messages of this reader name the file.
  Scene scene = load_scene(path);
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  return std::unique_ptr<SharedScene>(
      new SharedScene(std::move(text), std::filesystem::absolute(path).parent_path(), std::move(scene)));
}

SharedScene::State SharedScene::state() {
  return locked([&](const LiveScene& live) {
    State state{text_, folder_, hidden_, {}};
    for (const Link& link : live.scene().links)
      state.poses.push_back(link.pose);
    return state;
  });
}

std::unique_ptr<SharedScene> SharedScene::from(const State& state) {
  auto scene = std::make_unique<SharedScene>(state.text, state.folder);
  scene->begin_again(scene->whole_, state.hidden);
  scene->live_.set_poses(state.poses);
  return scene;
}

std::unique_ptr<SharedScene> SharedScene::copy() {
  return locked([&](const LiveScene& live) {
    std::unique_ptr<SharedScene> scene(new SharedScene(text_, folder_, whole_));
    scene->hidden_ = hidden_;
    scene->live_ = LiveScene(live.scene());
    return scene;
  });
}

/// Begins a live scene of what is not hidden, with the links that are known where they are.
void SharedScene::begin_again(Scene whole, const std::set<std::string>& hidden) {
  Scene shown = whole;
  const std::vector<Link>& links = live_.scene().links;
  for (std::size_t k = 0; k < links.size(); ++k)
    shown.links[k].pose = links[k].pose;
  std::erase_if(shown.objects, [&](const Object& object) { return hidden.contains(object.name); });
  if (shown.sensors.empty() && shown.objects.empty())
    throw InputError("a scene needs at least one sensor or object that is not hidden");
  live_ = LiveScene(std::move(shown));
  remarks_.clear();
  ++beginning_;
  whole_ = std::move(whole);
  hidden_ = hidden;
}

void SharedScene::set_hidden(const std::string& object, bool is_hidden) {
  locked([&](const LiveScene& /*live*/) {
    const auto known = std::ranges::find(whole_.objects, object, &Object::name);
    if (known == whole_.objects.end())
      throw InputError(fmt::format("there is no object \"{}\"", object));
    if (is_hidden && std::holds_alternative<Electrode>(known->role))
      throw InputError(fmt::format("object \"{}\" is an electrode, which readings need", object));
    std::set<std::string> hidden = hidden_;
    if (is_hidden ? hidden.insert(object).second : hidden.erase(object) > 0)
      begin_again(whole_, hidden);
  });
}

void SharedScene::add(const std::string& text) {
  locked([&](const LiveScene& /*live*/) {
    std::string longer = text_ + "\n" + text;
    begin_again(parse_scene(longer, folder_), hidden_);
    text_ = std::move(longer);
  });
}

}  // namespace fringe::python
