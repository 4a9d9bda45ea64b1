// See told_place.h.
#include "scan/told_place.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

#include "base/random.h"
#include "scan/shift_fit.h"

namespace gonio::scan {
namespace {

double mean_of(double half) {
  return half != 0 ? std::sin(half) / half : 1;
}

double light_of(std::span<const double> amplitudes, double x) {
  const double c = std::cos(x);
  double sum = 0, here = c, before = 1;  // cos((h + 1) x) = 2 cos x cos(h x) - cos((h - 1) x)
  for (const double a : amplitudes) {
    sum += a * here;
    const double next = 2 * c * here - before;
    before = here, here = next;
  }
  return sum;
}

// The product as it is written: the operator asks of each whether it is infinite.
std::complex<double> product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
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
    const Mat3 solve = shift_fit(set.shifts_rad);
    for (const double s : set.shifts_rad) {
      const Vec3 fit = solve * Vec3{1, std::cos(s), std::sin(s)};
      set.weighs.emplace_back(fit.y, fit.z);
    }
    for (std::size_t i = 0; i < harmonics; ++i) {
      const double h = static_cast<double>(i + 1);
      set.own_pixel[i] = mean_of(h * pi * periods / size_);
      for (std::size_t k = 0; k < set.weighs.size(); ++k) {
        set.along[i] += 0.5 * set.weighs[k] * std::polar(1.0, -h * set.shifts_rad[k]);
        set.against[i] += 0.5 * set.weighs[k] * std::polar(1.0, h * set.shifts_rad[k]);
      }
    }
    sets_.push_back(std::move(set));
  }
}

// Of ((1 + contrast cos x) / 2)^gamma, over the first: ratios from the last to the first, where they converge. Pixel
// after pixel asks for the same exponent, its neighbour for a derivative, and each set's contrast: what a thread has
// found stays.
ToldPlace::Amplitudes ToldPlace::of_power(double gamma, double contrast) {
  struct Found {
    double gamma = std::numeric_limits<double>::quiet_NaN(), contrast = 0;
    Amplitudes a{};
  };
  thread_local std::array<Found, 64> all;
  const std::uint64_t mixed =
      split_mix(std::bit_cast<std::uint64_t>(gamma) ^ split_mix(std::bit_cast<std::uint64_t>(contrast)));
  Found& found = all[mixed % all.size()];
  if (found.gamma == gamma && found.contrast == contrast) return found.a;
  Amplitudes ratio, a;
  double next = (gamma - harmonics) / (gamma + harmonics + 1);
  for (std::size_t i = harmonics; i-- > 1;) {
    const double h = static_cast<double>(i + 1);
    next = ratio[i] = (gamma - h + 1) / ((gamma + h + 1) * next + 2 * h / contrast);
  }
  a[0] = 1;
  for (std::size_t i = 1; i < harmonics; ++i) a[i] = a[i - 1] * ratio[i];
  found = {gamma, contrast, a};
  return found.a;
}

ToldPlace::Amplitudes ToldPlace::amplitudes(const Set& set, const Bend& bend) const {
  const double half = pi * set.periods / size_ * bend.covers_px, twice_cosine = 2 * std::cos(half);
  const double each = 2 * pi * set.periods / size_, spot = std::exp(-0.5 * bend.spot_px2 * each * each);
  // spot^(h^2): each is the last times spot^(2 h + 1).
  double left = spot, next_left = spot * spot * spot;
  Amplitudes a;
  const Amplitudes bent = of_power(bend.gamma, set.own_pixel[0]);
  double sine = std::sin(half), before = 0;  // sin((h + 1) x) = 2 cos x sin(h x) - sin((h - 1) x)
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double h = static_cast<double>(i + 1);
    a[i] = bent[i] * left * set.own_pixel[i] * (half != 0 ? sine / (h * half) : 1);
    const double next = twice_cosine * sine - before;
    before = sine, sine = next;
    left *= next_left, next_left *= spot * spot;
  }
  return a;
}

// C + i S.
std::complex<double> ToldPlace::fitted(const Set& set, const Bend& bend, double theta) const {
  const Amplitudes a = amplitudes(set, bend);
  std::complex<double> sum = 0;
  if (bend.moves_px != 0) {
    const double moves_rad = 2 * pi * set.periods / size_ * bend.moves_px;
    for (std::size_t k = 0; k < set.weighs.size(); ++k)
      sum += set.weighs[k] * light_of(a, theta + moves_rad * set.times[k] - set.shifts_rad[k]);
    return sum;
  }
  const std::complex<double> turn = std::polar(1.0, theta);
  std::complex<double> turned = turn;
  for (std::size_t i = 0; i < harmonics; ++i) {
    sum += a[i] * (product(set.along[i], turned) + product(set.against[i], std::conj(turned)));
    turned = product(turned, turn);
  }
  return sum;
}

double ToldPlace::operator()(double place, const Bend& bend) const {
  if (bend.gamma == 1 && bend.moves_px == 0) return place;
  double sum = 0, weights = 0;
  for (const Set& set : sets_) {
    const double rad_per_px = 2 * pi * set.periods / size_, theta = rad_per_px * (place + 0.5);
    const std::complex<double> fit = fitted(set, bend, theta);
    const double weight = rad_per_px * rad_per_px * static_cast<double>(set.shifts_rad.size()) * std::norm(fit);
    sum += weight * std::remainder(std::arg(fit) - theta, 2 * pi) / rad_per_px, weights += weight;
  }
  return weights > 0 ? place + sum / weights : place;
}

std::vector<double> ToldPlace::periods() const {
  std::vector<double> all;
  for (const Set& set : sets_) all.push_back(set.periods);
  return all;
}

double ToldPlace::mean_of_turns(std::span<const double> turns_rad, const Bend& bend) const {
  double sum = 0, weights = 0;
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    const double rad_per_px = 2 * pi * sets_[s].periods / size_, amplitude = amplitudes(sets_[s], bend)[0],
                 weight =
                     rad_per_px * rad_per_px * amplitude * amplitude * static_cast<double>(sets_[s].shifts_rad.size());
    sum += weight * turns_rad[s] / rad_per_px, weights += weight;
  }
  return weights > 0 ? sum / weights : 0;
}

double ToldPlace::finest_phase(double place) const {
  return sets_.empty() ? 0 : 2 * pi * sets_.back().periods * (place + 0.5) / size_;
}

}  // namespace gonio::scan
