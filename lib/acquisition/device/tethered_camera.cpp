// See tethered_camera.h.
#include "acquisition/device/tethered_camera.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>

#include "acquisition/device/connection.h"
#include "acquisition/device/raw_file.h"
#include "base/error.h"
#include "base/lower_case.h"
#include "base/text.h"
#include "io/camera_raw.h"

namespace gonio::acquisition {
namespace {

constexpr const char* camera_there = "is it on, connected, and held by no other program (a desktop opens cameras)?";

// A number above 0 at the beginning of `text`, which loses it.
std::optional<double> leading_number(std::string_view& text) {
  double number = 0;
  const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (wrong != std::errc{} || !std::isfinite(number) || number < 0) return {};
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

std::optional<double> iso_of(const std::string& words) {
  std::string_view rest = words;
  const auto number = leading_number(rest);
  return number && rest.empty() && *number > 0 ? number : std::nullopt;
}

// "RAW", "NEF (Raw)": the sensor's numbers alone. Not "RAW + Large Fine JPEG", and not "cRAW", "mRAW", "sRAW", which
// are squeezed or made of colours.
bool writes_raw_alone(const std::string& choice) {
  const std::string text = lower_case(choice);
  if (text.find('+') != std::string::npos || text.find("jp") != std::string::npos) return false;
  const auto letter = [](char c) { return c >= 'a' && c <= 'z'; };
  for (auto at = text.find("raw"); at != std::string::npos; at = text.find("raw", at + 1))
    if ((at == 0 || !letter(text[at - 1])) && (at + 3 == text.size() || !letter(text[at + 3]))) return true;
  return false;
}

std::string listed_choices(const std::vector<std::string>& choices,
                           std::optional<double> (*number_of)(const std::string&)) {
  std::string list;
  for (const std::string& choice : choices)
    if (number_of == nullptr || number_of(choice)) list += (list.empty() ? "" : ", ") + choice;
  return list.empty() ? "it has none" : "it has " + list;
}

class TetheredCamera : public CameraDevice {
 public:
  TetheredCamera(TetherSettings settings, std::function<std::unique_ptr<CameraCable>()> connect, std::string place)
      : settings_(std::move(settings)), connect_(std::move(connect)), place_(std::move(place)) {
    or_disconnect([this] { this->connect(); });
  }

  std::string identity() override {
    const std::scoped_lock lock(one_at_a_time_);
    return or_disconnect([this] {
      if (!cable_) connect();
      return cable_->identity();
    });
  }

  RawFrame take(const Shot& shot) override {
    const std::scoped_lock lock(one_at_a_time_);
    return or_disconnect([&] {
      if (!cable_) connect();
      choose_exposure(shot.exposure_s);
      choose_gain(shot.gain_db);
      cable_->forget_files();
      return raw_of(cable_->shoot(shot.exposure_s + settings_.timeout_s));
    });
  }

 private:
  Error failure(const std::string& problem, const std::string& remedy) const {
    return Error(Exit::unavailable, place_, "camera " + settings_.name + ": " + problem, remedy);
  }
  Error impossible(const std::string& problem, const std::string& remedy) const {
    return Error(Exit::data, place_, "camera " + settings_.name + ": " + problem, remedy);
  }
  // What failed is not believed any more; the next call connects anew.
  template <class Work>
  auto or_disconnect(const Work& work) -> decltype(work()) {
    try {
      return work();
    } catch (const Lost& lost) {
      cable_.reset();
      throw failure(lost.what(), camera_there);
    }
  }

  void connect() {
    cable_.reset();
    cable_ = connect_();
    // Nikon and most others; Canon. A dial cannot be turned from here.
    for (const char* dial : {"expprogram", "autoexposuremode"})
      if (const auto mode = cable_->value(dial); mode && lower_case(*mode) != "m" && lower_case(*mode) != "manual")
        throw impossible("its dial stands at " + *mode, "turn it to M: nothing else keeps an exposure");
    if (cable_->value("capturetarget"))
      for (const std::string& where : cable_->choices("capturetarget"))
        if (lower_case(where).find("ram") != std::string::npos) set("capturetarget", where);
    write_raw();
    speed_ = !cable_->choices("shutterspeed2").empty() ? "shutterspeed2" : "shutterspeed";
    if (cable_->choices(speed_).empty()) throw impossible("its shutter speed cannot be set", "turn its dial to M");
  }

  void write_raw() {
    for (const char* setting : {"imageformat", "imagequality"}) {
      const auto now = cable_->value(setting);
      const auto choices = cable_->choices(setting);
      if (!now || choices.empty()) continue;
      const auto found = settings_.quality.empty() ? std::ranges::find_if(choices, writes_raw_alone)
                                                   : std::ranges::find(choices, settings_.quality);
      if (found == choices.end())
        throw impossible(settings_.quality.empty() ? "writes no raw files" : "has no quality " + settings_.quality,
                         "quality= the one that writes raw files: " + listed_choices(choices, nullptr));
      return set(setting, *found);
    }
  }

  void set(const std::string& setting, const std::string& choice) {
    if (cable_->value(setting) == choice) return;
    cable_->choose(setting, choice);
    if (const auto kept = cable_->value(setting); kept != choice)
      throw failure("keeps " + setting + " at " + kept.value_or("nothing") + ", " + choice + " was asked",
                    "does its dial allow it? M does");
  }

  void choose_exposure(double exposure_s) {
    const auto choices = cable_->choices(speed_);
    const auto nearest = nearest_choice(choices, exposure_s, shutter_speed_s);
    if (!nearest || std::abs(*shutter_speed_s(*nearest) / exposure_s - 1) > 0.01)
      throw impossible("has no shutter speed of " + shortest_text(exposure_s) + " s",
                       listed_choices(choices, shutter_speed_s));
    set(speed_, *nearest);
    exposure_s_ = shutter_speed_s(*nearest);
  }

  void choose_gain(std::optional<double> gain_db) {
    const auto choices = cable_->choices("iso");
    if (gain_db) {
      const double iso = settings_.base_iso * std::pow(10, *gain_db / 20);
      const auto nearest = nearest_choice(choices, iso, iso_of);
      if (!nearest || std::abs(gain_of_iso(*iso_of(*nearest), settings_.base_iso) - *gain_db) > 0.1)
        throw impossible(format("has no ISO %.4g, a gain of %g dB over ISO %g", iso, *gain_db, settings_.base_iso),
                         listed_choices(choices, iso_of));
      set("iso", *nearest);
    }
    const auto now = cable_->value("iso");
    if (now && !iso_of(*now))
      throw impossible("its ISO stands at " + *now, "give gain_db, or set an ISO on the camera");
    gain_db_ = now ? std::optional(gain_of_iso(*iso_of(*now), settings_.base_iso)) : std::nullopt;
  }

  RawFrame raw_of(const std::vector<CameraCable::File>& files) {
    std::string names;
    const CameraCable::File* raw = nullptr;
    for (const CameraCable::File& file : files) {
      names += (names.empty() ? "" : ", ") + file.name;
      if (!io::is_camera_raw(file.name)) continue;
      if (raw != nullptr)
        throw failure("made " + raw->name + " and " + file.name + " of one call", "no bursts, no brackets");
      raw = &file;
    }
    if (raw == nullptr)
      throw failure("made " + (names.empty() ? "no picture" : names + ", and no raw file"),
                    "has it room, and does it focus? set M on camera and lens; quality= one that writes raw files");
    RawFrame frame = frame_of_raw_file(raw->bytes, raw->name, settings_.pixel_format, settings_.base_iso);
    if (!frame.exposure_s) frame.exposure_s = exposure_s_;
    if (!frame.gain_db) frame.gain_db = gain_db_;
    frame.frame_id = ++count_;
    return frame;
  }

  TetherSettings settings_;
  std::function<std::unique_ptr<CameraCable>()> connect_;
  std::string place_, speed_;
  std::mutex one_at_a_time_;
  std::unique_ptr<CameraCable> cable_;
  std::optional<double> exposure_s_, gain_db_;
  std::uint64_t count_ = 0;
};

}  // namespace

std::optional<double> shutter_speed_s(const std::string& words) {
  std::string_view rest = words;
  auto seconds = leading_number(rest);
  if (!seconds) return {};
  if (rest.starts_with('/')) {
    rest.remove_prefix(1);
    const auto below = leading_number(rest);
    if (!below || !(*below > 0)) return {};
    *seconds /= *below;
  } else if (rest.starts_with('"')) {  // 2" is two seconds, 0"3 three tenths
    rest.remove_prefix(1);
    const std::string tenths = "0." + std::string(rest);
    std::string_view digits = tenths;
    if (!rest.empty()) {
      const auto more = leading_number(digits);
      if (!more || !digits.empty()) return {};
      *seconds += *more;
      rest = {};
    }
  }
  if (rest == "s" || rest == " s") rest = {};
  if (!rest.empty() || !(*seconds > 1e-7) || *seconds > 86400) return {};
  return seconds;
}

std::optional<std::string> nearest_choice(const std::vector<std::string>& choices, double wanted,
                                          std::optional<double> (*number_of)(const std::string&)) {
  std::optional<std::string> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const std::string& choice : choices) {
    const auto number = number_of(choice);
    if (!number || !(wanted > 0)) continue;
    const double off = std::abs(std::log(*number / wanted));
    if (off < least) least = off, nearest = choice;
  }
  return nearest;
}

std::unique_ptr<CameraDevice> make_tethered_camera(TetherSettings settings,
                                                   std::function<std::unique_ptr<CameraCable>()> connect,
                                                   const std::string& place) {
  return std::make_unique<TetheredCamera>(std::move(settings), std::move(connect), place);
}

}  // namespace gonio::acquisition
