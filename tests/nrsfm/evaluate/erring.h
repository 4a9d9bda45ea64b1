// Reconstructions whose errors are larger in some stretches of the sequence than in others.
#pragma once
#include <cmath>

#include "nrsfm/evaluate/alignment.h"
#include "shapes.h"

namespace gonio::nrsfm::tests {

// Of a stationary normal process of variance 1: a_f = first a_(f-1) + second a_(f-2) + noise.
struct Process {
  double first = 0, second = 0;
  double noise() const {  // its standard deviation (Box & Jenkins, equation 3.2.21)
    const double b = second;
    return std::sqrt((1 + b) * ((1 - b) * (1 - b) - first * first) / (1 - b));
  }
};

// Errors of the size 0.01 exp(0.5 a_f).
inline Aligned erring(const Shapes& q, Eigen::Index frames, const Process& process, std::uint64_t seed) {
  Random random(seed, 77);
  Aligned a;
  a.truth.resize(3 * frames, q.cols());
  a.shapes.resize(3 * frames, q.cols());
  const double noise = process.noise(), lag = process.first / (1 - process.second);
  double before = random.normal(), state = lag * before + std::sqrt(1 - lag * lag) * random.normal();
  for (Eigen::Index f = 0; f < frames; ++f) {
    const double next = process.first * state + process.second * before + noise * random.normal();
    before = state, state = next;
    const double size = 0.01 * std::exp(0.5 * state);
    shape_of(a.truth, f) = shape_of(q, f % (q.rows() / 3));
    shape_of(a.shapes, f) = shape_of(a.truth, f);
    for (Eigen::Index i = 0; i < 3 * q.cols(); ++i) a.shapes(3 * f + i % 3, i / 3) += size * random.normal();
  }
  return a;
}

}  // namespace gonio::nrsfm::tests
