// Cameras of Video4Linux: a device that the test plays behind the driver's own system calls, as the kernel's
// documentation says that it behaves, and in ways that it does not say. Its clock is its own; its pixels say with which
// exposure they were really taken.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <cerrno>
#include <cmath>
#include <deque>
#include <set>

#include "acquisition/device/v4l2_camera.h"
#include "acquisition/refusal_words.h"
#include "acquisition/run/frame_check.h"
#include "base/error.h"
#include "base/random.h"

using namespace gonio;
using namespace gonio::acquisition;
using testing::HasSubstr;
using tests::words_of;

namespace {

constexpr std::uint32_t fourcc(const char (&letters)[5]) {
  return v4l2_fourcc(static_cast<unsigned char>(letters[0]), static_cast<unsigned char>(letters[1]),
                     static_cast<unsigned char>(letters[2]), static_cast<unsigned char>(letters[3]));
}

struct PlayedDevice : VideoCalls {
  std::vector<std::uint32_t> formats{fourcc("MJPG"), fourcc("pRAA"), fourcc("RG10"), fourcc("GREY")};
  std::uint32_t format = fourcc("RG10"), width = 8, height = 4, row_padding = 0;
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::uint32_t stamps = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;  // of the frame's end
  double interval_s = 0.02, clock_s = 1000;
  int late = 0;                        // frames until a new exposure shows
  std::set<std::uint32_t> lost, torn;  // frames by their numbers
  bool keeps_exposure = false, held = false, gone = false;
  int shortest = 1, longest = 5000, step = 1, opened = 0;
  std::function<void(std::uint32_t frame, std::uint8_t* bytes)> fill;
  std::map<std::uint32_t, int> controls{
      {V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_APERTURE_PRIORITY}, {V4L2_CID_EXPOSURE_ABSOLUTE, 100}, {V4L2_CID_GAIN, 0}};

  int open(const std::string& path) override {
    if (path != "/dev/video7") return errno = ENOENT, -1;
    ++opened;
    gone = false;
    return 7;
  }
  void close(int) override { queued_.clear(), filled_.clear(), memory_.clear(), streaming_ = false; }
  void* map(int, std::size_t length, std::int64_t offset) override {
    memory_[static_cast<std::size_t>(offset)].resize(length);
    return memory_[static_cast<std::size_t>(offset)].data();
  }
  void unmap(void*, std::size_t) override {}
  double now_s() override { return clock_s; }
  int wait(int, double seconds) override {
    const double until_s = clock_s + seconds;
    for (run_to(clock_s); filled_.empty(); run_to(clock_s)) {
      if (!streaming_ || done_s(next_) > until_s) return clock_s = until_s, 0;
      clock_s = done_s(next_);
    }
    return 1;
  }
  int control(int, unsigned long request, void* argument) override {
    clock_s += 1e-4;
    errno = gone ? ENODEV : EINVAL;
    if (gone) return -1;
    return answer(request, argument) ? 0 : -1;
  }
  // What the exposure of frame k really was, in steps of 0.1 ms: that in force when the frame `late` before it began.
  int exposure_of(std::uint32_t k) const { return frames_.at(k).second; }

 private:
  // A frame begins once the one before is exposed, and not faster than the interval; it is read out while the next one
  // is exposed.
  double done_s(std::uint32_t k) {
    while (frames_.size() <= k) {
      const double began_s =
          frames_.empty() ? start_s_ : frames_.back().first + std::max(interval_or(0.02), 1e-4 * frames_.back().second);
      const std::size_t behind = static_cast<std::size_t>(late);
      const double since = behind == 0               ? began_s
                           : frames_.size() < behind ? -1
                                                     : frames_[frames_.size() - behind].first;
      int count = 100;
      for (const auto& [changed_s, value] : exposures_)
        if (changed_s <= since) count = value;
      frames_.emplace_back(began_s, count);
    }
    return frames_[k].first + 1e-4 * frames_[k].second + 0.9 * interval_or(0.02);
  }
  double interval_or(double preset) const { return interval_s > 0 ? interval_s : preset; }
  std::uint32_t row_bytes() const {
    return (format == fourcc("GREY") ? width : format == fourcc("pRAA") ? width * 5 / 4 : 2 * width) + row_padding;
  }
  void run_to(double now) {
    for (; streaming_ && done_s(next_) <= now; ++next_) {
      if (lost.contains(next_) || queued_.empty()) continue;
      v4l2_buffer one{};
      one.index = queued_.front();
      queued_.pop_front();
      one.sequence = next_;
      one.flags = stamps | (torn.contains(next_) ? V4L2_BUF_FLAG_ERROR : 0U);
      const double stamp_s = (stamps & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE
                                 ? frames_[next_].first
                                 : done_s(next_);
      one.timestamp = {static_cast<time_t>(stamp_s), static_cast<suseconds_t>(1e6 * (stamp_s - std::floor(stamp_s)))};
      one.bytesused = row_bytes() * height;
      auto& bytes = memory_[one.index * 65536U];
      if (fill) fill(next_, bytes.data());
      for (std::size_t i = 0; !fill && i + 1 < bytes.size(); i += 2)
        bytes[i] = static_cast<std::uint8_t>(exposure_of(next_)),
        bytes[i + 1] = static_cast<std::uint8_t>(exposure_of(next_) >> 8);
      filled_.push_back(one);
    }
  }
  bool buffers(unsigned long request, void* argument) {
    auto& one = *static_cast<v4l2_buffer*>(argument);
    if (request == VIDIOC_QUERYBUF) return one.length = row_bytes() * height, one.m.offset = one.index * 65536U, true;
    if (request == VIDIOC_QBUF) return run_to(clock_s), queued_.push_back(one.index), true;
    run_to(clock_s);
    if (filled_.empty()) return errno = EAGAIN, false;
    one = filled_.front();
    filled_.pop_front();
    return true;
  }
  bool settings(unsigned long request, void* argument) {
    if (request == VIDIOC_QUERYCTRL) {
      auto& said = *static_cast<v4l2_queryctrl*>(argument);
      if (!controls.contains(said.id)) return false;
      const bool exposes = said.id == V4L2_CID_EXPOSURE_ABSOLUTE || said.id == V4L2_CID_EXPOSURE;
      said.minimum = exposes ? shortest : 0;
      said.maximum = exposes ? longest : 240;
      said.step = exposes ? step : 1;
      return true;
    }
    auto& one = *static_cast<v4l2_control*>(argument);
    if (!controls.contains(one.id)) return false;
    if (request == VIDIOC_S_CTRL && !(keeps_exposure && one.id == V4L2_CID_EXPOSURE_ABSOLUTE)) {
      controls[one.id] = one.value;
      if (one.id == V4L2_CID_EXPOSURE_ABSOLUTE) exposures_.emplace_back(clock_s, one.value);
    }
    one.value = controls[one.id];
    return true;
  }
  bool answer(unsigned long request, void* argument) {
    switch (request) {
      case VIDIOC_QUERYCAP: {
        auto& said = *static_cast<v4l2_capability*>(argument);
        said.capabilities = V4L2_CAP_DEVICE_CAPS | capabilities;
        said.device_caps = capabilities;
        std::copy_n("Played camera", 14, said.card);
        std::copy_n("usb-1", 6, said.bus_info);
        return true;
      }
      case VIDIOC_ENUM_FMT: {
        auto& said = *static_cast<v4l2_fmtdesc*>(argument);
        if (said.index >= formats.size()) return false;
        said.pixelformat = formats[said.index];
        return true;
      }
      case VIDIOC_S_FMT:
      case VIDIOC_G_FMT: {
        auto& picture = static_cast<v4l2_format*>(argument)->fmt.pix;
        if (request == VIDIOC_S_FMT && held) return errno = EBUSY, false;
        if (request == VIDIOC_S_FMT) format = picture.pixelformat;  // sizes: it has but one
        picture.width = width, picture.height = height, picture.pixelformat = format;
        picture.bytesperline = row_bytes();
        return true;
      }
      case VIDIOC_G_PARM:
        static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe = {
            static_cast<std::uint32_t>(std::lround(1e6 * interval_s)), 1000000};
        return interval_s > 0;
      case VIDIOC_REQBUFS: return true;
      case VIDIOC_STREAMON: return streaming_ = true, start_s_ = clock_s, next_ = 0, frames_.clear(), true;
      case VIDIOC_STREAMOFF: return streaming_ = false, true;
      case VIDIOC_QUERYBUF:
      case VIDIOC_QBUF:
      case VIDIOC_DQBUF: return buffers(request, argument);
      case VIDIOC_QUERYCTRL:
      case VIDIOC_G_CTRL:
      case VIDIOC_S_CTRL: return settings(request, argument);
      default: return errno = ENOTTY, false;
    }
  }

  bool streaming_ = false;
  double start_s_ = 0;
  std::uint32_t next_ = 0;
  std::deque<std::uint32_t> queued_;
  std::deque<v4l2_buffer> filled_;
  std::map<std::size_t, std::vector<std::uint8_t>> memory_;
  std::vector<std::pair<double, int>> exposures_, frames_;  // since when; begun when, with which
};

std::unique_ptr<CameraDevice> video_camera(const std::shared_ptr<PlayedDevice>& device, V4l2Settings settings = {}) {
  settings.path = "/dev/video7";
  return make_v4l2_camera(settings, device, "lab.json");
}

TEST(DeviceV4l2, FormatsArriveAsTheyWereSent) {
  const auto device = std::make_shared<PlayedDevice>();
  const auto code = [](std::size_t i) { return static_cast<std::uint16_t>(i * 2654435761U >> 7U & 1023U); };
  for (const std::uint32_t padding : {0U, 12U})
    for (const bool packed : {false, true}) {
      device->row_padding = padding;
      device->fill = [&](std::uint32_t, std::uint8_t* bytes) {
        for (std::size_t y = 0; y < 4; ++y)
          for (std::size_t x = 0; x < 8; ++x) {
            const std::uint16_t sample = code(8 * y + x);
            std::uint8_t* row = bytes + y * ((packed ? 10 : 16) + padding);
            if (!packed) {
              row[2 * x] = static_cast<std::uint8_t>(sample), row[2 * x + 1] = static_cast<std::uint8_t>(sample >> 8);
              continue;
            }
            std::uint8_t* five = row + x / 4 * 5;  // MIPI CSI-2 RAW10
            five[x % 4] = static_cast<std::uint8_t>(sample >> 2);
            if (x % 4 == 0) five[4] = 0;
            five[4] = static_cast<std::uint8_t>(five[4] | (sample & 3) << 2 * (x % 4));
          }
      };
      const auto camera = video_camera(device, {.pixel_format = "BayerRG10", .fourcc = packed ? "pRAA" : ""});
      const RawFrame frame = camera->take({0.01, {}});
      EXPECT_EQ(device->format, packed ? fourcc("pRAA") : fourcc("RG10"));
      EXPECT_EQ(frame.pixel_format, "BayerRG10");
      EXPECT_EQ(frame.bits, 10);
      ASSERT_EQ(frame.samples.size(), 32U);
      for (std::size_t i = 0; i < 32; ++i) EXPECT_EQ(frame.samples[i], code(i)) << i << (packed ? " packed" : "");
      EXPECT_EQ(camera->identity(), "Played camera usb-1");
    }
}

// Exposures are drawn at random; every frame has to be the one that was asked for, whatever the time stamps are of.
// How many are not, with `settle` frames left out after a change.
int mislabelled(PlayedDevice& played, int settle, int frames, std::uint64_t seed) {
  const std::shared_ptr<PlayedDevice> device(&played, [](PlayedDevice*) {});
  const auto camera = video_camera(device, {.pixel_format = "BayerRG10", .settle = settle});
  Random random(seed);
  int wrong = 0;
  std::optional<FrameBefore> before;
  for (int n = 0; n < frames; ++n) {
    const Shot shot{1e-4 * (1 + static_cast<double>(random.below(400))), {}};
    device->clock_s += 0.3 * random.uniform();  // the arm moves
    const double asked_s = device->clock_s;
    const RawFrame frame = camera->take(shot);
    EXPECT_EQ(disagreement(frame, shot, "BayerRG10", before, asked_s, device->clock_s), "");
    before = {frame.frame_id, frame.camera_time_s, asked_s, device->clock_s};
    const auto truly = std::lround(1e4 * shot.exposure_s);
    wrong += frame.samples.front() != truly || frame.samples.back() != truly;
  }
  return wrong;
}

TEST(DeviceV4l2, EveryFrameIsTheOneThatWasAsked) {
  for (const std::uint32_t stamps :
       {V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC, V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE,
        V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN})
    for (const int late : {0, 1, 2}) {
      PlayedDevice device;
      device.stamps = stamps;
      device.late = late;
      EXPECT_EQ(mislabelled(device, 2, 60, 5), 0) << stamps << ", late by " << late;
    }
  // What the frames that are left out are for: without them a late exposure is not seen.
  PlayedDevice late;
  late.late = 1;
  EXPECT_GT(mislabelled(late, 0, 60, 5), 30);
  PlayedDevice later;
  later.late = 4;
  EXPECT_EQ(mislabelled(later, 4, 60, 5), 0);
}

TEST(DeviceV4l2, LostAndTornFramesAreSeen) {
  PlayedDevice device;
  Random random(8);
  for (std::uint32_t k = 0; k < 4000; ++k)
    if (random.uniform() < 0.15) device.lost.insert(k);
  device.late = 2;
  EXPECT_EQ(mislabelled(device, 2, 100, 6), 0);

  const auto torn = std::make_shared<PlayedDevice>();
  const auto camera = video_camera(torn);
  const RawFrame first = camera->take({0.01, {}});
  for (std::uint32_t k = 0; k < 1000; ++k) torn->torn.insert(k);
  const RawFrame frame = camera->take({0.01, {}});
  EXPECT_EQ(frame.incomplete_packets, 1);
  EXPECT_TRUE(frame.samples.empty());
  EXPECT_GT(frame.frame_id, first.frame_id);
  EXPECT_THAT(disagreement(frame, {0.01, {}}, "", {}, 0, 1), HasSubstr("packets are missing"));

  const auto losing = std::make_shared<PlayedDevice>();
  const auto other = video_camera(losing, {.timeout_s = 1});
  for (std::uint32_t k = 0; k < 4000; k += 2) losing->lost.insert(k);
  EXPECT_THAT(words_of(
                  [&] {
                    other->take({0.01, {}});
                  },
                  Exit::unavailable),
              testing::AllOf(HasSubstr("lab.json: camera /dev/video7: no sound frame within"), HasSubstr("were lost")));
}

TEST(DeviceV4l2, WhatItCannotIsSaid) {
  const auto device = std::make_shared<PlayedDevice>();
  const auto camera = video_camera(device);
  EXPECT_EQ(device->controls[V4L2_CID_EXPOSURE_AUTO], V4L2_EXPOSURE_MANUAL);
  const auto taking = [&](double exposure_s, std::optional<double> gain_db = {}) {
    return words_of([&] { camera->take({exposure_s, gain_db}); }, Exit::data);
  };
  EXPECT_THAT(taking(2),
              HasSubstr("exposure is 2000 ms, it can 0.1 to 500 ms in steps of 0.1 ms; the nearest is 500ms"));
  EXPECT_THAT(taking(0.00126), HasSubstr("the nearest is 1.3ms"));
  EXPECT_THAT(taking(0.01, 6), HasSubstr("gain is a count without a unit"));
  device->step = 10;
  EXPECT_THAT(taking(0.0105), HasSubstr("the nearest is 10.1ms"));
  const auto graded = video_camera(device, {.gain_step_db = 0.5});
  EXPECT_EQ(graded->take({0.0101, 6}).gain_db, 6);
  EXPECT_THAT(words_of([&] { graded->take({0.0101, 200}); }, Exit::data), HasSubstr("the nearest is 120 dB"));
  EXPECT_THAT(words_of([&] { video_camera(device, {.pixel_format = "Mono12"}); }, Exit::data),
              HasSubstr("has no pixel format Mono12; it has BayerRG10 (pRAA), BayerRG10 (RG10), Mono8 (GREY)"));
  EXPECT_THAT(words_of([&] { video_camera(device, {.width_px = 640}); }, Exit::data),
              HasSubstr("has no pictures of 640 x 4; the nearest is width=8&height=4"));
  device->keeps_exposure = true;
  EXPECT_THAT(words_of(
                  [&] {
                    video_camera(device)->take({0.0201, {}});
                  },
                  Exit::unavailable),
              HasSubstr("keeps exposure_absolute at 101, 201 was asked"));
  device->held = true;
  EXPECT_THAT(words_of([&] { video_camera(device); }, Exit::unavailable),
              HasSubstr("busy; close the program that holds"));
  device->format = fourcc("MJPG");
  EXPECT_THAT(words_of([&] { video_camera(device); }, Exit::data),
              HasSubstr("writes MJPG, which is not as the sensor saw"));
  device->controls.erase(V4L2_CID_EXPOSURE_ABSOLUTE);
  device->controls[V4L2_CID_EXPOSURE] = 3;
  device->held = false, device->format = fourcc("GREY");
  EXPECT_THAT(words_of([&] { video_camera(device); }, Exit::data), HasSubstr("exposure-step=14.8us"));
  EXPECT_NO_THROW(video_camera(device, {.exposure_step_s = 1e-5}));
  device->capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
  EXPECT_THAT(words_of([&] { video_camera(device); }, Exit::data), HasSubstr("in several planes only"));
}

TEST(DeviceV4l2, ACameraThatWentAwayIsOpenedAnew) {
  const auto device = std::make_shared<PlayedDevice>();
  const auto camera = video_camera(device);
  const RawFrame first = camera->take({0.02, {}});
  device->gone = true;
  EXPECT_THAT(words_of(
                  [&] {
                    camera->take({0.02, {}});
                  },
                  Exit::unavailable),
              HasSubstr("No such device; it went away: is it connected?"));
  const RawFrame again = camera->take({0.02, {}});
  EXPECT_EQ(device->opened, 2);
  EXPECT_EQ(again.samples.front(), 200);
  EXPECT_GT(again.frame_id, first.frame_id);  // though the kernel counts from 0 again
}

// The kernel's own calls, as far as they go without a camera.
TEST(DeviceV4l2, WhatIsNoCameraIsRefused) {
  EXPECT_THAT(words_of([] { open_camera("v4l2:///dev/null", "here"); }, Exit::unavailable),
              HasSubstr("camera /dev/null: as a camera: Inappropriate ioctl for device"));
  EXPECT_THAT(words_of([] { open_camera("v4l2:///dev/no-video", "here"); }, Exit::unavailable),
              HasSubstr("camera /dev/no-video: No such file"));
  EXPECT_THAT(words_of([] { open_camera("v4l2://video0", "here"); }, Exit::usage),
              HasSubstr("write v4l2:///dev/video0"));
  EXPECT_THAT(words_of([] { open_camera("v4l2:///dev/video0?pixel_format=RGB8", "here"); }, Exit::usage),
              HasSubstr("pixel_format is 'RGB8'"));
}

}  // namespace
