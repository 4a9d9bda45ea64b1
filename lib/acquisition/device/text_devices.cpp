#include "acquisition/device/text_devices.h"

#include <atomic>
#include <charconv>
#include <cmath>
#include <numbers>
#include <thread>
#include <utility>

#include "acquisition/device/connection.h"
#include "base/error.h"
#include "base/text.h"

namespace gonio::acquisition {
namespace {

Error text_refusal(const TextLine& line, const std::string& problem, const std::string& remedy) {
  return Error(Exit::unavailable, line.place, line.what + ": " + problem, remedy);
}

class TextLamp : public LampDevice {
 public:
  TextLamp(TextLine line, UrlQuery& query) : line_(std::move(line)) {
    on_ = query.required("on", "what switches it on");
    off_ = query.required("off", "what switches it off");
    answer_ = query.text("answer");
    state_ = query.text("state");
    state_on_ = query.text("state-on", "1");
    state_off_ = query.text("state-off", "0");
    query.end();
    if (answer_.empty() && state_.empty() && !line_.acknowledges)
      throw Error(Exit::usage, line_.place, line_.what + ": nothing says whether the lamp is lit",
                  "add answer=, what it answers to on and off, or state=, what asks it");
  }
  void set(bool on) override {
    known_ = -1;
    const std::string got = line_.ask({on ? on_ : off_, {}, {}, !answer_.empty()});
    if (!answer_.empty() && got != answer_)
      throw text_refusal(line_, "answered '" + got + "' instead of '" + answer_ + "'", "look at the lamp's controller");
    known_ = on;
    if (!state_.empty() && is_on() != on)
      throw text_refusal(line_, std::string("lamp stays ") + (on ? "off" : "on") + " after it was switched",
                         "look at the lamp and its supply");
  }
  bool is_on() override {
    if (state_.empty()) {
      if (known_ < 0)
        throw text_refusal(line_, "nobody has switched the lamp yet, and it cannot be asked", "add state=");
      return known_ != 0;
    }
    const std::string got = line_.ask({state_, {}, {}, true});
    if (got == state_on_ || got == state_off_) return got == state_on_;
    throw text_refusal(line_, "says '" + got + "', neither '" + state_on_ + "' nor '" + state_off_ + "'",
                       "state-on= and state-off= are what it answers");
  }
  bool answers() const override { return !state_.empty(); }
  bool knows() const override { return !state_.empty() || known_ >= 0; }

 private:
  TextLine line_;
  std::string on_, off_, answer_, state_, state_on_, state_off_;
  int known_ = -1;
};

class TextTurntable : public TurntableDevice {
 public:
  TextTurntable(TextLine line, UrlQuery& query) : line_(std::move(line)) {
    turn_ = query.required("turn", "what turns it, with {deg} in it");
    angle_ = query.required("angle", "what asks for its angle");
    stop_ = query.required("stop", "what stops it");
    scale_ = query.quantity("scale", Dimension::angle, std::numbers::pi / 180, -10, 10);
    tolerance_rad_ = query.quantity("tolerance", Dimension::angle, 1e-3, 1e-9, 1);
    stall_s_ = query.quantity("stall", Dimension::time, 5, 1e-3, 3600);
    query.end();
    if (turn_.find("{deg}") == std::string::npos)
      throw Error(Exit::usage, line_.place, line_.what + ": turn=" + turn_ + " has no {deg}", "as G0 A{deg}");
  }
  double angle_rad() override {
    const std::string got = line_.ask({angle_, {}, {}, true});
    double number = 0;
    const auto [end, wrong] = std::from_chars(got.data(), got.data() + got.size(), number);
    if (wrong != std::errc{} || end != got.data() + got.size() || !std::isfinite(number))
      throw text_refusal(line_, "says that its angle is '" + got + "'", "the answer to angle= must be a number alone");
    return number * scale_;
  }
  double turn_to(double angle_rad) override {
    const int stops_before = stops_;
    line_.ask({turn_, "{deg}", format("%.6f", angle_rad * 180 / std::numbers::pi)});
    double last = this->angle_rad();
    for (auto moved = Clock::now();;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      const double now = this->angle_rad();
      if (stops_ != stops_before) throw text_refusal(line_, "turntable was stopped on request", {});
      if (now == last && std::abs(now - angle_rad) <= tolerance_rad_) return now;
      if (now != last) moved = Clock::now();
      last = now;
      if (Clock::now() <= moved + std::chrono::duration<double>(stall_s_)) continue;
      line_.ask({stop_});
      throw text_refusal(
          line_, format("turntable stands at %.6f rad instead of %.6f (limit %g)", now, angle_rad, tolerance_rad_),
          "look at the turntable and at scale= in its URL");
    }
  }
  void stop() override {
    ++stops_;
    line_.ask({stop_});
    const auto until = after(stall_s_);
    for (double last = angle_rad(), now = 0;; last = now) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      now = angle_rad();
      if (std::abs(now - last) <= 0) return;
      if (Clock::now() > until) throw text_refusal(line_, "turntable does not come to a stand", "switch it off");
    }
  }

 private:
  TextLine line_;
  std::string turn_, angle_, stop_;
  double scale_ = 1, tolerance_rad_ = 1e-3, stall_s_ = 5;
  std::atomic<int> stops_{0};
};

class TextScreen : public ScreenDevice {
 public:
  TextScreen(TextLine line, UrlQuery& query) : line_(std::move(line)) {
    show_ = query.required("show", "what shows a picture, with {file} in it");
    black_ = query.required("black", "what shows nothing");
    query.end();
    if (show_.find("{file}") == std::string::npos)
      throw Error(Exit::usage, line_.place, line_.what + ": show=" + show_ + " has no {file}", "as --show {file}");
  }
  void show(const std::string& picture_path) override {
    if (picture_path.empty())
      line_.ask({black_});
    else
      line_.ask({show_, "{file}", picture_path});
  }

 private:
  TextLine line_;
  std::string show_, black_;
};

}  // namespace

std::unique_ptr<LampDevice> make_text_lamp(TextLine line, UrlQuery& query) {
  return std::make_unique<TextLamp>(std::move(line), query);
}
std::unique_ptr<TurntableDevice> make_text_turntable(TextLine line, UrlQuery& query) {
  return std::make_unique<TextTurntable>(std::move(line), query);
}
std::unique_ptr<ScreenDevice> make_text_screen(TextLine line, UrlQuery& query) {
  return std::make_unique<TextScreen>(std::move(line), query);
}

}  // namespace gonio::acquisition
