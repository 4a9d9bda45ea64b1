// The laboratory on a desk: what it shows is what is so, and nothing of it lies about afterwards.
#include <gtest/gtest.h>

#include <filesystem>

#include "acquisition/desk/specimen_laboratory.h"
#include "acquisition/desk/true_laboratory.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"

namespace gonio::acquisition {
namespace {

// A document without a file of its own finds its files from where it is worked with.
struct WorkIn {
  explicit WorkIn(const std::filesystem::path& folder) { std::filesystem::current_path(folder); }
  ~WorkIn() { std::filesystem::current_path(before); }
  std::filesystem::path before = std::filesystem::current_path();
};

TEST(Desk, AFrameTakenAgainIsTheSameAndLeavesNoFile) {
  const tests::ScratchFolder folder;
  const WorkIn here(folder.path());
  const manifest::Document lab = specimen_laboratory("desk", folder.path());
  Instrument instrument = desk_instrument(lab, nullptr, {.seed = 3, .spp = 1});
  instrument.lamps.at("lamp")->set(true);
  const RawFrame first = instrument.cameras.at("camera")->take({0.01, {}});
  const RawFrame second = instrument.cameras.at("camera")->take({0.01, {}});
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) files += entry.is_regular_file();
  EXPECT_EQ(first.samples, second.samples);
  EXPECT_EQ(second.frame_id, first.frame_id + 1);
  EXPECT_EQ(files, 1U);  // the board's drawing
}

// A camera sees from where the arm truly is; the arm reports where it was sent.
TEST(Desk, AMechanismMovesTheCameraAndNotTheReport) {
  const tests::ScratchFolder folder;
  const WorkIn here(folder.path());
  const manifest::Document lab = specimen_laboratory("desk", folder.path());
  manifest::Document truth;
  truth.mechanisms["robot.joint-offset"].parameters["joint_1_rad"] = 0.02;
  Instrument believed = desk_instrument(lab, nullptr, {.seed = 3, .spp = 1});
  Instrument real = desk_instrument(lab, &truth, {.seed = 3, .spp = 1});
  for (Instrument* instrument : {&believed, &real}) instrument->lamps.at("lamp")->set(true);
  EXPECT_EQ(believed.robots.at("arm")->state().joints_rad, real.robots.at("arm")->state().joints_rad);
  EXPECT_NE(believed.cameras.at("camera")->take({0.01, {}}).samples,
            real.cameras.at("camera")->take({0.01, {}}).samples);
}

}  // namespace
}  // namespace gonio::acquisition
