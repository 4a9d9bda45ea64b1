// See told_place.h.
#include "scan/told_place.h"

#include <array>
#include <cmath>
#include <map>

#include "scan/shift_fit.h"

namespace gonio::scan {
namespace {

using Harmonics = std::array<double, 16>;  // from the first on, which is 1

// `half_rad`: of a pixel of the projector.
Harmonics harmonics_of(const ToldPlace::Bend& bend, double half_rad) {
  const auto mean = [](double half) { return half != 0 ? std::sin(half) / half : 1; };
  Harmonics a;
  double amplitude = 1;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double h = static_cast<double>(i + 1);
    a[i] = amplitude * mean(h * half_rad) * mean(h * half_rad * bend.covers_px);
    amplitude *= (bend.gamma - h) / (bend.gamma + h + 1);
  }
  return a;
}

double light_of(const Harmonics& amplitudes, double x) {
  const double c = std::cos(x);
  double sum = 0, here = c, before = 1;  // cos((h + 1) x) = 2 cos x cos(h x) - cos((h - 1) x)
  for (const double a : amplitudes) {
    sum += a * here;
    const double next = 2 * c * here - before;
    before = here, here = next;
  }
  return sum;
}

}  // namespace

ToldPlace::ToldPlace(const Sequence& sequence, Axis axis) : size_(sequence.size(axis)) {
  std::map<double, Set> found;
  const double last = std::max<double>(1, static_cast<double>(sequence.frames.size()) - 1);
  for (std::size_t f = 0; f < sequence.frames.size(); ++f) {
    const Shown& s = sequence.frames[f];
    if (s.what != Shown::What::cosine || s.axis != axis) continue;
    Set& set = found[s.periods];
    set.periods = s.periods;
    set.shifts_rad.push_back(s.shift_rad), set.times.push_back(static_cast<double>(f) / last - 0.5);
  }
  for (auto& [periods, set] : found) {
    set.solve = shift_fit(set.shifts_rad);
    sets_.push_back(std::move(set));
  }
}

double ToldPlace::operator()(double place, const Bend& bend) const {
  if (bend.gamma == 1 && bend.moves_px == 0) return place;
  std::vector<double> turns;
  for (const Set& set : sets_) {
    const double rad_per_px = 2 * pi * set.periods / size_, theta = rad_per_px * (place + 0.5);
    const Harmonics amplitudes = harmonics_of(bend, 0.5 * rad_per_px);
    Vec3 sums;
    for (std::size_t k = 0; k < set.shifts_rad.size(); ++k) {
      const double shift = set.shifts_rad[k],
                   read = light_of(amplitudes, theta + rad_per_px * bend.moves_px * set.times[k] - shift);
      sums += Vec3{read, read * std::cos(shift), read * std::sin(shift)};
    }
    const Vec3 fit = set.solve * sums;
    turns.push_back(std::remainder(std::atan2(fit.z, fit.y) - theta, 2 * pi));
  }
  return place + mean_of_turns(turns);
}

std::vector<double> ToldPlace::periods() const {
  std::vector<double> all;
  for (const Set& set : sets_) all.push_back(set.periods);
  return all;
}

double ToldPlace::mean_of_turns(std::span<const double> turns_rad) const {
  double sum = 0, weights = 0;
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    const double rad_per_px = 2 * pi * sets_[s].periods / size_,
                 weight = rad_per_px * rad_per_px * static_cast<double>(sets_[s].shifts_rad.size());
    sum += weight * turns_rad[s] / rad_per_px, weights += weight;
  }
  return weights > 0 ? sum / weights : 0;
}

double ToldPlace::finest_phase(double place) const {
  return sets_.empty() ? 0 : 2 * pi * sets_.back().periods * (place + 0.5) / size_;
}

}  // namespace gonio::scan
