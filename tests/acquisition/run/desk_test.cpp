// The laboratory on a desk: what it shows is what is so, and nothing of it lies about afterwards.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "acquisition/desk/specimen_laboratory.h"
#include "acquisition/desk/true_laboratory.h"
#include "base/error.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/laboratory.h"
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

// Red, green and blue read what their filters pass of the scene's three colours, each with its own noise.
TEST(Desk, FiltersPassWhatTheDescriptionSays) {
  const tests::ScratchFolder folder;
  const WorkIn here(folder.path());
  manifest::Document lab = specimen_laboratory("desk", folder.path());
  manifest::LaboratoryCamera& camera = lab.laboratory.entry.front().cameras.at("camera");
  camera.pixel_format = "BayerRG12";
  const auto light = [&] {  // at the filters of one row of the grid and the next: red, green, green, blue
    Instrument instrument = desk_instrument(lab, nullptr, {.seed = 3, .spp = 4});
    instrument.lamps.at("lamp")->set(true);
    const RawFrame frame = instrument.cameras.at("camera")->take({0.005, {}});
    std::array<double, 4> sums{};
    const auto width = static_cast<std::size_t>(frame.width_px);
    for (std::size_t i = 0; i < frame.samples.size(); ++i)
      sums[2 * (i / width % 2) + i % width % 2] += frame.samples[i] - *camera.black_code;
    return sums;
  };
  const std::array<double, 4> own = light();
  ASSERT_GT(own[0], 1e5);
  camera.filters = {0.5, 0, 0, 0.25, 0.5, 0.25, 0.75, 0.5, 0.25};
  const std::array<double, 4> passed = light();  // the board is grey: what a row passes in all is what its filter reads
  EXPECT_NEAR(passed[0] / own[0], 0.5, 0.005);
  EXPECT_NEAR(passed[1] / own[1], 1, 0.005);
  EXPECT_NEAR(passed[2] / own[2], 1, 0.005);
  EXPECT_NEAR(passed[3] / own[3], 1.5, 0.01);
  camera.filters.pop_back();
  Instrument short_of_one = desk_instrument(lab, nullptr, {.seed = 3, .spp = 1});
  EXPECT_THROW(short_of_one.cameras.at("camera")->take({0.005, {}}), Error);
}

// Without light: the black code and the read noise that the description states, and rounding's. In the light: shot
// noise. 307,200 pixels know a standard deviation to 0.13 %.
TEST(Desk, NoiseIsWhatTheDescriptionSays) {
  const tests::ScratchFolder folder;
  const WorkIn here(folder.path());
  manifest::Document lab = specimen_laboratory("desk", folder.path());
  const auto& camera = lab.laboratory.entry.front().cameras.at("camera");
  Instrument instrument = desk_instrument(lab, nullptr, {.seed = 3, .spp = 1});
  const RawFrame dark = instrument.cameras.at("camera")->take({0.01, {}});
  double sum = 0, squares = 0;
  for (const std::uint16_t code : dark.samples) sum += code, squares += static_cast<double>(code) * code;
  const double n = static_cast<double>(dark.samples.size()), mean = sum / n;
  const double read = *camera.read_electrons / *camera.electrons_per_code;
  EXPECT_NEAR(mean, *camera.black_code, 0.02);
  EXPECT_NEAR(squares / n - mean * mean, read * read + 1.0 / 12, 0.02 * read * read);
  // Two frames of one paper, at seeds of their own, differ by their noise.
  instrument.lamps.at("lamp")->set(true);
  Instrument other = desk_instrument(lab, nullptr, {.seed = 4, .spp = 1});
  other.lamps.at("lamp")->set(true);
  const RawFrame a = instrument.cameras.at("camera")->take({0.01, {}}),
                 b = other.cameras.at("camera")->take({0.01, {}});
  const auto width = static_cast<std::size_t>(a.width_px);
  const auto of_paper = [&](std::size_t i) {  // and so are all of its neighbours
    for (const std::size_t row : {i - width, i, i + width})
      for (std::size_t k = row - 1; k <= row + 1; ++k)
        if (std::min(a.samples[k], b.samples[k]) < 2500) return false;
    return true;
  };
  double expected = 0, measured = 0;
  for (std::size_t i = width + 1; i + width + 1 < a.samples.size(); ++i) {
    if (!of_paper(i)) continue;
    const double level = 0.5 * (a.samples[i] + b.samples[i]) - *camera.black_code,
                 d = 1.0 * a.samples[i] - b.samples[i];
    measured += d * d;
    expected += 2 * (level / *camera.electrons_per_code + read * read + 1.0 / 12);
  }
  ASSERT_GT(expected, 0);
  EXPECT_NEAR(measured / expected, 1, 0.02);
}

// Time is the instrument's own, and what drifts counts from its beginning.
TEST(Desk, ALampThatWarmsUpIsBrighterAtFirst) {
  const tests::ScratchFolder folder;
  const WorkIn here(folder.path());
  const manifest::Document lab = specimen_laboratory("desk", folder.path());
  manifest::Document truth;
  truth.mechanisms["light.drift"].parameters = {{"amplitude", 0.5}, {"time_constant_s", 1.0}};
  Instrument instrument = desk_instrument(lab, &truth, {.seed = 3, .spp = 1});
  instrument.lamps.at("lamp")->set(true);
  const auto mean_of = [](const RawFrame& frame) {
    double sum = 0;
    for (const std::uint16_t code : frame.samples) sum += code - 64.0;
    return sum / static_cast<double>(frame.samples.size());
  };
  const double first = mean_of(instrument.cameras.at("camera")->take({0.005, {}}));
  instrument.cameras.at("camera")->take({5, {}});
  EXPECT_NEAR(instrument.clock_s(), 5.005, 1e-9);
  EXPECT_NEAR(first / mean_of(instrument.cameras.at("camera")->take({0.005, {}})), 1.5, 0.01);
}

}  // namespace
}  // namespace gonio::acquisition
