// sensor.row-pattern: bands with one phase for all pictures of a camera, as sensor_chain.h records them. The search
// starts at the strongest period of the rough residual over the rows.
#include "render/mechanisms/sensor_row_pattern.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/rough.h"
#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

struct Bands {
  double amplitude = 0, period_px = 0, phase_rad = 0;
};

// Sum of r exp(-2 pi i row / T) over N sights is N A / (2 i) exp(i phase) for r = A sin(2 pi row / T + phase).
Bands strongest(const Setting& s, const RoughResidual& rough, const std::string& camera) {
  std::vector<double> sum, n;
  for (const RoughResidual::Sight& sight : rough.sights) {
    const Recording& image = s.recordings.images[sight.image];
    if (s.recordings.views[image.view].camera != camera) continue;
    const auto row = static_cast<std::size_t>(s.model.cache(image.view).pixels[sight.pixel].y);
    if (row >= sum.size()) sum.resize(row + 1), n.resize(row + 1);
    sum[row] += std::clamp(sight.relative, -1.0, 1.0), n[row] += 1;
  }
  Bands best;
  for (double period = static_cast<double>(sum.size()) / 2; period >= 4; period *= 0.98) {
    std::complex<double> total = 0;
    double rows = 0;
    for (std::size_t r = 0; r < sum.size(); ++r)
      if (n[r] > 0) {
        total += sum[r] / n[r] * std::polar(1.0, -2 * pi * static_cast<double>(r) / period);
        rows += 1;
      }
    if (rows > 0 && 2 * std::abs(total) / rows > best.amplitude)
      best = {2 * std::abs(total) / rows, period, std::remainder(std::arg(total) + pi / 2, 2 * pi)};
  }
  return best;
}

std::vector<Use> candidates(const Setting& s) {
  std::vector<Use> uses = camera_uses(s, mechanism::sensor_row_pattern());
  const RoughResidual rough = rough_residual(s);
  std::erase_if(uses, [&](Use& use) {
    const Bands bands = strongest(s, rough, use.on[0]);
    if (!(bands.period_px > 0)) return true;
    use.numbers[0].start = std::min(bands.amplitude, 0.3);
    use.numbers[1] = {bands.period_px, bands.period_px, 0.8 * bands.period_px, 1.25 * bands.period_px};
    use.numbers[2] = {bands.phase_rad, bands.phase_rad, bands.phase_rad - pi, bands.phase_rad + pi};
    return false;
  });
  return uses;
}

void record(const Use& use, const Frame& frame, std::span<double> values) {
  const std::span<const double> a = camera_amounts(use, frame);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = equation::sensor_row_pattern(values[i], a[0], a[1], a[2], frame.cache.pixels[frame.picked[i / 3]].y);
}

}  // namespace

const Term& sensor_row_pattern() {
  static const Term term{
      .mechanism = mechanism::sensor_row_pattern,
      .reach = Reach::record,
      .order = 70,
      .candidates = candidates,
      .record = record,
  };
  return term;
}

}  // namespace gonio::relighting::terms
