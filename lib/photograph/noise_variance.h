// The variance that a stated noise gives a linear value (EMVA 1288: shot noise and read noise).
#pragma once
#include "manifest/noise.h"

namespace gonio::photograph {

// v / gain + read^2; gain 0: no shot noise. Values below zero have none either.
inline double noise_variance(const manifest::Noise& noise, double value) {
  return (noise.gain > 0 && value > 0 ? value / noise.gain : 0) + noise.read * noise.read;
}

// The same of many values: the gain is divided by once.
class NoiseVariance {
 public:
  explicit NoiseVariance(const manifest::Noise& noise)
      : least_(noise_variance(noise, 0)), slope_(noise.gain > 0 ? 1 / noise.gain : 0) {}
  double operator()(double value) const { return (value > 0 ? value * slope_ : 0) + least_; }

 private:
  double least_, slope_;
};

}  // namespace gonio::photograph
