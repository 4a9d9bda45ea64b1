// The built-in laboratories, from the plan to what other programs make of their frames.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "acquisition/desk/specimen_laboratory.h"
#include "base/atomic_file.h"
#include "data.h"
#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/comparison.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mounting.h"
#include "manifest/sections/object.h"
#include "manifest/sections/plan.h"
#include "manifest/sections/robot.h"
#include "process.h"

namespace gonio::acquisition {
namespace {

using Words = tests::Process::Words;

void expect_done(const Words& words, const tests::ScratchFolder& folder) {
  const tests::Ended ended = tests::run(words, folder.path());
  ASSERT_EQ(ended.status, 0) << words.front() << " " << words[1] << ": " << ended.err;
}

// As it is written, with pictures a quarter as wide: they tell the same.
void write_small(const std::string& name, const tests::ScratchFolder& folder) {
  manifest::Document lab = specimen_laboratory(name, folder.path());
  manifest::Camera& lens = lab.cameras.at("camera");
  lens.width_px /= 4, lens.height_px /= 4;
  for (manifest::Parameter* focal : {&lens.fx_px, &lens.fy_px}) *focal = focal->scalar() / 4;
  for (manifest::Parameter* middle : {&lens.cx_px, &lens.cy_px}) *middle = (middle->scalar() + 0.5) / 4 - 0.5;
  write_file(folder / "lab.json", manifest::print_document(lab, folder.path()));
}

manifest::Document compared(const tests::ScratchFolder& folder, const Words& render_more) {
  Words render{"render", "frames.json", "--spp", "16", "--out", "r", "-o", "r.json"};
  render.insert(render.end(), render_more.begin(), render_more.end());
  expect_done(render, folder);
  expect_done({"compare", "r.json", "--force", "-o", "compared.json"}, folder);
  return manifest::read_document(folder / "compared.json");
}

// The table turns between the two frames: each is rendered as it was taken.
TEST(Specimens, TurntableFramesAreRenderedAsTheyWereTaken) {
  const tests::ScratchFolder folder;
  write_small("turntable", folder);
  expect_done({"acquire", "lab.json", "--plan",
               "turntable:step=100deg,span=150deg,radius=24cm,azimuth=90deg,lowest=45deg,highest=45deg", "--target",
               "0m,0m,3cm", "-o", "plan.json"},
              folder);
  expect_done({"acquire", "plan.json", "--go", "--spp", "16", "--out", "run", "-o", "frames.json"}, folder);
  const manifest::Document d = compared(folder, {"--stokes"});
  ASSERT_EQ(d.comparisons.size(), 2U);
  for (const manifest::Comparison& c : d.comparisons) EXPECT_GT(*c.ssim, 0.99) << c.image;
  EXPECT_EQ(d.lights.size(), 2U);  // the lamp where it stands, and where it is seen from the turned table
  EXPECT_GT(norm(d.images[0].world_from_camera->translation_m - d.images[1].world_from_camera->translation_m), 0.2);
}

// Where handeye says that the camera sits is where frames are seen from; a held lamp is at another place in each; of
// what was on the table before nothing is left.
TEST(Specimens, TwoArmsGoByWhatWasMeasured) {
  const tests::ScratchFolder folder;
  write_small("studio", folder);
  manifest::Document lab = manifest::read_document(folder / "lab.json");
  manifest::Mounting mounting;
  mounting.kind = "eye-in-hand";
  mounting.camera = "camera";
  mounting.robot = "left";
  mounting.tool_from_camera.emplace() = {{quaternion_of_rotation_vector({0.01, -0.02, 0.8}), {0.01, -0.02, 0.075}}, {}};
  lab.robots["left"].model = "ur5";
  lab.mountings["camera"] = mounting;
  manifest::ImageEntry old;
  old.id = "of the board";
  lab.images = {old};
  write_file(folder / "lab.json", manifest::print_document(lab, folder.path()));
  const std::string plan =
      "octant:azimuth=200deg,span=30deg,step=30deg,lowest=50deg,highest=50deg,radius=36cm,"
      "lamp-radius=42cm,lamp-step=90deg,lamp-azimuth=-30deg,lamp-span=60deg";
  expect_done({"acquire", "lab.json", "--fresh", "--plan", plan, "--target", "0m,0m,3cm", "-o", "plan.json"}, folder);
  expect_done({"acquire", "plan.json", "--go", "--spp", "1", "--out", "run", "-o", "frames.json"}, folder);
  const manifest::Document d = manifest::read_document(folder / "frames.json");
  ASSERT_EQ(d.images.size(), 2U);
  ASSERT_EQ(d.plans.size(), 1U);
  for (const manifest::ImageEntry& image : d.images) {
    ASSERT_EQ(image.light.size(), 1U);
    EXPECT_TRUE(d.lights.contains(image.light.front()));
    const auto asked = std::ranges::find(d.plans.front().steps, image.id, &manifest::PlanStep::image);
    // Arms stop where they were sent, and the plan sent them by the measured mounting.
    EXPECT_LT(norm(image.world_from_camera->translation_m - asked->world_from_camera->translation_m), 1e-6) << image.id;
    ASSERT_TRUE(image.saturation && image.noise);
  }
}

// A sheet that no client knows bends while its drive turns: frames differ though nothing else moves, say how far it
// was, and are rendered again from the truth as they were taken.
TEST(Specimens, WhatADriveDeformsIsPhotographedAndKnownAgain) {
  const tests::ScratchFolder folder;
  write_small("stage", folder);
  expect_done({"nrsfm-make", "--object", "sheet", "--kind", "bending", "--frames", "4", "--grain", "2cm", "--out", "s",
               "-i", "lab.json", "-o", "truth.json"},
              folder);
  expect_done({"acquire", "lab.json", "--plan", "tricky:views=3,distance=36cm,spread=0.01,turn=360deg", "--target",
               "0m,0m,6cm", "-o", "plan.json"},
              folder);
  expect_done({"acquire", "plan.json", "--go", "--truth", "truth.json", "--spp", "16", "--out", "run", "-o", "f.json"},
              folder);
  const manifest::Document f = manifest::read_document(folder / "f.json");
  ASSERT_EQ(f.images.size(), 3U);
  for (const manifest::ImageEntry& image : f.images) {
    const double share = 0.5 * (image.id.back() - '1');
    EXPECT_EQ(image.shapes, (std::map<std::string, double>{{"sheet", share}, {"sheet-rig", share}})) << image.id;
    EXPECT_LT(norm(image.world_from_camera->translation_m - f.images[0].world_from_camera->translation_m), 0.01);
  }
  EXPECT_EQ(std::ranges::count(f.objects, "sheet", &manifest::Object::id), 0);
  manifest::Document twin = manifest::read_document(folder / "truth.json");
  twin.images = f.images, twin.lights = f.lights, twin.robots = f.robots, twin.cameras = f.cameras;
  for (manifest::ImageEntry& image : twin.images)
    image.file = manifest::add_file(twin, manifest::resolve(f, image.file, "/files"), image.id);
  write_file(folder / "frames.json", manifest::print_document(twin, folder.path()));
  const auto right = compared(folder, {}).comparisons;
  for (const manifest::Comparison& c : right) EXPECT_GT(*c.ssim, 0.97) << c.image;
  std::swap(twin.images[0].shapes, twin.images[1].shapes);
  write_file(folder / "frames.json", manifest::print_document(twin, folder.path()));
  const auto wrong = compared(folder, {"--force"}).comparisons;
  for (const std::size_t i : {0, 1}) EXPECT_GT(1 - *wrong[i].ssim, 2 * (1 - *right[i].ssim)) << right[i].image;
  EXPECT_EQ(*wrong[2].ssim, *right[2].ssim);
}

}  // namespace
}  // namespace gonio::acquisition
