// Cameras that others wrote: aravis's own GigE Vision camera, a program; makers' feature files; and a folder.
// One at a time: GenicamCamera.*
#include <arv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/prctl.h>

#include <fstream>
#include <thread>

#include "acquisition/device/devices.h"
#include "acquisition/device/gige_knock.h"
#include "acquisition/whole_frame.h"
#include "base/error.h"
#include "data.h"
#include "io/raster.h"
#include "process.h"

using namespace gonio;
using namespace gonio::acquisition;

namespace {

constexpr const char* kFakeCamera = "arv-fake-gv-camera-0.8";

bool is_on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((folder + "/" + program).c_str(), X_OK) == 0) return true;
  return false;
}

// The port of GigE Vision, 3956, is one for all: tests that use it wait for each other.
class FakeCamera {
 public:
  explicit FakeCamera(const std::string& lost_of_1000 = "0") {
    lock_ = ::open((std::filesystem::temp_directory_path() / "gonio-test-port-3956").c_str(), O_CREAT | O_RDWR, 0666);
    ::flock(lock_, LOCK_EX);
    start(lost_of_1000);
  }
  ~FakeCamera() {
    stop();
    ::close(lock_);
  }
  void start(const std::string& lost_of_1000 = "0") {
    process_.emplace(tests::Process::Words{kFakeCamera, "-i", "127.0.0.1", "-s", "gonio", "-r", lost_of_1000},
                     std::filesystem::path{}, std::string{}, [] { ::prctl(PR_SET_PDEATHSIG, SIGKILL); });
    answers = answers_as_gige_camera("127.0.0.1", 8);
  }
  void stop() {
    if (!process_) return;
    ::kill(process_->id(), SIGTERM);
    process_->end();
    process_.reset();
  }
  bool answers = false;

 private:
  int lock_ = -1;
  std::optional<tests::Process> process_;
};

#define GONIO_NEEDS_FAKE_CAMERA(camera)                                                              \
  if (!is_on_path(kFakeCamera)) GTEST_SKIP() << kFakeCamera << " is missing (package aravis-tools)"; \
  FakeCamera camera;                                                                                 \
  if (!camera.answers) GTEST_SKIP() << "nothing answers at UDP 127.0.0.1:3956"

struct Refusal {
  Exit code = Exit::done;
  std::string text;
};
Refusal refusal_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return {error.code(), error.what()};
  }
  return {};
}

TEST(GenicamCamera, TakesFramesAsAsked) {
  GONIO_NEEDS_FAKE_CAMERA(world);
  const auto camera = open_camera("genicam://127.0.0.1?pixel_format=Mono8&packet-size=1400", "here");
  EXPECT_EQ(camera->identity(), "Aravis Fake gonio");
  std::optional<RawFrame> before;
  for (const double exposure_s : {1e-3, 0.020, 5e-5, 0.004, 0.004, 0.010}) {
    const RawFrame frame = tests::whole_frame(*camera, {exposure_s, {}});
    EXPECT_EQ(frame.width_px * frame.height_px, 512 * 512);
    ASSERT_EQ(frame.samples.size(), 512U * 512U);
    EXPECT_EQ(frame.pixel_format, "Mono8");
    EXPECT_EQ(frame.bits, 8);
    EXPECT_EQ(frame.incomplete_packets, 0);
    EXPECT_NEAR(frame.exposure_s.value_or(0), exposure_s, 1e-6);
    EXPECT_FALSE(frame.gain_db);  // GainRaw: counts of nobody knows what
    EXPECT_FALSE(frame.chunk_frame_id);
    ASSERT_TRUE(frame.camera_time_s);
    if (before) {
      EXPECT_GT(frame.frame_id, before->frame_id);
      EXPECT_GT(*frame.camera_time_s, *before->camera_time_s);
    }
    before = frame;
  }
}

// The pixels themselves: the fake camera's picture is a ramp along diagonals, scaled by exposure and gain, that moves
// by a pixel a frame (arvfakecamera.c); at more than 8 bits it is the same ramp in more codes.
TEST(GenicamCamera, PixelsFollowExposureAndGain) {
  GONIO_NEEDS_FAKE_CAMERA(world);
  const auto mean = [](const RawFrame& frame) {
    double sum = 0;
    for (const auto sample : frame.samples) sum += sample;
    return sum / static_cast<double>(frame.samples.size());
  };
  const auto camera = open_camera("genicam://127.0.0.1?gain-step=0.5", "here");
  const RawFrame once = tests::whole_frame(*camera, {0.002, 0.0}), twice = tests::whole_frame(*camera, {0.004, 0.0});
  const RawFrame louder = tests::whole_frame(*camera, {0.002, 2.5});
  EXPECT_NEAR(mean(twice) / mean(once), 2, 0.05);
  EXPECT_GT(mean(louder), 1.5 * mean(once));
  EXPECT_EQ(louder.gain_db, 2.5);
  EXPECT_EQ(once.gain_db, 0.0);
}

TEST(GenicamCamera, MosaicsAndDepthsKeepTheirNames) {
  GONIO_NEEDS_FAKE_CAMERA(world);
  for (const char* format : {"BayerRG8", "BayerGB8", "Mono16"}) {
    const auto camera = open_camera(std::string("genicam://127.0.0.1?pixel_format=") + format, "here");
    const RawFrame frame = tests::whole_frame(*camera, {0.005, {}});
    EXPECT_EQ(frame.pixel_format, format);
    EXPECT_EQ(frame.bits, std::string(format) == "Mono16" ? 16 : 8);
    EXPECT_EQ(frame.samples.size(), 512U * 512U);
  }
}

TEST(GenicamCamera, SingleFramesWithoutATrigger) {
  GONIO_NEEDS_FAKE_CAMERA(world);
  const auto camera = open_camera("genicam://127.0.0.1?trigger=none", "here");
  std::uint64_t last = 0;
  for (const double exposure_s : {0.001, 0.003, 0.002}) {
    const RawFrame frame = tests::whole_frame(*camera, {exposure_s, {}});
    EXPECT_NEAR(frame.exposure_s.value_or(0), exposure_s, 1e-6);
    EXPECT_GT(frame.frame_id, last);
    last = frame.frame_id;
  }
}

TEST(GenicamCamera, WhatItCannotIsSaidWithItsLimits) {
  GONIO_NEEDS_FAKE_CAMERA(world);
  const auto camera = open_camera("genicam://127.0.0.1", "here");
  const auto wrong = [&](const Shot& shot) { return refusal_of([&] { camera->take(shot); }); };
  for (const double exposure_s : {1e-6, 20.0, -1.0, std::nan("")}) {
    const Refusal refused = wrong({exposure_s, {}});
    EXPECT_EQ(refused.code, Exit::data);
    EXPECT_THAT(refused.text, testing::HasSubstr("it can 0.01 to 10000 ms"));
  }
  EXPECT_THAT(wrong({0.001, 3.0}).text, testing::HasSubstr("its gain is a count without a unit"));
  EXPECT_EQ(tests::whole_frame(*camera, {0.001, {}}).incomplete_packets, 0);  // it goes on
  const Refusal held = refusal_of([] { open_camera("genicam://127.0.0.1", "here"); });
  EXPECT_EQ(held.code, Exit::unavailable);
  EXPECT_THAT(held.text, testing::HasSubstr("another program holds it"));
}

TEST(GenicamCamera, HasOnlyItsOwnPixelFormats) {
  GONIO_NEEDS_FAKE_CAMERA(world);
  const Refusal format = refusal_of([] { open_camera("genicam://127.0.0.1?pixel_format=Mono12p", "here"); });
  EXPECT_EQ(format.code, Exit::data);
  EXPECT_THAT(format.text, testing::HasSubstr("has no pixel format Mono12p; it has BayerBG8"));
  EXPECT_THAT(format.text, testing::Not(testing::HasSubstr("RGB8")));
  EXPECT_THAT(refusal_of([] { open_camera("genicam://127.0.0.1?pixel_format=RGB8", "here"); }).text,
              testing::HasSubstr("pixel_format is 'RGB8'"));
}

TEST(GenicamCamera, AFrameWithLostPacketsIsSaidToBeOne) {
  GONIO_NEEDS_FAKE_CAMERA(world);
  world.stop();
  world.start("100");
  const auto camera = open_camera("genicam://127.0.0.1?timeout=2s", "here");
  int incomplete = 0;
  for (int i = 0; i < 3; ++i) {
    try {
      const RawFrame frame = camera->take({0.001, {}});
      incomplete += frame.incomplete_packets > 0;
      EXPECT_TRUE(frame.incomplete_packets == 0 || frame.samples.empty());
    } catch (const Error& error) {  // every packet that opens the frame was lost
      EXPECT_EQ(error.code(), Exit::unavailable);
      ++incomplete;
    }
  }
  EXPECT_EQ(incomplete, 3);  // one of 188 packets in ten: none arrives whole but once in 4e8
}

TEST(GenicamCamera, ACameraThatWentAwayComesBack) {
  GONIO_NEEDS_FAKE_CAMERA(world);
  const auto camera = open_camera("genicam://127.0.0.1?timeout=2s", "here");
  const auto last = tests::whole_frame(*camera, {0.001, {}}).frame_id;
  world.stop();
  EXPECT_EQ(refusal_of([&] { camera->take({0.001, {}}); }).code, Exit::unavailable);
  world.start();
  ASSERT_TRUE(world.answers);
  const RawFrame frame = tests::whole_frame(*camera, {0.002, {}});
  EXPECT_NEAR(frame.exposure_s.value_or(0), 0.002, 1e-6);
  EXPECT_GT(frame.frame_id, last);
}

TEST(GenicamCamera, NobodyThereIsSaidInTime) {
  for (const char* url : {"genicam://127.0.0.9?timeout=300ms", "genicam://127.1.2.3?timeout=300ms"}) {
    const auto began = Clock::now();
    const Refusal refused = refusal_of([&] { open_camera(url, "lab.json#/laboratory/cameras/left/url"); });
    EXPECT_EQ(refused.code, Exit::unavailable);
    EXPECT_THAT(refused.text, testing::HasSubstr("does not answer within 0.3 s"));
    EXPECT_LT(Clock::now() - began, std::chrono::seconds(2));  // a busy machine's share
  }
  for (const char* url : {"genicam://", "genicam://x:3956", "genicam://x/y", "genicam://x?packet=1",
                          "genicam://x?pixel_format=Mono9", "genicam://x?packet-size=99999"})
    EXPECT_EQ(refusal_of([&] { open_camera(url, "here"); }).code, Exit::usage) << url;
  EXPECT_THAT(refusal_of([] { open_camera("usb://x", "here"); }).text,
              testing::AllOf(testing::HasSubstr("no driver for 'usb://'"), testing::HasSubstr("genicam://"),
                             testing::HasSubstr("folder://")));
}

io::Image ramp(int width, int height, int codes, int step) {
  io::Image image(width, height, {"Y"});
  for (std::size_t i = 0; i < image.data.size(); ++i)
    image.data[i] = static_cast<float>(static_cast<int>(i) * step % codes) / static_cast<float>(codes - 1);
  return image;
}
void write_bytes(const std::filesystem::path& path, const std::string& bytes, std::ios::openmode mode = std::ios::out) {
  std::ofstream(path, mode | std::ios::binary) << bytes;
}
std::string folder_url(const tests::ScratchFolder& folder, const std::string& query) {
  return "folder://" + folder.path().string() + "?" + query;
}

TEST(FolderCamera, TakesTheNextNewPictureOnceItIsWhole) {
  tests::ScratchFolder folder;
  const std::string old = io::encode_raster_png(ramp(8, 8, 256, 1), 8);
  const std::string bytes = io::encode_raster_png(ramp(300, 200, 65536, 7), 16);
  write_bytes(folder / "a.png", old);
  const auto camera = open_camera(folder_url(folder, "timeout=20s&settle=60ms"), "here");
  EXPECT_EQ(camera->identity(), "files in " + folder.path().string());
  std::thread writer([&] {  // in two halves, with a rest between that is longer than a settled file's
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    write_bytes(folder / ".hidden.png", old);
    write_bytes(folder / "notes.txt", old);
    write_bytes(folder / "0.png", bytes.substr(0, bytes.size() / 2));
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    write_bytes(folder / "0.png", bytes.substr(bytes.size() / 2), std::ios::app);
  });
  const RawFrame frame = camera->take({0.001, {}});
  writer.join();
  EXPECT_EQ(frame.width_px, 300);
  EXPECT_EQ(frame.height_px, 200);
  EXPECT_EQ(frame.bits, 16);
  EXPECT_EQ(frame.pixel_format, "Mono16");
  ASSERT_EQ(frame.samples.size(), 60000U);
  for (std::size_t i = 0; i < frame.samples.size(); ++i) ASSERT_EQ(frame.samples[i], i * 7 % 65536);
  EXPECT_EQ(frame.frame_id, 1U);
  EXPECT_FALSE(frame.exposure_s || frame.gain_db || frame.camera_time_s || frame.chunk_frame_id);
}

TEST(FolderCamera, SaysWhatIsMissingOrOneTooMany) {
  tests::ScratchFolder folder;
  const std::string twelve = io::encode_raster_png(ramp(16, 16, 65536, 16), 16);
  const auto while_waiting = [&](const std::string& query, const std::map<std::string, std::string>& files) {
    const auto camera = open_camera(folder_url(folder, query), "here");
    std::thread writer([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
      for (const auto& [name, bytes] : files) write_bytes(folder / name, bytes);
    });
    const Refusal refused = refusal_of([&] { camera->take({0, {}}); });
    writer.join();
    return refused;
  };
  const Refusal none = while_waiting("timeout=100ms", {});
  EXPECT_EQ(none.code, Exit::unavailable);
  EXPECT_THAT(none.text, testing::HasSubstr("no new picture within 0.1 s"));
  EXPECT_THAT(while_waiting("timeout=5s&settle=100ms", {{"1.png", twelve}, {"2.png", twelve}}).text,
              testing::HasSubstr("holds 1.png and 2.png after one call"));
  EXPECT_THAT(while_waiting("timeout=400ms&settle=30ms", {{"3.png", twelve.substr(0, 60)}}).text,
              testing::HasSubstr("3.png"));
  EXPECT_THAT(while_waiting("timeout=400ms&settle=30ms&pixel_format=Mono8", {{"4.png", twelve}}).text,
              testing::HasSubstr("more than 8 bits"));
  EXPECT_EQ(while_waiting("timeout=5s&settle=30ms&pixel_format=BayerRG12", {{"5.png", twelve}}).code, Exit::done);
  EXPECT_EQ(refusal_of([&] { open_camera("folder://" + folder.path().string() + "/no", "here"); }).code,
            Exit::unavailable);
  EXPECT_EQ(refusal_of([&] { open_camera("folder://x/y", "here"); }).code, Exit::usage);
}

}  // namespace
