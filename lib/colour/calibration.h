// From patches as they were read to a correction, and how far it can be trusted.
//
// Uneven light and offset are found first (chart_light.h) and, where chance alone does not make the like, taken off;
// then the model is fitted (correction_fit.h). Everything is done again without each patch in turn: what that predicts
// for the patch left out is its held-out colour, and how far coefficients move is their covariance (jackknife).
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "colour/chart.h"
#include "colour/chart_light.h"
#include "colour/correction.h"
#include "colour/patch_readings.h"

namespace gonio::colour {

enum class Take { automatic, never, always };  // automatic: where chance does so in less than one of a thousand cases

struct CalibrationRequest {
  // Left out: of those that keep exposure, the simplest whose held-out differences are, within their standard error, as
  // small as the least.
  std::optional<Model> model;
  Target target = Target::cie_rgb;
  bool refine = true;
  Take offset = Take::automatic, gradient = Take::automatic;
};

struct PatchOutcome {
  Rgb evened;                              // reading in even light, without offset
  std::optional<double> fitted, held_out;  // CIEDE2000 from the reference; of patches that count
};

struct Tried {
  Model model = Model::linear;
  double fitted = 0, held_out = 0;  // means
  std::string refused;              // why it could not be fitted; empty: it was
};

struct Spread {
  double mean = 0, deviation = 0, most = 0;
  std::size_t worst = 0;  // patch
};

struct Calibration {
  Rgb white;
  ChartLight found;  // offset and gradient as they were found
  ChartLight taken;  // and as they were taken off: zero where chance would do
  std::vector<Tried> tried;
  Correction correction;
  std::vector<std::vector<double>> covariance;  // of its matrix, row by row
  std::vector<PatchOutcome> patches;
  Spread fitted, held_out;
  double exposure_de00 = 0, noise_gain = 0;  // as the section "colour" of the manifest has them
};

// Error(data) at `place` where patches do not determine the model, or none of the models.
Calibration calibrate(const Chart& chart, std::span<const PatchReading> readings, const CalibrationRequest& request,
                      const std::string& place);

// Largest mean CIEDE2000 by which colours of `pixels` change where the exposure is 0.1, 0.3, 3 or 10 times as long and
// the result is scaled back.
double exposure_change(const Correction& correction, std::span<const Rgb> pixels);
// Root mean square noise of the colours that come out over independent, equal noise of pixels over white.
double noise_gain(const Correction& correction, std::span<const Rgb> pixels);

}  // namespace gonio::colour
