// Spherical markers in a CT volume: found without being told how many, refined on sub-voxel edges, false ones refused.
//
// Candidates: RANSAC over oriented edge points (Schnabel et al. 2007; a sphere from two points and normals), largest
// consensus first, until what is left supports no sphere of plausible radius better than chance. Each is refined by
// least squares of edge positions along the radial direction, edges weighted by their own uncertainty, robust (Huber):
// glued markers miss a cap, where glass begins. The covariance counts the edges' own noise and their correlation over
// neighbouring voxels.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "io/volume.h"
#include "volume/contour.h"

namespace gonio::volume {

struct MarkerWish {
  // In voxels (the caller divides by the spacing; unequal spacings are given as scale of the axes).
  std::optional<double> radius{};        // known: held fixed, within `radius_tolerance`
  double radius_tolerance = 0.15;        // share
  double smallest = 3, largest = 100;    // plausible radii where none is known, voxels
  Vec3 scale{1, 1, 1};                   // spacing per axis over the smallest spacing
  double least_cover = 0.35;             // share of the sphere's directions that must show an edge
  double noise = 0;                      // sd of a voxel; 0: from differences of voxels within and round the spheres
  std::optional<double> noise_correlation{};  // of direct neighbours; else from the same differences
  std::uint64_t seed = 0;
};

struct Marker {
  Vec3 centre{};                         // index coordinates
  double radius = 0, sigma_radius = 0;   // voxels of the smallest spacing
  std::array<double, 9> covariance{};    // of the centre, voxels^2 (index coordinates)
  double rms_residual = 0;               // of the edges, voxels
  double cover = 0;                      // share of directions with an edge
  double mean_value = 0;                 // within
  std::size_t edges = 0;
};
struct RefusedMarker {
  Vec3 centre{};
  double radius = 0;
  std::string why;                       // "covers 0.21 of the directions (limit 0.35)", ...
};
struct Markers {
  std::vector<Marker> found;             // by k, j, i of the centre
  std::vector<RefusedMarker> refused;
};
// `surface`: contour at the markers' own threshold. Unknown radius: one free radius per marker first, then, where all
// agree within 5 %, those are taken for one kind (their radii are still free).
Markers markers(io::VolumeSource& source, const Contour& surface, double threshold, const MarkerWish& wish);

}  // namespace gonio::volume
