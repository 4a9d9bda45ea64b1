// Video4Linux's requests with their errors as ours, a device's buffers, and what is set on it. Private to device/.
#pragma once
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/device/v4l2_camera.h"
#include "base/error.h"
#include "base/text.h"

namespace gonio::acquisition {

inline constexpr auto v4l2_capture = static_cast<std::uint32_t>(V4L2_BUF_TYPE_VIDEO_CAPTURE);
inline constexpr std::uint32_t v4l2_buffers = 4;

class V4l2Device {
 protected:
  V4l2Device(V4l2Settings settings, std::shared_ptr<VideoCalls> calls, std::string place)
      : settings_(std::move(settings)), calls_(std::move(calls)), place_(std::move(place)) {}
  ~V4l2Device() { close(); }

  Error failure(const std::string& problem, const std::string& remedy) const {
    return Error(Exit::unavailable, place_, "camera " + settings_.path + ": " + problem, remedy);
  }
  Error impossible(const std::string& problem, const std::string& remedy) const {
    return Error(Exit::data, place_, "camera " + settings_.path + ": " + problem, remedy);
  }
  Error refused(const std::string& request) const {
    const int why = errno;
    return failure(request + ": " + std::strerror(why), why == EBUSY    ? "close the program that holds it"
                                                        : why == ENODEV ? "it went away: is it connected?"
                                                                        : "is it a camera, and connected?");
  }

  // False where the device does not know the request, or has no more of what it asks for.
  template <class Argument>
  bool can(unsigned long request, Argument& argument) {
    return calls_->control(file_, request, &argument) >= 0;
  }
  template <class Argument>
  void ask(const char* name, unsigned long request, Argument& argument) {
    if (!can(request, argument)) throw refused(name);
  }

  struct Limits {
    int lower = 0, upper = 0, step = 1;
  };
  std::optional<Limits> limits_of(std::uint32_t control) {
    v4l2_queryctrl said{};
    said.id = control;
    if (!can(VIDIOC_QUERYCTRL, said)) {
      if (errno != EINVAL && errno != ENOTTY) throw refused("what it can");
      return {};
    }
    if ((said.flags & V4L2_CTRL_FLAG_DISABLED) != 0) return {};
    return Limits{said.minimum, said.maximum, std::max(1, said.step)};
  }
  int value_of(std::uint32_t control, const char* name) {
    v4l2_control now{control, 0};
    ask(name, VIDIOC_G_CTRL, now);
    return now.value;
  }
  void set(std::uint32_t control, int value, const char* name) {
    v4l2_control wanted{control, value};
    ask(name, VIDIOC_S_CTRL, wanted);
    if (const int kept = value_of(control, name); kept != value)
      throw failure(format("keeps %s at %d, %d was asked", name, kept, value), "does another program set it?");
  }
  // Where the camera has it.
  void switch_off(std::uint32_t control, int value, const char* name) {
    if (limits_of(control)) set(control, value, name);
  }

  void start_buffers() {
    v4l2_requestbuffers wanted{};
    wanted.count = v4l2_buffers;
    wanted.type = v4l2_capture;
    wanted.memory = V4L2_MEMORY_MMAP;
    ask("its buffers", VIDIOC_REQBUFS, wanted);
    for (std::uint32_t i = 0; i < wanted.count; ++i) {
      v4l2_buffer one = numbered(i);
      ask("a buffer", VIDIOC_QUERYBUF, one);
      void* const memory = calls_->map(file_, one.length, one.m.offset);
      if (memory == nullptr) throw refused("a buffer's memory");
      buffers_.emplace_back(static_cast<const std::uint8_t*>(memory), one.length);
      give_back(i);
    }
    auto type = static_cast<int>(v4l2_capture);
    ask("starting", VIDIOC_STREAMON, type);
    streaming_ = true;
  }
  static v4l2_buffer numbered(std::uint32_t i) {
    v4l2_buffer one{};
    one.index = i;
    one.type = v4l2_capture;
    one.memory = V4L2_MEMORY_MMAP;
    return one;
  }
  void give_back(std::uint32_t i) {
    v4l2_buffer one = numbered(i);
    ask("a buffer", VIDIOC_QBUF, one);
  }
  // A buffer that is filled; false: there is none yet.
  bool take_buffer(v4l2_buffer& filled) {
    filled = numbered(0);
    if (can(VIDIOC_DQBUF, filled)) {
      if (filled.index >= buffers_.size()) throw failure("fills a buffer that it was not given", {});
      return true;
    }
    if (errno == EAGAIN) return false;
    throw refused("a frame");
  }

  void close() {
    auto type = static_cast<int>(v4l2_capture);
    if (streaming_) can(VIDIOC_STREAMOFF, type);
    streaming_ = false;
    for (const auto& [memory, length] : buffers_) calls_->unmap(const_cast<std::uint8_t*>(memory), length);
    buffers_.clear();
    if (file_ >= 0) calls_->close(file_);
    file_ = -1;
  }

  V4l2Settings settings_;
  std::shared_ptr<VideoCalls> calls_;
  std::string place_;
  int file_ = -1;
  bool streaming_ = false;
  std::vector<std::pair<const std::uint8_t*, std::size_t>> buffers_;
};

}  // namespace gonio::acquisition
