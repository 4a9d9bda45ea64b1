// A surface beside a hole, continued over it: a polynomial height over a plane, fitted to a band round the hole.
#pragma once
#include <cstdint>
#include <vector>

#include "geom/vector.h"

namespace gonio::mesh {

struct HeightSample {
  double u = 0, v = 0, h = 0;
  std::vector<std::uint32_t> beside{};  // other samples next to this one on the surface
};

class Continuation {
 public:
  // Fourth degree where the band bears it, else less. `reach`: lengths are taken in it.
  Continuation(const std::vector<HeightSample>& band, double reach);
  double at(double u, double v) const;
  Vec3 normal_at(double u, double v) const;  // in (u, v, h), towards +h
  // How far the surface may be from the truth there, one standard deviation: the noise of the band through the fit, and
  // what one more degree would change. Terms of degree d shrink with d like a geometric series where continuing makes
  // sense at all: what is left behind the last is its change times the ratio of the last two.
  double sigma_at(double u, double v) const;
  double noise_variance() const { return fits_.back().square * fits_.back().inflation; }  // of one height
  int degree() const { return degree_; }

 private:
  struct Fit {
    std::vector<double> coefficients, inverse;
    double square = 0;  // mean square of what is left
    double inflation = 1;
  };
  static Fit fit(const std::vector<HeightSample>& band, double reach, int degree);
  double value(const Fit& fit, double u, double v) const;

  double reach_;
  int degree_ = 1;
  std::vector<Fit> fits_;  // degree 1, 2, 4
};

}  // namespace gonio::mesh
