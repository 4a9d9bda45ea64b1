// What least squares over the shifts of cosines (decode.h) make of readings that are no cosines: of a projector whose
// light is a power of what it is told (projector.gamma), of a thing that moves meanwhile (structured-light.motion).
#pragma once
#include <array>
#include <complex>
#include <span>
#include <vector>

#include "geom/vector.h"
#include "scan/sequence.h"

namespace gonio::scan {

// The cosines of one axis as they were shown, and the place that they tell.
//
// A bent cosine is one of the same period with harmonics: of ((1 + m cos x) / 2)^gamma, m the contrast that a cosine
// has which was averaged over each pixel when it was made, the sum of a(h) cos(h x) with, by x-derivatives of both
// sides,
//   a(h) / a(h - 1) = (gamma - h + 1) / ((gamma + h + 1) a(h + 1) / a(h) + 2 h / m)
// (m = 1: (gamma - h + 1) / (gamma + h), Gradshteyn & Ryzhik 3.631.9). Of each the square pixels of the projector leave
// sinc(h periods / size), and a pixel of the camera that covers `covers_px` of them sinc(h periods covers_px / size),
// and a projector out of focus, whose spots have the variance spot_px2 beyond their squares, exp(-spot_px2 (2 pi h
// periods / size)^2 / 2): where that is not known, an exponent is taken for one nearer to
// 1. Four equal shifts see the third and fifth harmonic, which two exponents about 1.5 make alike; three see the
// second.
class ToldPlace {
 public:
  struct Bend {
    double gamma = 1;
    double moves_px = 0;   // by which the place is another, evenly from the first frame to the last
    double covers_px = 0;  // of a pixel of the camera
    double spot_px2 = 0;   // variance of the projector's spots beyond their squares
  };
  ToldPlace(const Sequence& sequence, Axis axis);
  bool any() const { return !sets_.empty(); }
  // The mean of what all numbers of periods say, weighed by their noise, of a pixel that `place` lights in the middle
  // of the sequence. `place` itself where gamma is 1 and nothing moves.
  double operator()(double place, const Bend& bend) const;
  // Numbers of periods, ascending; and the mean, in pixels, of what turns their phases by so many radians.
  std::vector<double> periods() const;
  double mean_of_turns(std::span<const double> turns_rad, const Bend& bend) const;
  // 2 pi periods (place + 1/2) / size of the most periods, not wrapped.
  double finest_phase(double place) const;

 private:
  static constexpr std::size_t harmonics = 16;
  using Amplitudes = std::array<double, harmonics>;  // from the first on, which is 1
  struct Set {
    double periods = 1;
    std::vector<double> shifts_rad, times;     // times: -1/2 the first frame, 1/2 the last
    std::vector<std::complex<double>> weighs;  // a reading in C + i S of the fit
    Amplitudes own_pixel{};                    // what a square of the projector leaves of each harmonic
    // C + i S of the h-th harmonic alone, of amplitude 1 at the phase x: along[h] exp(i h x) + against[h] exp(-i h x).
    std::array<std::complex<double>, harmonics> along{}, against{};
  };
  static Amplitudes of_power(double gamma, double contrast);
  Amplitudes amplitudes(const Set& set, const Bend& bend) const;
  std::complex<double> fitted(const Set& set, const Bend& bend, double theta) const;
  std::vector<Set> sets_;  // ascending periods
  double size_ = 1;
};

}  // namespace gonio::scan
