// From a wished figure of the printed surface to the micro-structure that gives it, by simulated prints of a flat
// patch: structure, grey values, spread light, growth, the printer's noise, and what roughness(1) or lobe(1) would say
// of it.
//
// One number of the structure is moved: the amplitude of noise, the share of a sinusoid, the tilt of ridges, or, for an
// anisotropy, the longer of a sinusoid's waves. Its range is looked through at even steps (of its logarithm where that
// is how it counts), and where the figure passes the wished value, halved. What no number reaches is said with the
// range that there is.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "manifest/sections/print.h"
#include "print/prediction.h"
#include "relief/microstructure.h"

namespace gonio::print {

enum class WishedFigure {
  sq,          // root mean square height, m
  sa,          // mean of heights' magnitude, m
  alpha,       // microfacet roughness (Beckmann), over both axes
  anisotropy,  // alpha across the long waves over alpha along them, at least 1
  contrast     // (a - b) / (a + b) of what the patch and the patch turned by a right angle send to the eye
};
const std::vector<std::string>& wished_figures();  // names, in the enum's order

struct Wish {
  WishedFigure figure = WishedFigure::sq;
  double value = 0;
  double incidence_rad = 0,
         view_rad = 0;  // contrast: of light and eye, from the normal, in one plane across the ridges
  double eta = 1.5;     // contrast: of the resin
};
struct DesignStep {
  double strength = 0, figure = 0;
};
struct Design {
  manifest::MicrostructureUse use;
  std::string moved;           // the parameter
  double reached = 0;          // by the structure that is returned
  double sigma = 0;            // of another patch of the same
  double least = 0, most = 0;  // that were seen
  bool met = false;            // within a twentieth, or two sigmas
  std::vector<DesignStep> tried;
  io::HeightMap map;  // of the patch
};
// `form`: the structure to move; nothing: noise for heights and slopes (the finest that reaches the figure), a sinusoid
// for anisotropy, ridges for contrast.
// Error(data) at `place` for a form that has no number to move.
Design design(const Printer& printer, const Wish& wish, const std::optional<GroundAt>& ground,
              const std::optional<manifest::MicrostructureUse>& form, int points, std::uint64_t seed,
              const std::string& place);

// The simulated print of a flat patch of `side_px` pixels with a structure in its last layer, its borders cut off.
io::HeightMap printed_patch(const Printer& printer, const relief::ShareAt& structure,
                            const std::optional<GroundAt>& ground, int side_px, int points);

}  // namespace gonio::print
