// Cameras that write raw files: a cable that the test plays, with the words that cameras really use (libgphoto2's
// tables of Canon, Nikon, Sony), and raw files that are written by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <thread>

#include "acquisition/device/connection.h"
#include "acquisition/device/tethered_camera.h"
#include "acquisition/refusal_words.h"
#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "io/dng_writer.h"

using namespace gonio;
using namespace gonio::acquisition;
using testing::HasSubstr;
using tests::words_of;

namespace {

TEST(Tethered, ShutterSpeedsAreReadAsCamerasWriteThem) {
  const std::vector<std::pair<std::string, double>> speeds{
      {"1/125", 0.008}, {"10/1250", 0.008}, {"0.0080s", 0.008}, {"2", 2},       {"0.5", 0.5},       {"30", 30},
      {"1.3", 1.3},     {"2\"", 2},         {"0\"3", 0.3},      {"13/10", 1.3}, {"1/8000", 1.25e-4}};
  for (const auto& [words, seconds] : speeds) EXPECT_NEAR(shutter_speed_s(words).value_or(0), seconds, 1e-12) << words;
  for (const char* words : {"bulb", "Bulb", "Time", "Auto", "", "x 250", "1/0", "1/", "-1", "0", "1/125 or so", "nan",
                            "inf", "1e9", "2\"x", "Unknown value 0000"})
    EXPECT_FALSE(shutter_speed_s(words)) << words;
  const std::vector<std::string> choices{"bulb", "30", "2", "1.3", "1", "1/100", "1/125", "1/160"};
  EXPECT_EQ(nearest_choice(choices, 0.0081, shutter_speed_s), "1/125");
  EXPECT_EQ(nearest_choice(choices, 100, shutter_speed_s), "30");
  EXPECT_EQ(nearest_choice(choices, 1.6, shutter_speed_s), "1.3");  // by ratio: 1.61 is half way to 2
  EXPECT_FALSE(nearest_choice({"bulb"}, 1, shutter_speed_s));
}

// As a camera is at the other end of its cable: what is set shows in its next file.
struct PlayedCamera {
  std::map<std::string, std::string> values{{"shutterspeed", "1/100"},
                                            {"iso", "Auto"},
                                            {"imageformat", "L"},
                                            {"autoexposuremode", "Manual"},
                                            {"capturetarget", "Memory card"}};
  std::map<std::string, std::vector<std::string>> choices{
      {"shutterspeed", {"bulb", "2", "1", "0.5", "1/100", "1/125", "1/4000"}},
      {"iso", {"Auto", "100", "125", "200", "400"}},
      {"imageformat", {"L", "RAW + L", "cRAW", "mRAW", "RAW"}},
      {"capturetarget", {"Internal RAM", "Memory card"}}};
  int connections = 0, forgotten = 0, shots = 0;
  bool stubborn = false, unplugged = false, jpeg_too = false;
  std::string lies;  // a shutter speed that its files have instead
};

class PlayedCable : public CameraCable {
 public:
  explicit PlayedCable(PlayedCamera& camera) : camera_(camera) {
    ++camera_.connections;
    camera_.unplugged = false;
  }
  std::string identity() override { return "Played camera"; }
  std::optional<std::string> value(const std::string& setting) override {
    if (camera_.unplugged) throw Lost("I/O problem");
    const auto found = camera_.values.find(setting);
    return found == camera_.values.end() ? std::nullopt : std::optional(found->second);
  }
  std::vector<std::string> choices(const std::string& setting) override {
    if (camera_.unplugged) throw Lost("I/O problem");
    return camera_.choices[setting];
  }
  void choose(const std::string& setting, const std::string& choice) override {
    if (!camera_.stubborn) camera_.values[setting] = choice;
  }
  void forget_files() override { ++camera_.forgotten; }
  std::vector<File> shoot(double) override {
    const std::string name = "IMG_" + std::to_string(++camera_.shots);
    if (camera_.values["imageformat"] == "L") return {{name + ".jpg", "jpeg"}};
    tests::Dng dng;
    dng.width = 32, dng.height = 24;
    const std::string& speed = camera_.lies.empty() ? camera_.values["shutterspeed"] : camera_.lies;
    dng.exposure_us = static_cast<std::uint32_t>(std::lround(1e6 * shutter_speed_s(speed).value_or(0)));
    dng.iso = static_cast<std::uint32_t>(std::atoi(camera_.values["iso"].c_str()));
    for (int i = 0; i < 768; ++i) dng.samples.push_back(static_cast<std::uint16_t>(5 * i + camera_.shots));
    std::vector<File> files{{name + ".dng", bytes_of(dng)}};
    if (camera_.jpeg_too) files.insert(files.begin(), {name + ".jpg", "jpeg"});
    return files;
  }

 private:
  PlayedCamera& camera_;
};

std::unique_ptr<CameraDevice> tethered_camera(PlayedCamera& camera, TetherSettings settings = {}) {
  settings.name = "EOS";
  return make_tethered_camera(
      settings, [&camera] { return std::make_unique<PlayedCable>(camera); }, "lab.json");
}

TEST(Tethered, TakesRawFramesAsAsked) {
  PlayedCamera camera;
  camera.jpeg_too = true;
  const auto device = tethered_camera(camera);
  EXPECT_EQ(camera.values["imageformat"], "RAW");  // not cRAW, not RAW + L
  EXPECT_EQ(camera.values["capturetarget"], "Internal RAM");
  std::uint64_t last = 0;
  for (const double exposure_s : {0.008, 1.0, 0.5, 2.0}) {
    const RawFrame frame = device->take({exposure_s, 6});
    EXPECT_NEAR(frame.exposure_s.value_or(0), exposure_s, 1e-6);
    EXPECT_NEAR(frame.gain_db.value_or(0), 6.02, 0.01);  // ISO 200 over 100
    EXPECT_EQ(camera.values["iso"], "200");
    EXPECT_EQ(frame.pixel_format, "BayerRG12");
    EXPECT_EQ(frame.samples[1], 5 + camera.shots);
    EXPECT_GT(frame.frame_id, last);
    last = frame.frame_id;
  }
  EXPECT_EQ(camera.forgotten, 4);
  EXPECT_EQ(camera.connections, 1);
  camera.lies = "1/125";  // what the file says counts, not what was set
  EXPECT_NEAR(device->take({0.01, 6}).exposure_s.value_or(0), 0.008, 1e-9);
}

TEST(Tethered, WhatItHasNotIsRefusedWithItsChoices) {
  PlayedCamera camera;
  const auto device = tethered_camera(camera);
  EXPECT_THAT(words_of(
                  [&] {
                    device->take({0.009, 0});
                  },
                  Exit::data),
              HasSubstr("lab.json: camera EOS: has no shutter speed of 0.009 s; "
                        "it has 2, 1, 0.5, 1/100, 1/125, 1/4000"));
  EXPECT_THAT(words_of(
                  [&] {
                    device->take({0.008, 3});
                  },
                  Exit::data),
              HasSubstr("has no ISO 141.3, a gain of 3 dB over ISO 100; it has 100, 125, 200, 400"));
  camera.values["iso"] = "Auto";
  EXPECT_THAT(words_of([&] { device->take({0.008, {}}); }, Exit::data), HasSubstr("its ISO stands at Auto"));
  camera.values["iso"] = "100", camera.values["shutterspeed"] = "1/100";
  camera.stubborn = true;
  EXPECT_THAT(words_of(
                  [&] {
                    device->take({0.008, 0});
                  },
                  Exit::unavailable),
              HasSubstr("keeps shutterspeed at 1/100, 1/125 was asked"));
  EXPECT_EQ(camera.shots, 0);
  camera.stubborn = false;
  camera.values["autoexposuremode"] = "AV";
  EXPECT_THAT(words_of([&] { tethered_camera(camera); }, Exit::data), HasSubstr("its dial stands at AV"));
  camera.values["autoexposuremode"] = "Manual";
  camera.choices["imageformat"] = {"L", "M"};
  EXPECT_THAT(words_of([&] { tethered_camera(camera); }, Exit::data),
              HasSubstr("writes no raw files; quality= the one"));
  EXPECT_THAT(words_of(
                  [&] {
                    tethered_camera(camera, {.quality = "L"})->take({0.01, 0});
                  },
                  Exit::unavailable),
              HasSubstr("made IMG_1.jpg, and no raw file"));
  camera.choices["imageformat"] = {"RAW"};
  EXPECT_THAT(words_of(
                  [&] {
                    tethered_camera(camera, {.pixel_format = "Mono12"})->take({0.01, 0});
                  },
                  Exit::data),
              HasSubstr("holds BayerRG12, pixel_format says Mono12"));
}

TEST(Tethered, ACableThatWasPulledIsConnectedAnew) {
  PlayedCamera camera;
  const auto device = tethered_camera(camera);
  device->take({0.01, 0});
  camera.unplugged = true;
  EXPECT_THAT(words_of([&] { device->take({0.01, 0}); }, Exit::unavailable), HasSubstr("camera EOS: I/O problem"));
  EXPECT_EQ(device->take({0.01, 0}).frame_id, 2U);
  EXPECT_EQ(camera.connections, 2);
}

// libgphoto2 itself, as far as it goes without a camera.
TEST(Tethered, NoCameraIsSaid) {
  EXPECT_THAT(words_of([] { open_camera("gphoto2://No%20Such%20Camera", "here"); }, Exit::unavailable),
              HasSubstr("here: camera No Such Camera: there is none"));
  EXPECT_THAT(words_of([] { open_camera("gphoto2://?pixel_format=JPEG", "here"); }, Exit::usage),
              HasSubstr("pixel_format is 'JPEG'"));
  EXPECT_THAT(words_of([] { open_camera("gphoto2:///dev/x", "here"); }, Exit::usage), HasSubstr("gphoto2://MODEL"));
}

TEST(FolderCamera, RawFilesSayHowTheyWereExposed) {
  const tests::ScratchFolder folder;
  const auto camera = open_camera("folder://" + folder.path().string() + "?settle=1ms&iso=100", "here");
  tests::Dng dng;
  Random random(3);
  for (int i = 0; i < dng.width * dng.height; ++i)
    dng.samples.push_back(static_cast<std::uint16_t>(random.below(4096)));
  const std::jthread writer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    std::ofstream(folder / ".part", std::ios::binary) << bytes_of(dng);
    std::filesystem::rename(folder / ".part", folder / "a.DNG");
  });
  const RawFrame frame = camera->take({0.004, {}});
  EXPECT_EQ(frame.samples, dng.samples);
  EXPECT_EQ(frame.pixel_format, "BayerRG12");
  EXPECT_NEAR(frame.exposure_s.value_or(0), 0.004, 1e-9);
  EXPECT_NEAR(frame.gain_db.value_or(0), 6.02, 0.01);
}

}  // namespace
