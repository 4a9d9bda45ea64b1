// Spherical markers in a photograph: circles of any size and sharpness, under uneven light, partly hidden, before
// clutter.
//
// Candidates come from the edges' directions (a gradient on a circle points to its centre or away from it), at all
// sizes at once; each is refined by least squares of the cone (outline.h) on edge points found along its
// normals, robust against what hides a part of it, and then on the grey values themselves. What is left is judged by
// how much of the outline shows an edge: of one sign, but a large outline (48 px) may lie before things both darker and
// brighter than it. The covariance is that of independent pixels, enlarged by what the outline's sectors scatter beyond
// that and by how far neighbours lean the same way. Grey values are taken as proportional to light: where they are not
// (gamma), an edge of blur s lies off by a few hundredths of s times the contrast.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "camera/camera_model.h"
#include "io/grey.h"
#include "reassembly/outline.h"

namespace gonio::reassembly {

enum class Contrast { either, bright, dark };  // of a marker against what surrounds it

struct DetectWish {
  double smallest_px = 4, largest_px = 200;  // radii of outlines
  Contrast contrast = Contrast::either;
  double least_cover = 0.5;   // share of the outline that must show an edge; below a radius of 12 px 1.3 times that
  double least_contrast = 6;  // times the picture's noise
  // Where the size of the markers and roughly their distance are known, their outlines are no others.
  std::optional<double> least_half_angle_rad{}, largest_half_angle_rad{};
};

struct Refused {
  Vec2 centre_px;
  double radius_px = 0;
  std::string why;  // "shows 0.31 of its outline (limit 0.5)"
};
struct Detected {
  std::vector<Outline> found;  // from top to bottom, then from left to right
  std::vector<Refused> refused;
};
// `mask`: pixels that count, one byte each, empty: all.
Detected detect_spheres(const io::GreyImage& picture, const camera::CameraModel& camera, const DetectWish& wish,
                        const std::vector<unsigned char>& mask = {});

}  // namespace gonio::reassembly
