// Synthetic stacks, made by code that shares nothing with the library: a scene of patches and gradients over three
// decades, photon and read noise, a response given as a function, clipping, rounding to codes.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"

namespace gonio::tests {

struct ExposureWorld {
  int width = 72, height = 60, channels = 1;
  std::vector<double> exposures_s{0.004, 0.008, 0.016, 0.032, 0.064, 0.128};
  std::vector<double> times_s{};                  // when each was taken; empty: not said
  std::function<double(double)> response{};       // of light over full scale; empty: linear
  std::function<double(double, double)> light{};  // (light, time) -> light; empty: as it is
  std::vector<double> longer{};                   // share by which each shutter was open longer; empty: 0
  struct Passer {                                 // something opaque of one radiance, in one picture alone
    std::size_t picture = 0;
    int x = 0, y = 0, radius = 0;
    double light = 0;  // over what the scene has there in the middle of its brightness
  };
  std::vector<Passer> passers{};
  double electrons = 20000, read = 0.0005;         // at full scale; of full scale
  double offset = 0, full_scale = 0, extra_s = 0;  // of full scale; 0: no limit but that of codes; s
  int bits = 0;                                    // 0: OpenEXR
  // One channel behind a Bayer grid RGGB: red and blue read so much of what green does. Of what flows over full scale
  // (1) shares go to the neighbours in the column and in the row.
  double red = 0, blue = 0, along = 0, across = 0;
  struct Hot {
    int x = 0, y = 0;
    double per_s = 0;  // of full scale
  };
  std::vector<Hot> hot{};  // of the first channel
  // Of each picture; empty: not said. Rays fill an aperture of radius 1 / N, except where they miss a rim as wide as
  // that of f/rim, which stands `rim_shift` of its radii aside half a picture's width from the centre. 0: there is no
  // rim.
  std::vector<double> f_numbers{};
  double rim = 0, rim_shift = 0;
  double stopped_down = 1;  // what apertures but the widest pass of what they say
  std::uint64_t seed = 1;
};

// Writes the pictures into `folder` and returns the manifest of somebody who believes in a linear sensor.
manifest::Document record(const ExposureWorld& world, const std::filesystem::path& folder);

struct LightWorld {
  int size = 96, lights = 10;
  double f0 = 0, alpha = 0.2, sigma_rad = 0;  // gloss and roughness of the ball
  double gamma = 1, offset = 0, ambient = 0;
  double uneven = 0;  // every third lamp falls off down the picture, by this logarithm over half of it; strengths free
  double turn_rad = 0;  // of every lamp against the manifest, in random directions
  double scale = 0.8;   // reading of a white matte plate that faces the lamp
  double noise = 0.002;
  std::uint64_t seed = 1;
};
// A ball and a ridge, one picture for each distant lamp; the manifest has directions and a mask.
manifest::Document record(const LightWorld& world, const std::filesystem::path& folder);

}  // namespace gonio::tests
