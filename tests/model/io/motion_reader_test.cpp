#include "fringe/motion.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/scene_reader.hpp"
#include "scenes.hpp"
#include "temporary_folder.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;

class MotionReader : public test::TemporaryFolder {
 protected:
  Scene scene(std::string_view links) const {
    return load_scene(write("scene.toml", std::string(links) +
                                              "[[object]]\nname = \"ball\"\n"
                                              "shape = { type = \"sphere\", radius = 0.1 }\n"));
  }

  std::vector<Frame> read(std::string_view text, const Scene& scene) const {
    return load_motion(write("scene.motion.toml", text), scene);
  }

  std::string error_of(std::string_view text) const {
    return test::refusal_of([&] { read(text, scene(jointed)); });
  }

  static constexpr auto jointed = R"([[link]]
name = "arm"
translation = [0, 0, 1]
joint = { name = "lift", type = "prismatic", axis = [0, 0, 2], position = 0.25 }
[[link]]
name = "hand"
joint = { name = "wrist", type = "prismatic", axis = [1, 0, 0], mimic = { joint = "lift", multiplier = -2, offset = 1 } }
[[link]]
name = "finger"
joint = { name = "knuckle", type = "prismatic", axis = [0, 1, 0] }
)";
};

TEST_F(MotionReader, MovesTheLinksThatAFrameNamesAndLeavesTheOthers) {
  const Scene base = scene(R"([[link]]
name = "base"
[[link]]
name = "arm"
parent = "base"
translation = [0, 0, 1]
rotation = { axis = [0, 0, 1], degrees = 30 }
)");
  const std::vector<Frame> frames = read(R"([[frame]]
name = "rest"
[[frame]]
name = "up"
poses = [ { link = "arm", translation = [0, 0, 2] } ]
[[frame]]
poses = [ { link = "arm", rotation = { axis = [1, 0, 0], degrees = 5 } },
          { link = "base", quaternion = [0, 1, 0, 0] } ]
)",
                                         base);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].name, "rest");
  EXPECT_EQ(frames[2].name, "frame 3");
  const Eigen::Isometry3d& rest = base.links[1].pose;
  EXPECT_EQ(frames[0].poses[1].matrix(), rest.matrix());
  EXPECT_EQ(frames[1].poses[1].linear(), rest.linear());
  EXPECT_EQ(frames[1].poses[1].translation(), Vector3d(0, 0, 2));
  EXPECT_EQ(frames[2].poses[1].matrix(), pose_from_axis(Vector3d::UnitX(), 5, Vector3d(0, 0, 2)).matrix());
  EXPECT_EQ(frames[2].poses[0].linear(), Eigen::Matrix3d(Vector3d(1, -1, -1).asDiagonal()));
}

TEST_F(MotionReader, MovesJointsByTheirNamesAndThoseThatFollow) {
  const std::vector<Frame> frames = read(R"([[frame]]
[[frame]]
joints = [ { joint = "lift", position = 0.5 } ]
[[frame]]
joints = [ { joint = "knuckle", position = 2 } ]
[[frame]]
poses = [ { link = "arm", translation = [7, 7, 7] } ]
[[frame]]
joints = [ { joint = "lift", position = 0 } ]
)",
                                         scene(jointed));
  const auto places = [&](std::size_t frame) {
    return std::vector<Vector3d>{frames[frame].poses[0].translation(), frames[frame].poses[1].translation(),
                                 frames[frame].poses[2].translation()};
  };
  ASSERT_EQ(frames.size(), 5U);
  EXPECT_THAT(places(0), ElementsAre(Vector3d(0, 0, 1.25), Vector3d(0.5, 0, 0), Vector3d(0, 0, 0)));
  EXPECT_THAT(places(1), ElementsAre(Vector3d(0, 0, 1.5), Vector3d(0, 0, 0), Vector3d(0, 0, 0)));
  EXPECT_THAT(places(2), ElementsAre(Vector3d(0, 0, 1.5), Vector3d(0, 0, 0), Vector3d(0, 2, 0)));
  EXPECT_THAT(places(3), ElementsAre(Vector3d(7, 7, 7), Vector3d(0, 0, 0), Vector3d(0, 2, 0)));
  EXPECT_THAT(places(4), ElementsAre(Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(0, 2, 0)));
}

TEST_F(MotionReader, SaysWhatIsWrongAndWhere) {
  const auto frame = [](const std::string& contents) { return "[[frame]]\n" + contents + "\n"; };
  EXPECT_THAT(error_of(frame(R"(joints = [ { joint = "hip", position = 1 } ])")),
              HasSubstr("scene.motion.toml:2: frame[0].joints[0].joint: there is no joint \"hip\"; there "
                        "are: lift, knuckle"));
  EXPECT_THAT(error_of(frame(R"(joints = [ { joint = "wrist", position = 1 } ])")),
              HasSubstr("frame[0].joints[0].joint: joint \"wrist\" follows \"lift\""));
  EXPECT_THAT(
      error_of(frame(R"(joints = [ { joint = "lift", position = 1 }, { joint = "lift", position = 2 } ])")),
      HasSubstr("frame[0].joints[1].joint: \"lift\" has a position in this frame already"));
  EXPECT_THAT(error_of(frame("poses = [ { link = \"hand\" } ]\n"
                             "joints = [ { joint = \"lift\", position = 1 } ]")),
              HasSubstr("frame[0].joints: \"hand\" has a pose in this frame already"));
  EXPECT_THAT(error_of(frame(R"(poses = [ { link = "leg" } ])")),
              HasSubstr("frame[0].poses[0].link: there is no link \"leg\""));
  EXPECT_THAT(error_of(frame(R"(poses = [ { link = "arm" }, { link = "arm" } ])")),
              HasSubstr("frame[0].poses[1].link: \"arm\" has a pose in this frame already"));
  EXPECT_THAT(error_of(frame(R"(poses = [ { link = "arm", turn = 3 } ])")),
              HasSubstr("frame[0].poses[0].turn: is not a known key"));
  EXPECT_THAT(error_of(frame("speed = 1")), HasSubstr("frame[0].speed: is not a known key"));
  EXPECT_THAT(error_of("format = 2\n[[frame]]\n"), HasSubstr("format: is 2, and this program knows 1 only"));
  EXPECT_THAT(error_of("format = 1\n"), HasSubstr("frame: a motion needs at least one frame"));
  EXPECT_THAT(error_of("[[frame"), HasSubstr("scene.motion.toml:1: "));
}

TEST_F(MotionReader, ReadsLengthsInUnitsOfItsOwn) {
  constexpr auto frame = R"([[frame]]
poses = [ { link = "arm", translation = [0, 0, 400] } ]
joints = [ { joint = "knuckle", position = 20 } ]
)";
  const Scene base = scene(jointed);
  const std::vector<Frame> in_metres = read(frame, base);
  const std::vector<Frame> in_millimetres = read("units = \"mm\"\n" + std::string(frame), base);
  EXPECT_EQ(in_metres[0].poses[0].translation(), Vector3d(0, 0, 400));
  EXPECT_EQ(in_metres[0].poses[2].translation(), Vector3d(0, 20, 0));
  EXPECT_EQ(in_millimetres[0].poses[0].translation(), Vector3d(0, 0, 0.4));
  EXPECT_EQ(in_millimetres[0].poses[2].translation(), Vector3d(0, 0.02, 0));
  EXPECT_THAT(error_of("units = \"inch\"\n" + std::string(frame)),
              HasSubstr("units: must be \"m\" or \"mm\""));
}

TEST_F(MotionReader, FindsAFrameByItsNameElseByItsNumber) {
  const std::vector<Frame> motion{{"near", {}}, {"3", {}}, {"twice", {}}, {"twice", {}}};
  EXPECT_EQ(find_frame(motion, "near"), 0U);
  EXPECT_EQ(find_frame(motion, "3"), 1U) << "the name counts before the number";
  EXPECT_EQ(find_frame(motion, "4"), 3U);
  for (const std::string wrong : {"twice", "5", "0", "-1", "1.5", "", "far"})
    EXPECT_THROW(find_frame(motion, wrong), InputError) << wrong;
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
