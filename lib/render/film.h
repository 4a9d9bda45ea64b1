// The film: per pixel the mean of its samples and the variance of that mean, and the geometry that the pixel sees.
//
// Samples come in replicates: each is a full set of side * side strata over the pixel (and over each light), drawn
// independently of the others. The mean of a pixel is the mean of its replicates; the variance of the mean is their
// sample variance over their number, which is unbiased although samples within a replicate are not independent.
#pragma once
#include <string>
#include <vector>

#include "geom/vector.h"
#include "io/image.h"

namespace gonio::render {

struct SamplePlan {
  int side = 1;        // strata per axis
  int replicates = 2;  // independent sets of side^2 samples, at least 2
  int spp() const { return side * side * replicates; }
};
// At least `spp` samples: 16 replicates or more where spp allows, strata up to 8 x 8.
SamplePlan sample_plan(int spp);

struct PixelGeometry {      // of the ray through the pixel's centre, but visibility: share of all samples' shadow rays
  Vec3 position_m, normal;  // world frame; zero where nothing is met
  int id = 0;               // instance + 1; 0: nothing
  std::vector<double> distance_m;  // to each light that is on; 0 where it is infinitely far
  std::vector<double> visibility;  // of each light that is on, 0 .. 1
};

struct Pixel {
  Rgb mean, variance;  // of the mean
  PixelGeometry geometry;
};

// R, G, B, variance.R/G/B, and with `geometry`: id, position.X/Y/Z, normal.X/Y/Z, distance.LIGHT, visibility.LIGHT.
io::Image develop(int width_px, int height_px, const std::vector<Pixel>& pixels, const std::vector<std::string>& lights,
                  bool geometry);

}  // namespace gonio::render
