// Where the wall is: the threshold of a volume, and the sub-voxel position of an edge.
//
// Three ways: from the histogram (half-way between two materials' means, ISO 50, or Otsu's), from the steepest gradient
// (per vertex, so that a slowly varying value does not move walls), or from a length that is known (the threshold at
// which spheres of known radius have it). Each has an uncertainty; `length_bias` says what it does to a length.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/volume.h"
#include "volume/contour.h"
#include "volume/look.h"

namespace gonio::volume {

struct Threshold {
  double value = 0, sigma = 0;
  std::string how;                     // "half-way between 12.1 and 96.4", "Otsu", "reference length", "as asked"
  // d(wall position along the outward normal) / d(threshold), voxels per value, mean over the surface: how far a
  // threshold that is wrong by one moves every wall.
  double voxels_per_value = 0;
  double sigma_wall_voxels() const { return sigma * (voxels_per_value < 0 ? -voxels_per_value : voxels_per_value); }
};
Threshold half_way(const Mixture& mixture, std::size_t lower, std::size_t upper);
Threshold otsu(const Histogram& histogram);

// One edge, from values along a normal: a step smeared by a normal spread function, air + (object - air) * Phi(-(s -
// position) / width), fitted by least squares. s along the outward normal in voxels; 0 is where the contour stands.
struct Edge {
  double position = 0, sigma = 0;      // voxels along the normal
  double width = 0;                    // sd of the spread function, voxels
  double air = 0, object = 0;
  double misfit = 0;                   // rms residual / (object - air)
  bool good = false;                   // converged, step > 3 noise, |position| within half the profile
};
Edge fit_edge(std::span<const double> s, std::span<const double> values, double noise);

struct EdgeWish {
  double reach_voxels = 3;             // half the profile; cut short where another wall comes nearer
  double step_voxels = 0.5;
  double noise = 0;
};
// Edges at vertices of a contour (all, or every n-th), by trilinear samples of the volume along the normals. The volume
// is streamed once; vertices are taken slab by slab.
std::vector<Edge> edges(io::VolumeSource& source, const Contour& at, const EdgeWish& wish, std::size_t every = 1);

// Moves every vertex to the steepest gradient along its normal. Positions of neighbours are weighted by their
// uncertainty (edges that are not good take their neighbours' shift); no vertex moves by more than `at_most` voxels or
// by more than a third of the way to the opposite wall, so that walls cannot cross.
struct Refined {
  std::size_t moved = 0, held = 0, unfitted = 0;
  double mean_shift = 0, rms_shift = 0, largest_shift = 0;  // voxels
  double sigma_position = 0;                                // median of the edges' own
};
Refined move_to_steepest(Contour& contour, const std::vector<Edge>& edges, double at_most = 1.5);

}  // namespace gonio::volume
