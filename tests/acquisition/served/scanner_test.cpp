// A simulated scanner from plan to figures: acquire shows and records a projection, structured-light takes the frames
// with no further word, vdi2634 measures the plate's flatness, reassemble takes the cloud as background.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "acquisition/plan/shown_frames.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/acceptance.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/plan.h"
#include "manifest/sections/projection.h"
#include "manifest/sections/rig.h"
#include "process.h"
#include "reassembly/specimen.h"
#include "stats/intervals.h"

namespace gonio::acquisition {
namespace {

using testing::HasSubstr;
using tests::Ended;

class Scanner : public testing::Test {
 protected:
  Ended run(const std::vector<std::string>& words) { return tests::run(words, folder_.path()); }
  std::string done(const std::vector<std::string>& words) {
    const Ended ended = run(words);
    EXPECT_EQ(ended.status, 0) << words[0] << ": " << ended.err;
    return ended.out;
  }
  void describe() {
    write_file(folder_ / "lab.json", done({"acquire", "--specimen", "scanner", "--out", "lab"}));
    write_file(folder_ / "shown.json",
               done({"structured-light", "--pattern", "cosine", "--size", "320x240", "--axes", "columns", "--periods",
                     "1,8", "--shifts", "3", "--name", "cosines", "--out", "patterns", "lab.json"}));
  }
  void describe_rig();

  tests::ScratchFolder folder_;
};

// R of (right, down, forward), columns in the world.
manifest::Pose<frame::World, frame::Camera> looking(Vec3 position, Vec3 direction, Vec3 up) {
  const Vec3 z = normalized(direction), x = normalized(cross(z, up)), y = cross(z, x);
  manifest::Pose<frame::World, frame::Camera> pose;
  pose.rotation = quaternion_of(Mat3{{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}});
  pose.translation_m = position;
  return pose;
}

// rig.json: shown.json with the projector as a camera of the rig, in which it looks as its light does.
void Scanner::describe_rig() {
  manifest::Document d = manifest::read_document(folder_ / "shown.json");
  const auto& light = d.lights.at("projector").parameters;
  const auto vector = [&light](const char* name) {
    const auto& v = light.at(name).value;
    return Vec3{v[0], v[1], v[2]};
  };
  manifest::Camera& projector = d.cameras["projector"];
  projector.width_px = 320, projector.height_px = 240;
  projector.fx_px = light.at("fx_px"), projector.fy_px = light.at("fy_px"), projector.cx_px = light.at("cx_px"),
  projector.cy_px = light.at("cy_px");
  const Rigid<frame::World, frame::Camera> world_from_camera =
      *d.laboratory.entry.front().cameras.at("camera").world_from_camera;
  const Rigid<frame::World, frame::Camera> world_from_projector =
      looking(vector("position_m"), vector("direction"), vector("up"));
  manifest::Rig& rig = d.rigs["rig"];
  rig.cameras.resize(2);
  rig.cameras[0].camera = "camera", rig.cameras[1].camera = "projector";
  const auto between = inverse(world_from_camera) * world_from_projector;
  rig.cameras[1].rig_from_camera.rotation = between.rotation;
  rig.cameras[1].rig_from_camera.translation_m = between.translation_m;
  write_file(folder_ / "rig.json", manifest::print_document(d, folder_.path()));
}

TEST_F(Scanner, APlateIsShownRecordedMeasuredAndTakenAsBackground) {
  describe();
  describe_rig();
  write_file(folder_ / "frames.json",
             done({"acquire", "rig.json", "--plan", "turntable:span=0deg,radius=0", "--show", "cosines", "--go",
                   "--truth", "lab/plate.json", "--spp", "4", "--out", "run"}));
  const std::string frames = read_file(folder_ / "frames.json");
  EXPECT_THAT(frames, HasSubstr("\"group\": \"turntable-0001\""));
  EXPECT_THAT(frames, HasSubstr("\"shows\": 5"));
  write_file(folder_ / "scan.json", done({"structured-light", "-i", "frames.json", "--camera", "camera", "--projector",
                                          "projector", "--out", "scan"}));
  const io::TriangleMesh cloud =
      io::read_ply(folder_ / "scan/turntable-0001.ply", {.properties = {"sigma", "pixel_x", "pixel_y"}});
  ASSERT_GT(cloud.positions_m.size(), 15000u);
  // The plate's plane in the world: through (0, 0, 0.03), turned by 10 degrees about x and 3 about y. Pixels at its rim
  // see two things, and columns alone do not tell that.
  const Quaternion leaning = quaternion_of_rotation_vector({10 * pi / 180, 3 * pi / 180, 0});
  const Vec3 normal = matrix_of(leaning) * Vec3{0, 0, 1};
  std::vector<double> off, over_sigma;
  for (std::size_t i = 0; i < cloud.positions_m.size(); ++i) {
    off.push_back(std::abs(dot(cloud.positions_m[i] - Vec3{0, 0, 0.03}, normal)));
    over_sigma.push_back(off.back() / double{cloud.properties[0][i]});
  }
  EXPECT_LT(stats::median(off), 5e-4);
  EXPECT_LT(stats::median(over_sigma), 1.5);  // 0.67 but for four samples a pixel
  write_file(folder_ / "plane.json", done({"vdi2634", "--shape", "plane", "scan/turntable-0001.ply"}));
  const manifest::Document plane = manifest::read_document(folder_ / "plane.json");
  ASSERT_FALSE(plane.acceptance.empty());
  EXPECT_EQ(plane.acceptance.front().quantity, "flatness");
  make_folder(folder_ / "bowl");
  write_file(
      folder_ / "bowl.json",
      manifest::print_document(reassembly::specimen(folder_ / "bowl", {.width_px = 160, .height_px = 120, .spp = 1}),
                               folder_.path()));
  const Ended placed = run({"reassemble", "bowl.json", "--piece", "bowl/bowl.json", "--background",
                            "scan/turntable-0001.ply", "--out", "pieces", "--allow-outside"});
  // In pictures as small as these, nobody finds the bowl's markers, and that is all that is wrong.
  EXPECT_EQ(placed.status, 2) << placed.err;
  EXPECT_THAT(placed.err, HasSubstr("bowl: not placed"));
  write_file(folder_ / "scene.json", placed.out);
  EXPECT_TRUE(manifest::read_document(folder_ / "scene.json", {.allow_outside = true}).meshes.contains("background"));
}

TEST_F(Scanner, PlansSayWhatIsShownOrWhyItCannotBe) {
  describe();
  const manifest::Document plan = manifest::parse_document(
      done({"acquire", "shown.json", "--plan", "turntable:step=120deg,radius=0", "--show", "projector=cosines"}),
      "plan.json", folder_.path());
  const std::vector<manifest::PlanStep>& steps = plan.plans.front().steps;
  ASSERT_EQ(steps.size(), 18u);
  EXPECT_EQ(steps[7].group, steps[6].group);
  EXPECT_EQ(steps[7].screens.at("projector"), plan.projections.at("cosines").frames[1].file);
  struct Case {
    std::vector<std::string> words;
    int status;
    const char* says;
  };
  const std::vector<std::string> planned{"acquire", "shown.json", "--plan", "turntable:radius=0"};
  const auto with = [&planned](std::vector<std::string> more) {
    more.insert(more.begin(), planned.begin(), planned.end());
    return more;
  };
  std::string text = read_file(folder_ / "shown.json");
  const std::size_t at = text.rfind("\"width_px\": 320");
  ASSERT_NE(at, std::string::npos);
  for (const Case& c :
       {Case{with({"--show", "dots"}), 64, "is no projection of the manifest"},
        Case{with({"--show", "wall=cosines"}), 64, "is no screen of the laboratory"},
        Case{with({"--show", "cosines", "--exposure", "1ms", "--exposure", "2ms"}), 64, "is given several times"},
        Case{{"acquire", "shown.json", "--show", "cosines", "--dry-run"}, 64, "needs a plan that is made now"}}) {
    const Ended ended = run(c.words);
    EXPECT_EQ(ended.status, c.status) << c.says << ": " << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(c.says));
    EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
  }
  manifest::Document d = manifest::read_document(folder_ / "shown.json");
  d.projections.at("cosines").width_px = 640;
  EXPECT_THROW(shown_projection("cosines", "--show", d), Error);
  d = manifest::read_document(folder_ / "shown.json");
  d.projections.at("cosines").frames[3].file.clear();
  EXPECT_THROW(shown_projection("cosines", "--show", d), Error);
}

}  // namespace
}  // namespace gonio::acquisition
