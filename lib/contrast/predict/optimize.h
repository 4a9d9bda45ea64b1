// The surface of greatest contrast: parameters within bounds that make the mean contrast of the experiment (over tilts
// and pairs), or the least of its tilts, as large as possible, and how much each of them matters there.
//
// Pitch of ridges. Geometrical optics does not know it: f of `ridged` is the same for every pitch. Two things bound it.
//   Above, the ridges must not be seen one by one: pitch <= distance * acuity (0.3 mrad of the eye, the 150 um at
//   0.5 m of Luongo et al. 2017; of a camera the width of a pixel over the distance to the lens).
//   Below, a facet of length w = pitch cos(theta_r) spreads light as a slit does: sinc^2 of w sin(angle) / lambda, full
//   width at half maximum 0.886 lambda / w in angle, half of that in the slope of the half vector. It is taken as
//   Beckmann roughness of equal full width, 2 sqrt(ln 2) alpha_d = 0.443 lambda / w,
//     alpha_d = 0.266 lambda / (pitch cos(theta_r)),  alpha_v^2 -> alpha_v^2 + alpha_d^2,
//   facets adding up without interference: a lamp whose light is coherent over several ridges shows orders of a grating
//   instead, which this does not describe. Where narrow lobes are wanted, contrast grows with the pitch, and the best
//   one is the largest that is not seen.
//
// Search: a low-discrepancy set over the box (Roberts 2018), the best of it refined by Nelder & Mead 1965, points kept
// in the box by projection.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "contrast/predict/predict.h"

namespace gonio::contrast {

inline constexpr const char* pitch_name = "pitch_m";

struct Bound {
  std::string parameter;  // of the model, or pitch_m
  double lower = 0, upper = 0;
};
struct Wish {
  Experiment experiment;
  std::vector<Bound> bounds;
  bool least = false;  // the tilt of least contrast counts, not their mean
  double wavelength_m = 550e-9;
  int points = 3000;  // of the first set
};
struct Optimum {
  struct Number {
    std::string parameter;
    double value = 0;
    Bound bound;
    int at_bound = 0;                     // -1: the lower one holds it, 1: the upper one; contrast rises there
    double keeps_from = 0, keeps_to = 0;  // range, the others fixed, that keeps 95 % of the contrast
    double less = 0, more = 0;            // contrast over the optimum's with the value 10 % smaller, larger (in bounds)
    std::vector<double> at{}, contrast{};  // a scan across the bounds, the others fixed
  };
  double contrast = 0;
  std::vector<Number> numbers;
  manifest::Parameters parameters;  // of the surface, as it would be made: without pitch and what diffraction adds
  int evaluations = 0;
};

// Roughness that diffraction at facets of this pitch adds across the ridges.
double diffraction_alpha(double pitch_m, double ridge_rad, double wavelength_m);

// Mean (or least) contrast at `values` of the bounds' parameters.
double contrast_at(const Specimen& specimen, const Wish& wish, const std::vector<double>& values);

// Error(usage) at --bound for empty or turned ranges, values the model does not take, pitch_m of another model than
// ridged.
Optimum optimize(const Specimen& specimen, const Wish& wish);

std::string optimum_csv(const Optimum& optimum);
// "ridge_rad 5.00 degrees, alpha_u 0.02 (held by its lower bound)"
std::string optimum_sentence(const Optimum& optimum, const Wish& wish);

}  // namespace gonio::contrast
