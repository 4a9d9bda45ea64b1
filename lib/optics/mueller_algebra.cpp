#include "optics/mueller_algebra.h"

#include <cmath>

namespace gonio::optics {

Mueller identity_mueller() {
  Mueller result;
  for (int i = 0; i < 4; ++i) result(i, i) = 1;
  return result;
}

Mueller operator*(const Mueller& a, const Mueller& b) {
  Mueller result;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      result(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j) + a(i, 3) * b(3, j);
  return result;
}

Stokes operator*(const Mueller& a, const Stokes& s) {
  Stokes result;
  for (int i = 0; i < 4; ++i)
    result.s[static_cast<std::size_t>(i)] = a(i, 0) * s.s[0] + a(i, 1) * s.s[1] + a(i, 2) * s.s[2] + a(i, 3) * s.s[3];
  return result;
}

Mueller operator*(const Mueller& a, double factor) {
  Mueller result = a;
  for (double& v : result.m) v *= factor;
  return result;
}

Mueller operator+(const Mueller& a, const Mueller& b) {
  Mueller result = a;
  for (std::size_t i = 0; i < result.m.size(); ++i) result.m[i] += b.m[i];
  return result;
}

Stokes operator+(const Stokes& a, const Stokes& b) {
  return {{a.s[0] + b.s[0], a.s[1] + b.s[1], a.s[2] + b.s[2], a.s[3] + b.s[3]}};
}

Stokes operator*(const Stokes& s, double factor) {
  return {{s.s[0] * factor, s.s[1] * factor, s.s[2] * factor, s.s[3] * factor}};
}

Mueller normalised(const Mueller& a) {
  return a(0, 0) > 0 ? a * (1 / a(0, 0)) : Mueller::depolarizer();
}

namespace {

Mueller turned(double cos2, double sin2) {
  Mueller result;
  result(0, 0) = result(3, 3) = 1;
  result(1, 1) = result(2, 2) = cos2;
  result(1, 2) = sin2;
  result(2, 1) = -sin2;
  return result;
}

}  // namespace

Mueller frame_turned_by(double angle) {
  return turned(std::cos(2 * angle), std::sin(2 * angle));
}

Mueller frame_change(Vec3 d, Vec3 from_x, Vec3 to_x) {
  const double c = dot(from_x, to_x), s = dot(d, cross(from_x, to_x)), squared = c * c + s * s;
  return turned((c * c - s * s) / squared, 2 * s * c / squared);
}

Mueller element_turned_by(const Mueller& a, double angle) {
  return frame_turned_by(-angle) * a * frame_turned_by(angle);
}

Mueller reversed(const Mueller& a) {
  Mueller result;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      result(row, column) = (row == 2) == (column == 2) ? a(column, row) : -a(column, row);
  return result;
}

Mueller mueller_of(Complex x, Complex y) {
  const double xx = std::norm(x), yy = std::norm(y);
  const Complex xy = x * std::conj(y);
  Mueller result;
  result(0, 0) = result(1, 1) = (xx + yy) / 2;
  result(0, 1) = result(1, 0) = (xx - yy) / 2;
  result(2, 2) = result(3, 3) = xy.real();
  result(2, 3) = -xy.imag();
  result(3, 2) = xy.imag();
  return result;
}

Mueller linear_polarizer(double angle) {
  return element_turned_by(mueller_of(1, 0), angle);
}

// A delay is a positive phase: exp(-i omega t) exp(i retardance).
Mueller linear_retarder(double angle, double retardance) {
  return element_turned_by(mueller_of(std::polar(1.0, retardance), 1), angle);
}

Mueller fresnel_reflection(double cosine, Complex eta) {
  const Amplitudes r = reflected_amplitudes(cosine, eta);
  return mueller_of(r.s, r.p);
}

// Flux through the interface (Born & Wolf 1999, section 1.5.3): |t|^2 Re(w) / c for s, |t|^2 Re(eta* w / eta) / c for
// p.
Mueller fresnel_transmission(double cosine, Complex eta) {
  const Complex w = refracted(cosine, eta);
  if (!(cosine > 0) || (eta.imag() == 0 && w.imag() > 0)) return {};
  const Amplitudes t = transmitted_amplitudes(cosine, eta);
  const double s = std::sqrt(std::max(0.0, w.real() / cosine));
  const double p = std::sqrt(std::max(0.0, (std::conj(eta) * (w / eta)).real() / cosine));
  return mueller_of(t.s * s, t.p * p);
}

double degree_of_polarization(const Stokes& s) {
  return s.s[0] > 0 ? std::sqrt(s.s[1] * s.s[1] + s.s[2] * s.s[2] + s.s[3] * s.s[3]) / s.s[0] : 0;
}
double degree_of_linear_polarization(const Stokes& s) {
  return s.s[0] > 0 ? std::hypot(s.s[1], s.s[2]) / s.s[0] : 0;
}
double angle_of_linear_polarization(const Stokes& s) {
  return std::atan2(s.s[2], s.s[1]) / 2;
}

}  // namespace gonio::optics
