// Tristimulus values and what people see of them: CIE XYZ, L*a*b*, colour differences, adaptation to another white.
//
// XYZ of the 1931 2-degree observer, relative: the perfect reflecting diffuser has Y = 1, not 100. Lab values are about
// the white that is passed along.
#pragma once
#include <functional>
#include <string>

#include "geom/vector.h"

namespace gonio::optics {

using Xyz = Vec3;
using Lab = Vec3;  // L*, a*, b*

inline constexpr Xyz white_d50{0.96422, 1, 0.82521};  // ICC profile connection space
inline constexpr Xyz white_d65{0.95047, 1, 1.08883};  // CIE 15:2018
inline constexpr Xyz white_equal_energy{1, 1, 1};

// CIE 15:2018, 8.2.1.
Lab lab_from_xyz(Xyz xyz, Xyz white);
Xyz xyz_from_lab(Lab lab, Xyz white);
Mat3 lab_slopes(Xyz xyz, Xyz white);  // d Lab / d XYZ

// CIEDE2000 (ISO/CIE 11664-6), weights k_L = k_C = k_H = 1, as Sharma, Wu & Dalal 2005 write it out:
// "The CIEDE2000 color-difference formula: implementation notes, supplementary test data, and mathematical
// observations". The first colour is the reference; the formula is symmetric but for rounding.
double ciede2000(Lab a, Lab b);
// The same and its slopes by the second colour; where the two are equal, which has none, zero.
struct SlopedDifference {
  double value = 0;
  Vec3 slope;
};
SlopedDifference ciede2000_sloped(Lab a, Lab b);

// Von Kries's rule in Bradford's cone space (Lam 1985; ICC.1:2022, annex E): XYZ that look under white `to` as the
// argument does under `from`.
Mat3 bradford(Xyz from, Xyz to);

// Linear RGB of white (1, 1, 1) from XYZ whose white is equal energy: CIE RGB by the normalised matching functions of
// optics/colour.h, in which a constant spectrum is its own number.
const Mat3& cie_rgb_from_xyz();
// Linear RGB of IEC 61966-2-1 from XYZ whose white is D65.
const Mat3& srgb_from_xyz();

// Light of a spectrum (over metres, any unit) off a reflectance: relative to that off the perfect diffuser. Sums over
// the observer's table at 5 nm, 380 to 780 nm (CIE 15:2018, 7.1). With reflectance 1 it is the light's white point.
Xyz xyz_of(const std::function<double(double)>& reflectance, const std::function<double(double)>& light);

// Relative spectral power of a CIE illuminant at a wavelength: "A" (CIE 15:2018, 4.1.1), "D50", "D65" (any "D" and two
// digits from 40 to 99 that stand for hundreds of kelvins; 4.1.2 and 4.2, daylight components at 10 nm, linear in
// between, as CIE 15 recommends), "E". Error(usage) at `place` for other names.
std::function<double(double)> illuminant(const std::string& name, const std::string& place);

}  // namespace gonio::optics
