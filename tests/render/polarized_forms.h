// Closed forms of polarized light at interfaces, plates and stacks, written in sines and tangents (Born & Wolf 1999,
// section 1.5): they do not use the library's Fresnel terms.
#pragma once
#include <cmath>
#include <complex>

#include "optics/mueller.h"

namespace gonio::tests {

using Complex = std::complex<double>;
using optics::Stokes;

inline const Stokes natural{{1, 0, 0, 0}}, along{{1, 1, 0, 0}}, slanted{{1, 0, 1, 0}}, circular{{1, 0, 0, 1}};

// What a polarizing element with the factors `s`, `p` on intensities and `cross` on (s2 + i s3) makes of a state.
inline Stokes element(double s, double p, Complex cross, const Stokes& in) {
  const Complex turned = cross * Complex(in.s[2], in.s[3]);
  return {{(s * (in.s[0] + in.s[1]) + p * (in.s[0] - in.s[1])) / 2,
           (s * (in.s[0] + in.s[1]) - p * (in.s[0] - in.s[1])) / 2, turned.real(), turned.imag()}};
}

struct Interface {  // smooth, from air to eta at the angle i
  double s, p;      // amplitudes
  Interface(double angle, double eta) {
    const double t = std::asin(std::sin(angle) / eta);
    s = angle == 0 ? (1 - eta) / (1 + eta) : -std::sin(angle - t) / std::sin(angle + t);
    p = angle == 0 ? (eta - 1) / (1 + eta) : std::tan(angle - t) / std::tan(angle + t);
  }
  double rs() const { return s * s; }
  double rp() const { return p * p; }
};

// Rays that go to and fro in a plate add up by their intensities: for s and p a geometric series each, and the same
// with the products of amplitudes for s2 and s3. `a`: share that survives one pass.
struct Plate {
  double rs, rp, ts, tp, cross_r, cross_t;
  Plate(double angle, double eta, double a) {
    const Interface face(angle, eta);
    const double s = face.rs(), p = face.rp(), c = face.s * face.p, through = (1 - s) * (1 - p);
    rs = s + (1 - s) * (1 - s) * s * a * a / (1 - s * s * a * a);
    rp = p + (1 - p) * (1 - p) * p * a * a / (1 - p * p * a * a);
    ts = (1 - s) * (1 - s) * a / (1 - s * s * a * a);
    tp = (1 - p) * (1 - p) * a / (1 - p * p * a * a);
    cross_r = c + through * c * a * a / (1 - c * c * a * a);
    cross_t = through * a / (1 - c * c * a * a);
  }
};

// Plates one behind the other, by adding (Stokes 1862, "On the intensity of the light reflected from or transmitted
// through a pile of plates"): s, p and the products of amplitudes each on their own.
struct Stack {
  struct Channel {
    Complex r = 0, t = 1, back = 0;  // seen from the first plate's side; back: from the last one's
    void add(Complex r1, Complex t1) {
      const Complex often = 1.0 / (1.0 - back * r1), first = r, through = t;
      r = first + through * through * r1 * often;
      t = through * t1 * often;
      back = r1 + t1 * t1 * back * often;
    }
  } s, p, cross;
  void add(const Plate& plate) {
    s.add(plate.rs, plate.ts);
    p.add(plate.rp, plate.tp);
    cross.add(plate.cross_r, plate.cross_t);
  }
};

}  // namespace gonio::tests
