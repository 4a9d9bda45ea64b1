// What a person sees of a stack: the response with the readings on it, and where in the pictures the named physics
// makes a difference.
//
// Effects: every pixel of a grid over the whole picture is fitted with the shared numbers held, before and after, and
// the difference of the two predictions over the noise of a reading is its effect; where nothing is named, the base
// model's residual takes its place. Files hold effect / (effect + 3), so that 0.5 is three standard deviations.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "explain/engine.h"
#include "explain/stacks/reading_chain.h"
#include "explain/stacks/stack_sites.h"

namespace gonio::explain::stacks {

struct CurveDot {
  int channel = 0;
  double light = 0, reading = 0;
};
// Readings over light, both logarithmic, with the response of every channel and, dashed, a linear sensor. Inline SVG.
std::string curve_drawing(const Stack& stack, const ReadingChain& chain, const std::vector<CurveDot>& dots);

struct Effects {
  int stride = 1, width = 0, height = 0;          // of the grid
  std::vector<std::vector<float>> effect, share;  // by image: |after - before| over sigma, and over the picture's rms
};
Effects empty_effects(const Stack& stack, double most_pixels = 60000);

// Of a stack of exposures; `named`: else the residual of `before`.
Effects exposure_effects(const Stack& stack, const ReadingNoise& noise, const std::vector<Taken>& taken,
                         const ReadingChain& before, const ReadingChain& after, bool named);

// Pictures of the images with the largest effects, boxes where it is beyond three standard deviations and matters, and,
// where `out` is given, effect-<image>.exr and .png for every image.
void add_effects(const Stack& stack, const Effects& effects, const Explanation& e, const std::filesystem::path& out,
                 manifest::Document& document, Illustration& result);

}  // namespace gonio::explain::stacks
