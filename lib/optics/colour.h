// Spectra and three numbers: which linear RGB stands for a spectrum, and which spectrum for an RGB.
//
// Matching functions: CIE RGB of the 1931 2-degree observer (primaries 700, 546.1 and 435.8 nm), from the tabulated
// x, y, z of ISO/CIE 11664-1 at 5 nm, 380 to 780 nm, by the inverse of
//   [X Y Z]' = 1/0.17697 [0.49 0.31 0.20; 0.17697 0.81240 0.01063; 0 0.01 0.99] [R G B]'.
// Against the published CIE RGB table, at the wavelengths that a test holds: within 5e-5, its last digit and the
// matrix's. r, g and b have equal integrals (equal energy is white): within 1.5e-4 over this range.
//
// Normalised, each function has the integral one, so that a constant is its own RGB. This is how a refractive index,
// which is no colour, becomes three numbers: averages over red, green and blue. r is negative from 437 to 547 nm, its
// lobe -0.29 of the integral; the weights are used with their sign, which makes an index that is linear in the
// wavelength exact at the functions' centres of mass (rgb_centres_m(): 637, 545 and 453 nm), and the result is kept
// within the smallest and the largest value that the spectrum takes.
#pragma once
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "geom/vector.h"
#include "optics/bands.h"
#include "optics/refractive_index.h"
#include "optics/spectrum.h"

namespace gonio::optics {

inline constexpr double first_visible_m = 380e-9, last_visible_m = 780e-9;

Rgb matching_functions(double wavelength_m);             // as tabulated; linear in between; zero outside the visible
Rgb normalised_matching_functions(double wavelength_m);  // integral over metres one each

// Weights of samples at growing wavelengths, by the trapezoidal rule, each colour's sum made one.
// Error(data) at `place` where a colour is left without weight.
std::vector<Rgb> rgb_weights(std::span<const double> wavelength_m, const std::string& place);
// Integral over the visible of a function of the wavelength with the normalised functions.
Rgb rgb_of(const std::function<double(double)>& spectrum);
Rgb rgb_centres_m();  // of mass

// What stands for a spectrum in a renderer: at each of the bands' wavelengths, or RGB. For RGB a spectrum need not
// cover all of the visible: beyond its ends the end's value holds; where that concerns more than `held_warning` of the
// absolute weight of a colour it is logged, above `held_limit` it is Error(data).
inline constexpr double held_warning = 0.05, held_limit = 0.5;
Rgb band_values(const std::function<double(double)>& spectrum, Range covered, const Bands& bands,
                const std::string& place);
Rgb band_values(const Spectrum& spectrum, const Bands& bands);

// A smooth spectrum for an RGB: R b_r + G b_g + B b_b with a fixed basis (three cosine-edged boxes that meet at 480 and
// 590 nm, combined so that the normalised matching functions of b_r are 1, 0, 0, and so on). Integrated with those
// functions it is the RGB again; grey stays grey at every wavelength. Saturated colours leave [0, 1] by up to 0.2 of
// their largest number, and negative values: callers clamp to what a quantity may be, at the cost of saturation.
double upsampled(Rgb value, double wavelength_m);
Rgb upsampled(Rgb value, const Bands& bands);  // itself in RGB

}  // namespace gonio::optics
