// See frame_check.h.
#include "acquisition/run/frame_check.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "acquisition/device/unpack.h"
#include "base/text.h"
#include "stats/intervals.h"

namespace gonio::acquisition {
namespace {

std::string milliseconds_text(double s) {
  return format("%.4g ms", 1e3 * s);
}

// The camera's clock between two exposures against what the host knows of them: either began between being asked for
// and having come.
std::string wrong_time(const RawFrame& frame, const FrameBefore& before, double asked_s, double came_s,
                       const FrameRules& rules) {
  if (!frame.camera_time_s || !before.camera_time_s) return {};
  const double passed = *frame.camera_time_s - *before.camera_time_s;
  const double least = asked_s - before.came_s, most = came_s - before.asked_s;
  const double slack = rules.clock_step_s + rules.clock_tolerance * std::abs(most);
  if (passed >= least - slack && passed <= most + slack) return {};
  return format("its time stamp is %.3f s after the frame before, the host says %.3f to %.3f s", passed, least, most);
}

}  // namespace

FrameFigures figures_of(const RawFrame& frame, double white, bool mosaic) {
  FrameFigures f;
  const auto width = static_cast<std::size_t>(frame.width_px);
  const std::size_t count = frame.samples.size(), apart = mosaic ? 2 : 1;
  if (count == 0 || width == 0) return f;
  double sum = 0, squares = 0, steps = 0, saturated = 0;
  std::size_t pairs = 0;
  std::vector<double> differences;
  for (std::size_t i = 0; i < count; ++i) {
    const double code = frame.samples[i];
    sum += code;
    squares += code * code;
    if (code >= white) ++saturated;
    if (i % width < apart) continue;
    const double step = code - frame.samples[i - apart];
    steps += step * step;
    ++pairs;
    if (code < white && ((i * 2654435761U) >> 20U) % 16 == 0)
      differences.push_back(std::abs(step));  // a scattered sixteenth
  }
  const auto n = static_cast<double>(count);
  f.saturated_share = saturated / n;
  f.mean_code = sum / n;
  auto codes = frame.samples;
  const auto bright = codes.begin() + static_cast<std::ptrdiff_t>(count - 1 - count / 100);
  std::nth_element(codes.begin(), bright, codes.end());
  f.bright_code = *bright;
  if (!differences.empty()) f.noise = stats::median(differences) * stats::sigma_of_median / std::sqrt(2.0);
  if (pairs > 0 && squares > 0)
    f.focus = std::max(0.0, steps / static_cast<double>(pairs) - 2 * f.noise * f.noise) / (squares / n);
  return f;
}

std::string disagreement(const RawFrame& frame, const Shot& shot, const std::string& pixel_format,
                         const std::optional<FrameBefore>& before, double asked_s, double came_s,
                         const FrameRules& rules) {
  if (frame.incomplete_packets > 0)
    return format("%lld of its packets are missing", static_cast<long long>(frame.incomplete_packets));
  if (frame.width_px <= 0 || frame.height_px <= 0 ||
      frame.samples.size() != static_cast<std::size_t>(frame.width_px) * static_cast<std::size_t>(frame.height_px))
    return format("it has %zu samples for %d x %d pixels", frame.samples.size(), frame.width_px, frame.height_px);
  if (!pixel_format.empty() && frame.pixel_format != unpacked_name(pixel_format))
    return "it came as " + frame.pixel_format + ", " + pixel_format + " was asked";
  if (frame.chunk_frame_id && *frame.chunk_frame_id != frame.frame_id)
    return format("it is frame %llu and carries the figures of frame %llu",
                  static_cast<unsigned long long>(frame.frame_id),
                  static_cast<unsigned long long>(*frame.chunk_frame_id));
  if (frame.exposure_s && std::abs(*frame.exposure_s - shot.exposure_s) >
                              std::max(rules.exposure_tolerance * shot.exposure_s, rules.exposure_step_s))
    return "the camera says " + milliseconds_text(*frame.exposure_s) + " of it, " + milliseconds_text(shot.exposure_s) +
           " were asked";
  if (frame.gain_db && shot.gain_db && std::abs(*frame.gain_db - *shot.gain_db) > rules.gain_tolerance_db)
    return format("the camera says %.2f dB of it, %.2f dB were asked", *frame.gain_db, *shot.gain_db);
  if (!before) return {};
  if (frame.frame_id <= before->frame_id)
    return format("its number %llu is not after the frame before, %llu",
                  static_cast<unsigned long long>(frame.frame_id), static_cast<unsigned long long>(before->frame_id));
  return wrong_time(frame, *before, asked_s, came_s, rules);
}

std::string differing(const FrameFigures& first, const FrameFigures& second) {
  const double mean = 0.5 * (first.mean_code + second.mean_code);
  const double allowed = 0.02 * mean + std::max({first.noise, second.noise, 0.5});
  if (std::abs(first.mean_code - second.mean_code) <= allowed) return {};
  return format("two frames at one exposure have mean codes %.1f and %.1f", first.mean_code, second.mean_code);
}

std::optional<std::size_t> stray_of_bracket(std::span<const BracketFrame> frames, const FrameRules& rules) {
  std::vector<std::size_t> telling;
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (frames[i].figures.saturated_share < 1e-3) telling.push_back(i);
  if (telling.size() < 4) return {};
  std::vector<double> slopes, blacks;
  for (const std::size_t i : telling)
    for (const std::size_t k : telling)
      if (frames[i].exposure_s < frames[k].exposure_s)
        slopes.push_back((frames[k].figures.mean_code - frames[i].figures.mean_code) /
                         (frames[k].exposure_s - frames[i].exposure_s));
  if (slopes.empty()) return {};
  const double slope = stats::median(slopes);
  for (const std::size_t i : telling) blacks.push_back(frames[i].figures.mean_code - slope * frames[i].exposure_s);
  const double black = stats::median(blacks);
  std::optional<std::size_t> stray;
  double worst = 1;
  for (const std::size_t i : telling) {
    const double expected = slope * frames[i].exposure_s;
    const double off = std::abs(frames[i].figures.mean_code - black - expected);
    const double ratio = off / (rules.level_tolerance * std::abs(expected) + 2 + 0.2 * frames[i].figures.noise);
    if (ratio <= worst) continue;
    worst = ratio;
    stray = i;
  }
  return stray;
}

bool looks_dark(const FrameFigures& lit, const FrameFigures& dark) {
  const double noise = std::max({lit.noise, dark.noise, 0.5});
  return lit.bright_code <= dark.bright_code + 3 * noise && lit.mean_code <= dark.mean_code + 0.5 * noise;
}

bool looks_brighter(const FrameFigures& more, const FrameFigures& before, std::size_t count) {
  const double noise = std::hypot(more.noise, before.noise) / std::sqrt(std::max(1.0, static_cast<double>(count)));
  return more.saturated_share > 0.5 ||
         more.mean_code - before.mean_code > std::max({5 * noise, 0.002 * before.mean_code, 0.02});
}

}  // namespace gonio::acquisition
