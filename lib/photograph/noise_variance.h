// The variance that a stated noise gives a linear value (EMVA 1288: shot noise and read noise).
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "manifest/noise.h"

namespace gonio::photograph {

// v / gain + read^2; gain 0: no shot noise. Values below zero have none either.
inline double noise_variance(const manifest::Noise& noise, double value) {
  return (noise.gain > 0 && value > 0 ? value / noise.gain : 0) + noise.read * noise.read;
}

// The same of values that come out of codes by a curve (linearity.h), where a table says the variance; without one it
// is the stated noise's.
struct NoiseModel : manifest::Noise {
  NoiseModel() = default;
  NoiseModel(double gain_, double read_) : manifest::Noise{gain_, read_} {}
  NoiseModel(const manifest::Noise& noise) : manifest::Noise(noise) {}
  std::vector<double> variances;  // of 0, spacing, 2 spacing, ...; empty: none; beyond the ends: as at the ends
  double spacing = 0;
};
inline double noise_variance(const NoiseModel& noise, double value) {
  if (noise.variances.empty()) return noise_variance(static_cast<const manifest::Noise&>(noise), value);
  const double at = std::clamp(value / noise.spacing, 0.0, static_cast<double>(noise.variances.size() - 1));
  const auto below = std::min(static_cast<std::size_t>(at), noise.variances.size() - 2);
  const double share = at - static_cast<double>(below);
  return noise.variances[below] * (1 - share) + noise.variances[below + 1] * share;
}

// The same of many values: the gain is divided by once. The noise has to live as long.
class NoiseVariance {
 public:
  explicit NoiseVariance(const NoiseModel& noise)
      : noise_(noise),
        least_(noise_variance(static_cast<const manifest::Noise&>(noise), 0)),
        slope_(noise.gain > 0 ? 1 / noise.gain : 0) {}
  double operator()(double value) const {
    if (!noise_.variances.empty()) return noise_variance(noise_, value);
    return (value > 0 ? value * slope_ : 0) + least_;
  }
  // Whether it is least() + slope() times what is above zero.
  bool is_line() const { return noise_.variances.empty(); }
  double least() const { return least_; }
  double slope() const { return slope_; }

 private:
  const NoiseModel& noise_;
  double least_, slope_;
};

}  // namespace gonio::photograph
