#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/pose.hpp"
#include "fringe/progress.hpp"
#include "io/prepared_files.hpp"
#include "reduced/surrounded.hpp"
#include "scenes.hpp"
#include "temporary_folder.hpp"

/// Tests that preparations of readings with the conductors around them are kept in a folder and found again.
namespace fringe::FRINGE_TEST_FILE {
namespace {

namespace fs = std::filesystem;

using test::at;

constexpr double rtol = 0.5;

/// A sensor before a housing, a hand, and an arm that may turn against both.
Scene machine() {
  Scene scene = test::hand_before_housing(0.09);
  scene.links.push_back({"arm", {}, at(0.2, 0, 0)});
  scene.objects.push_back(test::on_link(1, test::object("arm", Cuboid{0.06, 0.06, 0.1}, at(0, 0, 0))));
  return scene;
}

/// The hand comes nearer; the arm turns, too, if that is asked for.
std::vector<Frame> motion(bool turns) {
  std::vector<Frame> frames;
  for (int k = 0; k < 2; ++k)
    frames.push_back(
        {std::to_string(k),
         {at(0, 0, 0.1 - 0.04 * k), pose_from_axis({0, 1, 0}, turns ? 5.0 * k : 0, {0.2, 0, 0})}});
  return frames;
}

class PreparedDataTest : public test::TemporaryFolder, public testing::WithParamInterface<bool> {
 protected:
  /// Answers anew, and counts what is shown of panels that are refined.
  std::vector<std::vector<ReadingAnswer>> answers(const Scene& scene,
                                                  const std::optional<fs::path>& prepared) {
    test::Surrounded live(scene);
    if (prepared)
      live.keep_in(std::make_shared<const detail::PreparedFiles>(*prepared));
    solutions = 0;
    const ProgressScope progress(
        [&](const std::string& text) { solutions += text.find(" panels, error ") != std::string::npos; });
    return live.answers_of(motion(GetParam()), rtol, 1);
  }

  std::map<std::string, fs::file_time_type> files() const {
    std::map<std::string, fs::file_time_type> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(kept_in))
      found[entry.path().filename().string()] = entry.last_write_time();
    return found;
  }

  const fs::path kept_in = folder() / "prepared data";
  int solutions = 0;
};

void expect_same_bits(const std::vector<std::vector<ReadingAnswer>>& found,
                      const std::vector<std::vector<ReadingAnswer>>& known) {
  ASSERT_EQ(found.size(), known.size());
  for (std::size_t frame = 0; frame < known.size(); ++frame) {
    EXPECT_EQ(found[frame][0].change.value, known[frame][0].change.value);
    EXPECT_EQ(found[frame][0].change.error, known[frame][0].change.error);
  }
}

TEST_P(PreparedDataTest, AreReadByASecondRunWithTheSameBitsUnlessAFileIsDamagedOrTheSceneAnother) {
  const auto known = answers(machine(), std::nullopt);
  EXPECT_GT(solutions, 0);
  const auto expect_known = [&](bool prepared_again) {
    expect_same_bits(answers(machine(), kept_in), known);
    EXPECT_EQ(solutions > 0, prepared_again);
  };
  expect_known(true);
  const auto kept = files();
  EXPECT_EQ(kept.size(), 3U);  // machine, targets and tables, or two links and targets
  expect_known(false);
  EXPECT_EQ(files(), kept);
  for (const auto& [name, time] : kept) {
    fs::resize_file(kept_in / name, fs::file_size(kept_in / name) / 2);
    fs::last_write_time(kept_in / name, time);
  }
  expect_known(true);
  expect_known(false);
  EXPECT_EQ(files().size(), kept.size());
  // Machine and target have changed: what is kept of either would give other answers.
  Scene changed = machine();
  changed.objects[0].shape = Cuboid{0.2, 0.12, 0.04};
  changed.objects[1].shape = Cuboid{0.05, 0.08, 0.02};
  expect_same_bits(answers(changed, kept_in), answers(changed, std::nullopt));
}

INSTANTIATE_TEST_SUITE_P(AtRestAndMoving, PreparedDataTest, testing::Bool());

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
