// Corrections of a volume before it is cut, each switched on by name and each with its figures.
#pragma once
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/volume.h"

namespace gonio::volume {

// A smooth multiplicative field fitted to one material (polynomial of `degree` in the three coordinates, robust, voxels
// deep inside the material and deep in air weighted by their noise); divided out, so that the material has one value.
struct CuppingField {
  int degree = 0;
  std::vector<double> coefficients;  // of monomials x^a y^b z^c, a + b + c <= degree, x in [-1, 1] over the volume
  double before = 0, after = 0;      // sd of the material's slowly varying part, as a share of object - air
  double air = 0, object = 0;
  double lowest = 1, highest = 1;  // over the material; nowhere else does the field go beyond them
  double at(const std::array<std::size_t, 3>& size, double i, double j, double k) const;  // 1 where there is none
};
CuppingField fit_cupping(io::VolumeSource& source, double air, double object, int degree = 4);

// Rings round the slices' rotation centre: per slice and radius, the median over the angle of what is left after a
// median along the radius (Sijbers & Postnov 2004), taken off.
struct RingWish {
  double centre_i = 0, centre_j = 0;  // index coordinates
  std::size_t window = 21;            // voxels of radius
  // Half-way between air and object: what lies within three voxels of this contour, such as a wall that stands round
  // the centre, is no ring.
  std::optional<double> threshold{};
};

enum class Denoise { none, anisotropic, non_local };
struct CorrectWish {
  const CuppingField* cupping = nullptr;
  const RingWish* rings = nullptr;
  Denoise denoise = Denoise::none;  // CImg: blur_anisotropic (tensor diffusion) or blur_patch (non-local means)
  double noise = 0;                 // sd of the noise, in values
  double strength = 1;
};
// Reads through; each slab with enough neighbours that seams do not show: denoised in blocks of 16 slices, whoever
// reads how many at once. Error(usage) where denoising is asked for and no noise is known.
std::unique_ptr<io::VolumeSource> corrected(io::VolumeSource& source, const CorrectWish& wish);

// What a correction did to edges: 10-90 % width before and after along the same normals, and how far the edges moved.
struct EdgeChange {
  std::size_t edges = 0;
  double width_before_voxels = 0, width_after_voxels = 0;
  double mean_shift_voxels = 0, sigma_mean_shift = 0, rms_shift_voxels = 0;  // along the outward normal
};
// Walls thicker than the edge's reach (4 voxels), at up to 1500 places; none: edges == 0.
EdgeChange edge_change(io::VolumeSource& before, io::VolumeSource& after, double air, double object, double noise);

}  // namespace gonio::volume
