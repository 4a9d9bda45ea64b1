// Where the wall is: the threshold of a volume, and the sub-voxel position of an edge.
//
// Three ways: from the histogram (half-way between two materials' means, ISO 50, or Otsu's), from the steepest gradient
// (per vertex, so that a slowly varying value does not move walls), or from a length that is known (the threshold at
// which spheres of known radius have it). Each has an uncertainty; `length_bias` says what it does to a length.
//
// Lengths are voxels of the smallest spacing. Where spacings differ, `scale` holds them over the smallest: an index
// times `scale` is a place in which lengths and normals mean something.
#pragma once
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "io/volume.h"
#include "volume/contour.h"
#include "volume/look.h"

namespace gonio::volume {

struct Threshold {
  double value = 0, sigma = 0;
  std::string how;  // "half-way between 12.1 and 96.4", "Otsu", "reference length", "as asked"
  // d(wall position along the outward normal) / d(threshold), voxels per value, mean over the surface: how far a
  // threshold that is wrong by one moves every wall. Negative; set by voxels_per_value.
  double voxels_per_value = 0;
  double sigma_wall_voxels() const { return sigma * std::abs(voxels_per_value); }
};
// Error(data) where the mixture has no such two materials.
Threshold half_way(const Mixture& mixture, std::size_t lower, std::size_t upper);
// The same with means and their errors from the slices themselves: voxels within two sd of either mean, by a jackknife
// over ten blocks of slices, so that noise which neighbours share and a value that drifts along the scan count.
Threshold half_way(io::VolumeSource& source, const Mixture& mixture, std::size_t lower, std::size_t upper);
// Greatest between-class variance (Otsu 1979). sigma: by the delta method from T = (m0(T) + m1(T)) / 2, of which one
// voxel in `voxels_per_sample` counts (neighbours share noise), and the bins' width. Error(data) where all agree.
Threshold otsu(const Histogram& histogram, double voxels_per_sample = 1);

// The mean of 1 / (dv/ds) over the surface, by the coarea formula from what is robust against noise: voxels whose value
// lies within dT of the threshold fill a layer dT / |dv/ds| thick, so that the mean is the density of the histogram at
// the threshold over the area of the surface. Where noise makes voxels of plain material cross the threshold, they
// count too. Error(data) where the surface is empty.
double voxels_per_value(const Histogram& histogram, const Contour& at, double threshold, Vec3 scale = {1, 1, 1});

// A sphere whose radius is known: centre in index coordinates, radius in voxels of the smallest spacing.
struct ReferenceSphere {
  Vec3 centre{};
  double radius = 0, sigma_radius = 0;
};
// The threshold at which the spheres have their radii, in the mean: each radius at a threshold is the mean of where the
// radial profiles of the volume cross it, over those directions in which the value falls outwards as it does in most.
// sigma: from the scatter of the spheres' own thresholds, no less than what their radii's errors make of it.
// voxels_per_value is set. Error(data) where no threshold does it.
Threshold reference_length(io::VolumeSource& source, std::span<const ReferenceSphere> spheres, Vec3 scale = {1, 1, 1});

// By how much a length between two walls that face outwards comes out too long (voxels) at `used`, were `better` right.
// A length between walls that face inwards (a bore) is too short by as much, one between walls that face alike right.
double length_bias(const Threshold& used, double better);

// One edge, from values along a normal: a step smeared by a normal spread function, air + (object - air) * Phi(-(s -
// position) / width), fitted by least squares. s along the outward normal in voxels; 0 is where the contour stands.
//
// Of a curved wall the spread function moves the step: a ball of radius R, smeared by an isotropic normal function, is
//   Phi(-x / w) - (w / r) phi(x / w),  x = r - R                          (but for terms of exp(-2 R^2 / w^2))
// along its radius, which is steepest w^2 / R further in than the wall; a wall of mean curvature H = 1 / R to first
// order alike (Bouma et al. 2005, "Correction for the dislocation of curved surfaces caused by the PSF in 2D and 3D CT
// images"). The fit has this term, so that `position` is the wall.
struct Edge {
  double position = 0, sigma = 0;  // voxels along the normal
  double width = 0;            // sd of the spread function, voxels (where samples are interpolated: 1/6 more variance)
  double air = 0, object = 0;  // object: at the contour, where it slants
  double sigma_air = 0, sigma_object = 0, sigma_width = 0;
  double slope = 0;   // of the object's values along the normal, per voxel, where it was asked for
  double misfit = 0;  // rms residual / (object - air)
  bool good = false;  // converged, step > 3 noise, |position| within half the profile
  // Distance from the contour to the next wall behind and in front of this one, where the profile met one.
  double inward = std::numeric_limits<double>::infinity(), outward = std::numeric_limits<double>::infinity();
  // Sum of squared residuals over what the noise foretells; where the noise was not given: its estimated variance.
  double excess = 1;
};

struct Known {
  double mean = 0, sd = 0;
};
// What is known of a profile beside its values.
struct ProfileWish {
  double noise = 0;  // sd of a voxel; 0: from the residuals
  // Of the samples, in units of noise^2, row by row; empty: samples are independent. trilinear_covariance gives it.
  std::span<const double> covariance{};
  double mean_curvature = 0;  // of the wall, 1 / voxel, positive where it is convex outwards
  // Start positions of the walls behind (s < 0) and before (s > 0): a wall too thin for its plateau, or a gap too
  // narrow for air, is fitted as two edges of one width.
  std::optional<double> inner{}, outer{};
  std::optional<double> width{};         // known from elsewhere, within
  double width_share = 0.07;             // ... so much of it (sd)
  std::optional<Known> air{}, object{};  // plateaus, from neighbours
  double slope = 0;                      // of the object's values along the normal, per voxel
  bool slope_is_free = false;            // fit it too, from 0; of edges that stand alone
  std::span<const double> weights{};     // sample n varies as noise^2 / weights[n]; empty: all as one another
};
Edge fit_edge(std::span<const double> s, std::span<const double> values, const ProfileWish& wish);
Edge fit_edge(std::span<const double> s, std::span<const double> values, double noise);  // independent samples

// Covariance of `count` trilinear samples at first + n step (index coordinates) of noise with unit variance whose
// correlation between voxels (a, b, c) apart is q^(a^2 + b^2 + c^2), q that of direct neighbours (-0.5 < q < 1; a
// negative one leaves only neighbours correlated).
std::vector<double> trilinear_covariance(Vec3 first, Vec3 step, std::size_t count, double neighbour_correlation);

// Edges nearer to one another than this were fitted to some of the same voxels: their errors are alike.
constexpr double edges_alike_voxels = 3.5;

struct EdgeWish {
  double reach_voxels = 3;  // half the profile; cut short where another wall comes nearer
  double step_voxels = 0.5;
  double noise = 0;               // sd of a voxel; 0: from the residuals of all edges together
  double noise_correlation = 0;   // of direct neighbours
  std::optional<double> width{};  // sd of the spread function where it is known; else as profiles have it
  Vec3 scale{1, 1, 1};            // spacing per axis over the smallest spacing
};
// Edges at vertices of a contour (all, or every n-th), by means over the voxels round the normals. Walls behind and
// before are found by walking along the normal to twice the reach. The volume is streamed twice: first some ten
// thousand vertices tell what edges share, the width across the rotation axis (k) and along it (of means over many
// profiles: of thin walls the mean of widths fitted one by one is too small), the noise, and place for place the
// plateaus and the slope of the object's values beneath the surface (a cup); then every edge is fitted with these known
// as well as they are. Of walls thinner than 2.5 widths thickness and width can hardly be told apart by their profile:
// where a wall is 2.2 widths thick, a width that is wrong by some amount moves both its sides by 2.4 times as much.
// What stands alone elsewhere tells it best. Error(data) where the contour is empty.
std::vector<Edge> edges(io::VolumeSource& source, const Contour& at, const EdgeWish& wish, std::size_t every = 1);

// What the edges themselves say of half-way: by it a global threshold can be judged. bias and rms: of wall positions
// along the normal, in voxels, of a surface at `used`.
struct LocalThreshold {
  double mean = 0, sd = 0;
  double wall_bias = 0, wall_rms = 0;
  std::size_t edges = 0;
};
LocalThreshold local_threshold(const Threshold& used, std::span<const Edge> edges);

// Moves every vertex to the wall along its normal. A vertex' own edge and the planes through its neighbours' (whose
// error for a curved surface cancels between the two normals) are averaged by their errors; edges that are not good
// take their neighbours' shift. No vertex moves by more than `at_most` voxels or by more than a third of the way to the
// opposite wall, so that walls cannot cross; where a triangle would fold over or cross another, the shifts of its
// vertices are halved until it does not.
struct Refined {
  std::size_t moved = 0, held = 0, unfitted = 0;
  double mean_shift = 0, rms_shift = 0, largest_shift = 0;  // voxels
  double sigma_position = 0;                                // median of the edges' own
};
Refined move_to_steepest(Contour& contour, const std::vector<Edge>& edges, double at_most = 1.5,
                         Vec3 scale = {1, 1, 1});

}  // namespace gonio::volume
