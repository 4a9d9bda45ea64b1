// See v4l2_camera.h. Requests, flags and units: The Linux Media Infrastructure userspace API, part I, and videodev2.h.
#include "acquisition/device/v4l2_camera.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "acquisition/device/frame_count.h"
#include "acquisition/device/unpack.h"
#include "acquisition/device/v4l2_device.h"
#include "acquisition/device/v4l2_formats.h"

namespace gonio::acquisition {
namespace {

constexpr double absolute_step_s = 1e-4;  // of V4L2_CID_EXPOSURE_ABSOLUTE

class V4l2Camera : public CameraDevice, V4l2Device {
 public:
  V4l2Camera(V4l2Settings settings, std::shared_ptr<VideoCalls> calls, std::string place)
      : V4l2Device(std::move(settings), std::move(calls), std::move(place)) {
    or_close([this] { open(); });
  }

  std::string identity() override {
    const std::scoped_lock lock(one_at_a_time_);
    return or_close([this] {
      if (file_ < 0) open();
      return name_;
    });
  }

  RawFrame take(const Shot& shot) override {
    const std::scoped_lock lock(one_at_a_time_);
    return or_close([&] {
      if (file_ < 0) open();
      set_exposure(shot.exposure_s);
      if (shot.gain_db) set_gain(*shot.gain_db);
      return fresh_frame();
    });
  }

 private:
  // What failed is not believed any more; the next frame opens the device anew.
  template <class Work>
  auto or_close(const Work& work) -> decltype(work()) {
    try {
      return work();
    } catch (...) {
      close();
      throw;
    }
  }

  void open() {
    close();
    file_ = calls_->open(settings_.path);
    if (file_ < 0) throw failure(std::strerror(errno), "is it connected? v4l2-ctl --list-devices shows what is there");
    v4l2_capability has{};
    ask("as a camera", VIDIOC_QUERYCAP, has);
    const auto text = [](const __u8* bytes, std::size_t size) {
      const char* const begin = reinterpret_cast<const char*>(bytes);
      return std::string(begin, std::find(begin, begin + size, '\0'));
    };
    name_ = text(has.card, sizeof has.card) + " " + text(has.bus_info, sizeof has.bus_info);
    const auto can_do = (has.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? has.device_caps : has.capabilities;
    if ((can_do & V4L2_CAP_VIDEO_CAPTURE) == 0)
      throw impossible((can_do & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0 ? "sends its pictures in several planes only"
                                                                     : "takes no pictures",
                       "another /dev/video of the same camera");
    if ((can_do & V4L2_CAP_STREAMING) == 0) throw impossible("does not stream", "another camera");
    choose_format();
    settle_controls();
    start_buffers();
    count_.restarted();
    changed_ = true;
  }

  // The format that was asked for; of two that hold the same the one that is not packed. Nothing was asked: the one
  // that it has now. `usable`: all that it has.
  std::optional<std::uint32_t> fitting_format(std::uint32_t now, std::string& usable) {
    const auto asked = parse_pixel_format(settings_.pixel_format);
    const bool any = !asked && settings_.fourcc.empty();
    std::optional<std::uint32_t> chosen;
    v4l2_fmtdesc one{};
    one.type = v4l2_capture;
    for (; can(VIDIOC_ENUM_FMT, one); ++one.index) {
      const auto known = format_of_fourcc(one.pixelformat);
      if (!known) continue;
      usable += (usable.empty() ? "" : ", ") + known->unpacked() + " (" + letters_of(one.pixelformat) + ")";
      const bool fits = any ? one.pixelformat == now
                            : (!asked || known->unpacked() == asked->unpacked()) &&
                                  (settings_.fourcc.empty() || letters_of(one.pixelformat) == settings_.fourcc);
      if (fits && (!chosen || known->packing == PixelFormat::Packing::whole)) chosen = one.pixelformat;
    }
    return chosen;
  }

  void choose_format() {
    v4l2_format format{};
    format.type = v4l2_capture;
    ask("its format", VIDIOC_G_FMT, format);
    v4l2_pix_format& picture = format.fmt.pix;
    std::string usable;
    const auto chosen = fitting_format(picture.pixelformat, usable);
    if (!chosen)
      throw impossible(settings_.pixel_format.empty() && settings_.fourcc.empty()
                           ? "writes " + letters_of(picture.pixelformat) + ", which is not as the sensor saw it"
                           : "has no pixel format " + settings_.pixel_format + settings_.fourcc,
                       usable.empty() ? "it has none as the sensor sees it" : "it has " + usable);
    picture.pixelformat = *chosen;
    if (settings_.width_px > 0) picture.width = static_cast<std::uint32_t>(settings_.width_px);
    if (settings_.height_px > 0) picture.height = static_cast<std::uint32_t>(settings_.height_px);
    picture.bytesperline = 0;  // as it likes
    const v4l2_pix_format wanted = picture;
    ask("its format", VIDIOC_S_FMT, format);
    if (picture.pixelformat != *chosen)
      throw failure("stays at format " + letters_of(picture.pixelformat), "it was asked for " + letters_of(*chosen));
    if (picture.width != wanted.width || picture.height != wanted.height)
      throw impossible(gonio::format("has no pictures of %u x %u", wanted.width, wanted.height),
                       gonio::format("the nearest is width=%u&height=%u", picture.width, picture.height));
    picture_ = picture;
    format_ = *format_of_fourcc(*chosen);
  }

  // Nothing that changes a frame on its own.
  void settle_controls() {
    switch_off(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL, "exposure_auto");
    switch_off(V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0, "exposure_auto_priority");
    switch_off(V4L2_CID_AUTOGAIN, 0, "autogain");
    switch_off(V4L2_CID_AUTO_WHITE_BALANCE, 0, "auto_white_balance");
    exposure_ = {V4L2_CID_EXPOSURE_ABSOLUTE, absolute_step_s, "exposure_absolute"};
    if (!limits_of(exposure_.id)) exposure_ = {V4L2_CID_EXPOSURE, settings_.exposure_step_s, "exposure"};
    if (!limits_of(exposure_.id)) throw impossible("its exposure cannot be set", "another camera");
    if (!(exposure_.step > 0))
      throw impossible("its exposure is a count without a unit", "exposure-step=14.8us, the time that one is");
    gain_ = {V4L2_CID_ANALOGUE_GAIN, settings_.gain_step_db, "analogue_gain"};
    if (!limits_of(gain_.id)) gain_ = {V4L2_CID_GAIN, settings_.gain_step_db, "gain"};
    has_gain_ = limits_of(gain_.id).has_value();
    exposure_s_ = longest_s_ = value_of(exposure_.id, exposure_.name) * exposure_.step;
    v4l2_streamparm rate{};
    rate.type = v4l2_capture;
    const v4l2_fract& every = rate.parm.capture.timeperframe;
    interval_s_ = can(VIDIOC_G_PARM, rate) && every.denominator > 0
                      ? static_cast<double>(every.numerator) / static_cast<double>(every.denominator)
                      : 0;
  }

  struct Control {  // a number of steps
    std::uint32_t id = 0;
    double step = 0;
    const char* name = "";
  };
  // Sets the nearest that the camera has; its count.
  int nearest(const Control& control, double wanted) {
    const Limits can_be = limits_of(control.id).value_or(Limits{});
    const double steps = (wanted / control.step - can_be.lower) / can_be.step;
    return can_be.lower +
           can_be.step * static_cast<int>(std::lround(
                             std::clamp(steps, 0.0, static_cast<double>((can_be.upper - can_be.lower) / can_be.step))));
  }
  void change(const Control& control, int count) {
    if (value_of(control.id, control.name) == count) return;
    set(control.id, count, control.name);
    changed_ = true;
  }

  void set_exposure(double exposure_s) {
    const int count = nearest(exposure_, exposure_s);
    const double is_s = count * exposure_.step;
    if (!(std::abs(is_s - exposure_s) <= std::max(0.01 * exposure_s, 2e-6))) {
      const Limits can_be = limits_of(exposure_.id).value_or(Limits{});
      throw impossible(format("exposure is %.6g ms, it can %.6g to %.6g ms in steps of %.6g ms", 1e3 * exposure_s,
                              1e3 * can_be.lower * exposure_.step, 1e3 * can_be.upper * exposure_.step,
                              1e3 * can_be.step * exposure_.step),
                       format("the nearest is %.6gms", 1e3 * is_s));
    }
    longest_s_ = std::max(is_s, changed_ ? longest_s_ : exposure_s_);
    change(exposure_, count);
    exposure_s_ = is_s;
  }
  void set_gain(double gain_db) {
    if (!has_gain_) throw impossible("its gain cannot be set", "leave gain_db out");
    if (!(gain_.step > 0))
      throw impossible("its gain is a count without a unit", "gain-step=0.1, the dB that one is, or leave gain_db out");
    const int count = nearest(gain_, gain_db);
    if (!(std::abs(count * gain_.step - gain_db) <= 0.1))
      throw impossible(format("has no gain of %g dB", gain_db), format("the nearest is %g dB", count * gain_.step));
    change(gain_, count);
  }

  // Did its exposure begin after `since_s`? What the time stamp is of, the flags say: the start of the exposure, or its
  // frame's end, which readout and exposure come before. Nothing: the kernel does not say when it was.
  std::optional<bool> began_after(const v4l2_buffer& buffer, double since_s) const {
    if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) return {};
    const double stamp_s = stamp_of(buffer);
    if ((buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE) return stamp_s >= since_s;
    if (!(interval_s_ > 0)) return {};
    return stamp_s - interval_s_ - longest_s_ >= since_s;
  }
  static double stamp_of(const v4l2_buffer& buffer) {
    return static_cast<double>(buffer.timestamp.tv_sec) + 1e-6 * static_cast<double>(buffer.timestamp.tv_usec);
  }

  // Of frames whose time is not known, the first two that come are left out: one that had come, one that was exposed.
  RawFrame fresh_frame() {
    const double since_s = calls_->now_s();
    v4l2_buffer buffer{};
    while (take_buffer(buffer)) give_back(buffer.index);  // came before the call
    const int settle = changed_ ? settings_.settle : 0;
    const double frame_s = std::max(interval_s_, longest_s_);
    const double until_s = since_s + (settle + 4) * frame_s + exposure_s_ + settings_.timeout_s;
    std::int64_t lost = 0;
    std::optional<std::uint32_t> last;
    for (int unknown = 0, settled = 0;;) {
      const double left_s = until_s - calls_->now_s();
      if (left_s <= 0) throw failure(silence(until_s - since_s, lost), "is its USB port fast enough? timeout= longer");
      const int ready = calls_->wait(file_, left_s);
      if (ready < 0) throw refused("waiting");
      if (ready == 0 || !take_buffer(buffer)) continue;
      const std::uint32_t gap = last ? buffer.sequence - *last - 1 : 0;
      const bool damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
      last = buffer.sequence;
      lost += gap;
      const auto began = began_after(buffer, since_s);
      const bool early = began ? !*began : unknown++ < 2;
      if (!early && damaged && settled >= settle) break;  // said as it is: a run takes it again
      if (!early && (gap > 0 || damaged))
        settled = 0;
      else if (!early && settled++ >= settle)
        break;
      give_back(buffer.index);
    }
    RawFrame frame = frame_of(buffer);
    give_back(buffer.index);
    changed_ = false;
    longest_s_ = exposure_s_;
    return frame;
  }

  std::string silence(double waited_s, std::int64_t lost) const {
    return format("no sound frame within %.3g s", waited_s) +
           (lost > 0 ? ", " + std::to_string(lost) + " were lost" : "");
  }

  RawFrame frame_of(const v4l2_buffer& buffer) {
    RawFrame frame;
    frame.bits = format_.bits;
    frame.pixel_format = format_.unpacked();
    frame.frame_id = count_.number_of(buffer.sequence);
    if ((buffer.flags & V4L2_BUF_FLAG_ERROR) != 0) {
      frame.incomplete_packets = 1;  // no pixels: nobody knows which of them are of this frame
      return frame;
    }
    frame.width_px = static_cast<int>(picture_.width);
    frame.height_px = static_cast<int>(picture_.height);
    const auto row_bytes = (picture_.width * static_cast<std::uint32_t>(format_.bits_per_pixel()) + 7) / 8;
    const auto& [memory, length] = buffers_[buffer.index];
    const std::uint32_t after_row = picture_.bytesperline > row_bytes ? picture_.bytesperline - row_bytes : 0;
    frame.samples = unpack({memory, std::min<std::size_t>(buffer.bytesused, length)}, frame.width_px, frame.height_px,
                           static_cast<int>(after_row), format_, place_);
    if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC)
      frame.camera_time_s = stamp_of(buffer);
    frame.exposure_s = value_of(exposure_.id, exposure_.name) * exposure_.step;
    if (has_gain_ && gain_.step > 0) frame.gain_db = value_of(gain_.id, gain_.name) * gain_.step;
    return frame;
  }

  std::mutex one_at_a_time_;
  std::string name_;
  v4l2_pix_format picture_{};
  PixelFormat format_;
  Control exposure_, gain_;
  bool has_gain_ = false, changed_ = true;
  // longest_s_: that a frame may have been exposed for, before the last change shows.
  double interval_s_ = 0, exposure_s_ = 0, longest_s_ = 0;
  FrameCount count_;
};

}  // namespace

std::unique_ptr<CameraDevice> make_v4l2_camera(V4l2Settings settings, std::shared_ptr<VideoCalls> calls,
                                               const std::string& place) {
  return std::make_unique<V4l2Camera>(std::move(settings), std::move(calls), place);
}

}  // namespace gonio::acquisition
