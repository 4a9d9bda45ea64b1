// Where in the pictures the mismatch is: the whole picture (not only the sampled pixels) simulated without and with the
// named physics.
#pragma once
#include <cstdint>
#include <vector>

#include "explain/engine.h"
#include "explain/images/model.h"

namespace gonio::explain::images {

struct WholeImage {  // at every `stride`-th pixel of a picture, rows from the top; three channels
  int width = 0, height = 0, stride = 1;
  std::vector<double> observed, before, after, sigma;
  std::vector<std::uint8_t> counts;
};

// Excess of a window of 5 x 5 over the noise: the mean of z^2 - 1 against its own standard error, in standard errors;
// zero where nothing counts. `after`: with the named physics.
std::vector<double> excess(const WholeImage& image, bool after);

// 1 where the excess is above `limit` standard errors and the residual above `smallest_effect` of the picture's rms.
std::vector<std::uint8_t> mismatch_mask(const WholeImage& image, double limit, double smallest_effect);

// Where the named physics acts: |after - before| over the noise, the mean of the colours, e; where nothing was named
// (`after` equals `before`), the root of the excess per value of a window of 5 x 5. Shown as e / (e + 3): 0 where
// nothing happens, one half at three standard deviations.
std::vector<double> effect(const WholeImage& image, bool named);

// Boxes around the connected parts of a mask (eight neighbours), the largest first, at most `most`; parts under `least`
// pixels are left out. In full pixels.
std::vector<Box> boxes_of(const std::vector<std::uint8_t>& mask, const WholeImage& image, std::size_t least,
                          std::size_t most);

// One value a pixel of the full picture.
io::Image spread(const std::vector<double>& values, const WholeImage& image, int width, int height);
// White to dark red; enlarged by a whole factor to about 720 pixels width, like the other pictures.
io::Image effect_picture(const std::vector<double>& effect, const WholeImage& image);

// What a camera shows of it: `values` (three a pixel) by the sRGB curve, `white` as white, clipped above.
io::Image shown(const std::vector<double>& values, const WholeImage& image, double white);

// Signed residual, red where the recording is brighter and blue where it is darker than the simulation; full colour at
// `scale`, pixels that do not count grey.
io::Image residual_picture(const WholeImage& image, bool after, double scale);

// Outlines of boxes on one of these pictures: two pixels of yellow between black ones.
void outline(const std::vector<Box>& boxes, const WholeImage& image, io::Image& picture);

}  // namespace gonio::explain::images
