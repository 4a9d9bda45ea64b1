// sensor.row-pattern: bands as sensor_chain.h records them, with one phase for all pictures of a camera, or with a
// phase and an amplitude of their own in each picture and one period: lamps do not wait for the shutter. The search
// starts at the strongest period of the rough residual over the rows.
//
// Of pictures by themselves sine and cosine are sought, in which a prediction is linear: a phase that was chosen by
// looking at a picture would find bands in its noise.
#include "render/mechanisms/sensor_row_pattern.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <optional>

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

// Mean relative residual of every row of one picture, less the mean of the rows about it: shading that is not fitted
// yet varies slowly.
struct Profile {
  std::vector<double> row, value;
  Bands at(double period) const {
    std::complex<double> total = 0;
    for (std::size_t k = 0; k < row.size(); ++k) total += value[k] * std::polar(1.0, -2 * pi / period * row[k]);
    return {2 * std::abs(total) / std::max(1.0, static_cast<double>(row.size())), period,
            std::remainder(std::arg(total) + pi / 2, 2 * pi)};
  }
};

Profile profile_of(const Setting& s, const RoughResidual& rough, std::size_t image) {
  std::map<int, std::pair<double, double>> rows;
  for (const RoughResidual::Sight& sight : rough.sights) {
    if (sight.image != image) continue;
    auto& [sum, n] = rows[s.model.cache(s.recordings.images[image].view).pixels[sight.pixel].y];
    sum += std::clamp(sight.relative, -0.5, 0.5), n += 1;
  }
  Profile p;
  for (const auto& [y, cell] : rows) p.row.push_back(y), p.value.push_back(cell.first / cell.second);
  const double reach = s.recordings.images[image].picture.height / 6.0;
  const std::vector<double> rough_values = p.value;
  for (std::size_t k = 0; k < p.row.size(); ++k) {
    double sum = 0, n = 0;
    for (std::size_t j = 0; j < p.row.size(); ++j)
      if (std::abs(p.row[j] - p.row[k]) <= reach) sum += rough_values[j], n += 1;
    p.value[k] -= sum / n;
  }
  return p;
}

// The pictures of one camera, each by itself: a set of numbers for each, one period for all.
std::optional<Use> picture_by_picture(const Setting& s, const RoughResidual& rough, const std::string& camera) {
  std::vector<std::string> on;
  std::vector<std::size_t> images;
  std::vector<Profile> profiles;
  double rows = 0;
  for (std::size_t i = 0; i < s.recordings.images.size(); ++i) {
    const Recording& image = s.recordings.images[i];
    if (s.recordings.views[image.view].camera != camera) continue;
    if (switched_on(s.document, mechanism::sensor_row_pattern().id, image.id)) return {};
    profiles.push_back(profile_of(s, rough, i));
    if (profiles.back().row.size() < 8) {
      profiles.pop_back();
      continue;
    }
    on.push_back(image.id), images.push_back(i);
    rows = std::max(rows, profiles.back().row.back() - profiles.back().row.front());
  }
  if (on.size() < 2) return {};
  double best = 0, period_px = 0;
  for (double period = rows / 1.2; period >= 4; period *= 0.98) {
    double power = 0;
    for (const Profile& p : profiles) power += static_cast<double>(p.row.size()) * std::pow(p.at(period).amplitude, 2);
    if (power > best) best = power, period_px = period;
  }
  if (!(period_px > 0)) return {};
  Use use = target_use(mechanism::sensor_row_pattern(), on, images, false);
  const std::size_t n = use.mechanism->parameters.size();
  for (std::size_t k = 0; k < on.size(); ++k) {
    const Bands bands = profiles[k].at(period_px);
    const double size = std::min(bands.amplitude, 0.3);
    Number* number = &use.numbers[k * n];
    number[0].free = number[2].free = false;
    number[0].start = number[0].neutral, number[2].start = number[2].neutral;
    number[1] = {period_px, period_px, 0.8 * period_px, 1.25 * period_px};
    if (k > 0) number[1].free = false, number[1].same_as = 1;
    number[3].start = size * std::cos(bands.phase_rad), number[4].start = size * std::sin(bands.phase_rad);
    number[3].groups = number[4].groups = {images[k]};
  }
  return use;
}

std::vector<Use> candidates(const Setting& s) {
  std::vector<Use> uses;
  const RoughResidual rough = rough_residual(s);
  for (Use& use : camera_uses(s, mechanism::sensor_row_pattern())) {
    const std::string camera = use.on[0];
    for (std::size_t k = 3; k < use.numbers.size(); ++k) use.numbers[k].free = false;
    if (const Bands bands = strongest(s, rough, camera); bands.period_px > 0) {
      use.numbers[0].start = std::min(bands.amplitude, 0.3);
      use.numbers[1] = {bands.period_px, bands.period_px, 0.8 * bands.period_px, 1.25 * bands.period_px};
      use.numbers[2] = {bands.phase_rad, bands.phase_rad, bands.phase_rad - pi, bands.phase_rad + pi};
      use.family = "bands of " + camera;
      uses.push_back(std::move(use));
    }
    if (std::optional<Use> own = picture_by_picture(s, rough, camera)) {
      own->family = "bands of " + camera;
      uses.push_back(std::move(*own));
    }
  }
  return uses;
}

void record(const Use& use, const Frame& frame, std::span<double> values) {
  const equation::RowPattern pattern = equation::row_pattern(camera_amounts(use, frame));
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = equation::sensor_row_pattern(values[i], pattern, frame.cache.pixels[frame.picked[i / 3]].y);
}

}  // namespace

const Term& sensor_row_pattern() {
  static const Term term{
      .mechanism = mechanism::sensor_row_pattern,
      .reach = Reach::record,
      .order = 70,
      .candidates = candidates,
      .record = record,
      .pointwise = true,
  };
  return term;
}

}  // namespace gonio::relighting::terms
