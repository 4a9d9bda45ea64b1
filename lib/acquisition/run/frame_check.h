// Is this frame the one that was asked for? Nothing is believed because it ought to be so: a camera may keep an old
// exposure, send the figures of the frame before with a picture, or send an old picture.
#pragma once
#include <optional>
#include <span>
#include <string>

#include "acquisition/device/devices.h"

namespace gonio::acquisition {

// Figures of a picture's codes. Saturated: at `white` or above. `bright_code`: that 1 % of the pixels exceed. `noise`:
// of one pixel, robust, from differences of neighbours of one filter. `focus`: mean squared difference of such
// neighbours, less their noise's, over the mean squared code (after Tenenbaum; without a unit).
struct FrameFigures {
  double saturated_share = 0, mean_code = 0, bright_code = 0, noise = 0, focus = 0;
};
FrameFigures figures_of(const RawFrame& frame, double white, bool mosaic);

// What is remembered of the frame before, of the same camera in the same run. Host's clock in s, any zero.
struct FrameBefore {
  std::uint64_t frame_id = 0;
  std::optional<double> camera_time_s;
  double asked_s = 0, came_s = 0;
};

struct FrameRules {
  double exposure_tolerance = 0.01;  // relative; cameras round to lines or microseconds
  double exposure_step_s = 2e-6;     // ... and no finer than this
  double gain_tolerance_db = 0.1;
  double clock_tolerance = 1e-3;  // of the camera's clock against the host's, relative ...
  double clock_step_s = 0.05;     // ... and what the host may be late by
  double level_tolerance = 0.1;   // of a bracket's codes against its exposures, relative
};

// The disagreement in words: `the camera says 4 ms of this frame, 8 ms were asked`; empty: there is none.
std::string disagreement(const RawFrame& frame, const Shot& shot, const std::string& pixel_format,
                         const std::optional<FrameBefore>& before, double asked_s, double came_s,
                         const FrameRules& rules = {});

// Two frames of the same thing at the same exposure: is their difference more than noise?
std::string differing(const FrameFigures& first, const FrameFigures& second);

// A bracket: codes grow as the exposures do, code = black + slope * exposure, until they saturate. Theil and Sen's line
// through the frames that are not saturated finds the one that strays most from it; nothing where none strays, or where
// fewer than four say anything.
struct BracketFrame {
  double exposure_s = 0;
  FrameFigures figures;
};
std::optional<std::size_t> stray_of_bracket(std::span<const BracketFrame> frames, const FrameRules& rules = {});

// Were the lamps dark though they were said to be on? The frame is as dark as one with the lamps off, within noise.
bool looks_dark(const FrameFigures& lit, const FrameFigures& dark);

// Does one lamp more make a difference? Both frames show the same thing at the same exposure, and light only adds: the
// mean code of `count` pixels rises by five times the noise of its difference, by 0.2 % (what lamps waver by) and
// by 0.02 codes; or so much of the picture is saturated that nothing can be said.
bool looks_brighter(const FrameFigures& more, const FrameFigures& before, std::size_t count);

}  // namespace gonio::acquisition
