// See colorimetry.h.
#include "optics/colorimetry.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "geom/dual.h"
#include "geom/mat3_inverse.h"
#include "optics/standard_observer.h"

namespace gonio::optics {
namespace {

constexpr double edge = 24.0 / 116;  // f of (24/116)^3, where the cube root gives way to a line

double forward(double t) {
  return t > edge * edge * edge ? std::cbrt(t) : t * 841 / 108 + 16.0 / 116;
}
double forward_slope(double t) {
  const double root = std::cbrt(t);
  return t > edge * edge * edge ? 1 / (3 * root * root) : 841.0 / 108;
}
double backward(double f) {
  return f > edge ? f * f * f : (f - 16.0 / 116) * 108 / 841;
}

using gonio::abs, gonio::atan2, gonio::cos, gonio::exp, gonio::hypot, gonio::sin, gonio::sqrt;
using std::abs, std::atan2, std::cos, std::exp, std::hypot, std::sin, std::sqrt;

constexpr double degree = pi / 180;

double seventh_power(double x) {
  return x * x * x * x * x * x * x;
}
template <std::size_t N>
Dual<N> seventh_power(const Dual<N>& x) {
  const double six = x.v * x.v * x.v * x.v * x.v * x.v;
  return x.chain(six * x.v, 7 * six);
}

template <class T>
struct Hue {
  T chroma, angle;  // angle from 0 to 2 pi
};
template <class T>
Hue<T> hue_of(const T& a, const T& b) {
  Hue<T> hue{hypot(a, b), atan2(b, a)};
  if (value_of(hue.angle) < 0) hue.angle = hue.angle + 2 * pi;
  return hue;
}

// Share of the correction for high chroma: sqrt(C^7 / (C^7 + 25^7)).
template <class T>
T high_chroma(const T& chroma) {
  const T power = seventh_power(chroma);
  return sqrt(power / (power + 6103515625.0));
}

template <class T>
T mean_hue(const Hue<T>& x, const Hue<T>& y) {
  const T sum = x.angle + y.angle;
  if (value_of(x.chroma) * value_of(y.chroma) == 0) return sum;
  if (std::abs(value_of(x.angle) - value_of(y.angle)) <= pi) return sum * 0.5;
  return value_of(sum) < 2 * pi ? (sum + 2 * pi) * 0.5 : (sum - 2 * pi) * 0.5;
}
template <class T>
T hue_step(const Hue<T>& from, const Hue<T>& to) {
  if (value_of(from.chroma) * value_of(to.chroma) == 0) return T(0);
  const T step = to.angle - from.angle;
  return value_of(step) > pi ? step - 2 * pi : value_of(step) < -pi ? step + 2 * pi : step;
}

// The square of CIEDE2000; the numbers of the equations are those of Sharma, Wu & Dalal 2005.
template <class T>
T squared_difference(const std::array<T, 3>& p, const std::array<T, 3>& q) {
  const T mean_chroma = (hypot(p[1], p[2]) + hypot(q[1], q[2])) * 0.5;                    // (2), (3)
  const T stretch = 1.5 - high_chroma(mean_chroma) * 0.5;                                 // (4), 1 + G
  const Hue<T> x = hue_of(T(stretch * p[1]), p[2]), y = hue_of(T(stretch * q[1]), q[2]);  // (5) to (7)
  const T dl = q[0] - p[0], dc = y.chroma - x.chroma;                                     // (8), (9)
  const T dh = sqrt(x.chroma * y.chroma) * sin(hue_step(x, y) * 0.5) * 2.0;               // (10), (11)
  const T chroma = (x.chroma + y.chroma) * 0.5, hue = mean_hue(x, y);                     // (13), (14)
  const T t = 1 - 0.17 * cos(hue - 30 * degree) + 0.24 * cos(2.0 * hue) + 0.32 * cos(3.0 * hue + 6 * degree) -
              0.20 * cos(4.0 * hue - 63 * degree);  // (15)
  const T from_blue = (hue - 275 * degree) * (1 / (25 * degree));
  const T turn = 30 * degree * exp(-(from_blue * from_blue));  // (16)
  const T off = (p[0] + q[0]) * 0.5 - 50.0, off2 = off * off;
  const T sl = 1 + 0.015 * off2 / sqrt(20 + off2), sc = 1 + 0.045 * chroma, sh = 1 + 0.015 * chroma * t;
  const T rotation = -(sin(2.0 * turn) * high_chroma(chroma)) * 2.0;  // (17), (21)
  const T l = dl / sl, c = dc / sc, h = dh / sh;
  return l * l + c * c + h * h + rotation * c * h;  // (22)
}

// CIE 15:2018, table 6: daylight components at 380, 390 ... 780 nm.
struct Daylight {
  double s0, s1, s2;
};
constexpr std::array<Daylight, 41> daylight = {{
    {63.4, 38.5, 3.0},   {65.8, 35.0, 1.2},   {94.8, 43.4, -1.1},  {104.8, 46.3, -0.5}, {105.9, 43.9, -0.7},
    {96.8, 37.1, -1.2},  {113.9, 36.7, -2.6}, {125.6, 35.9, -2.9}, {125.5, 32.6, -2.8}, {121.3, 27.9, -2.6},
    {121.3, 24.3, -2.6}, {113.5, 20.1, -1.8}, {113.1, 16.2, -1.5}, {110.8, 13.2, -1.3}, {106.5, 8.6, -1.2},
    {108.8, 6.1, -1.0},  {105.3, 4.2, -0.5},  {104.4, 1.9, -0.3},  {100.0, 0.0, 0.0},   {96.0, -1.6, 0.2},
    {95.1, -3.5, 0.5},   {89.1, -3.5, 2.1},   {90.5, -5.8, 3.2},   {90.3, -7.2, 4.1},   {88.4, -8.6, 4.7},
    {84.0, -9.5, 5.1},   {85.1, -10.9, 6.7},  {81.9, -10.7, 7.3},  {82.6, -12.0, 8.6},  {84.9, -14.0, 9.8},
    {81.3, -13.6, 10.2}, {71.9, -12.0, 8.3},  {74.3, -13.3, 9.6},  {76.4, -12.9, 8.5},  {63.3, -10.6, 7.0},
    {71.7, -11.6, 7.6},  {77.0, -12.2, 8.0},  {65.2, -10.2, 6.7},  {47.7, -7.8, 5.2},   {68.6, -11.2, 7.4},
    {65.0, -10.4, 6.8},
}};

std::function<double(double)> daylight_of(double temperature_k) {
  const double t = 1e3 / temperature_k;
  const double x = temperature_k <= 7000 ? ((-4.6070 * t + 2.9678) * t + 0.09911) * t + 0.244063
                                         : ((-2.0064 * t + 1.9018) * t + 0.24748) * t + 0.237040;
  const double y = -3 * x * x + 2.870 * x - 0.275, below = 0.0241 + 0.2562 * x - 0.7341 * y;
  // Three decimals, as CIE 15 rounds them.
  const double m1 = std::round(1e3 * (-1.3515 - 1.7703 * x + 5.9114 * y) / below) / 1e3;
  const double m2 = std::round(1e3 * (0.0300 - 31.4424 * x + 30.0717 * y) / below) / 1e3;
  return [m1, m2](double wavelength_m) {
    const double at = std::clamp((wavelength_m - 380e-9) / 10e-9, 0.0, daylight.size() - 1.0);
    const auto i = std::min(static_cast<std::size_t>(at), daylight.size() - 2);
    const auto power = [&](const Daylight& d) { return d.s0 + m1 * d.s1 + m2 * d.s2; };
    return std::lerp(power(daylight[i]), power(daylight[i + 1]), at - static_cast<double>(i));
  };
}

}  // namespace

Lab lab_from_xyz(Xyz xyz, Xyz white) {
  const double x = forward(xyz.x / white.x), y = forward(xyz.y / white.y), z = forward(xyz.z / white.z);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Xyz xyz_from_lab(Lab lab, Xyz white) {
  const double y = (lab.x + 16) / 116;
  return {white.x * backward(y + lab.y / 500), white.y * backward(y), white.z * backward(y - lab.z / 200)};
}

Mat3 lab_slopes(Xyz xyz, Xyz white) {
  const double x = forward_slope(xyz.x / white.x) / white.x, y = forward_slope(xyz.y / white.y) / white.y,
               z = forward_slope(xyz.z / white.z) / white.z;
  return {{0, 116 * y, 0, 500 * x, -500 * y, 0, 0, 200 * y, -200 * z}};
}

double ciede2000(Lab a, Lab b) {
  return std::sqrt(
      std::max(0.0, squared_difference(std::array<double, 3>{a.x, a.y, a.z}, std::array<double, 3>{b.x, b.y, b.z})));
}

SlopedDifference ciede2000_sloped(Lab a, Lab b) {
  using D = Dual<3>;
  const D square = squared_difference(std::array<D, 3>{D(a.x), D(a.y), D(a.z)},
                                      std::array<D, 3>{D::unknown(b.x, 0), D::unknown(b.y, 1), D::unknown(b.z, 2)});
  if (!(square.v > 0)) return {};
  const D root = sqrt(square);
  return {root.v, {root.d[0], root.d[1], root.d[2]}};
}

Mat3 bradford(Xyz from, Xyz to) {
  constexpr Mat3 cones{{0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296}};
  const Vec3 a = cones * from, b = cones * to;
  return inverse(cones) * Mat3{{b.x / a.x, 0, 0, 0, b.y / a.y, 0, 0, 0, b.z / a.z}} * cones;
}

const Mat3& cie_rgb_from_xyz() {
  // The matrix of optics/colour.h without its factor 1 / 0.17697: rows whose sum is one, so that white stays white.
  static const Mat3 matrix = inverse({{0.49, 0.31, 0.20, 0.17697, 0.81240, 0.01063, 0, 0.01, 0.99}});
  return matrix;
}

const Mat3& srgb_from_xyz() {
  static const Mat3 matrix =
      inverse({{0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.0721750, 0.0193339, 0.1191920, 0.9503041}});
  return matrix;
}

Xyz xyz_of(const std::function<double(double)>& reflectance, const std::function<double(double)>& light) {
  Xyz sum;
  double luminance = 0;
  for (std::size_t i = 0; i < observer_rows; ++i) {
    const double wavelength_m = 380e-9 + 5e-9 * static_cast<double>(i), power = light(wavelength_m);
    sum += standard_observer[i] * (power * reflectance(wavelength_m));
    luminance += standard_observer[i].y * power;
  }
  return sum / luminance;
}

std::function<double(double)> illuminant(const std::string& name, const std::string& place) {
  if (name == "E") return [](double) { return 1.0; };
  if (name == "A")
    return [](double wavelength_m) {
      constexpr double c = 1.435e-2 / 2848, reference_m = 560e-9;
      return std::pow(reference_m / wavelength_m, 5) * std::expm1(c / reference_m) / std::expm1(c / wavelength_m);
    };
  if (name.size() == 3 && name[0] == 'D' && name[1] >= '4' && name[1] <= '9' && name[2] >= '0' && name[2] <= '9')
    // The second radiation constant was 1.4380e-2 m K when daylight was given its temperatures.
    return daylight_of(100 * std::stod(name.substr(1)) * 1.4388 / 1.4380);
  throw Error(Exit::usage, place, "is no light that is known: " + name, "say A, E, D50, D55, D65 or D75");
}

}  // namespace gonio::optics
