// What a volume is like before anybody cuts it: materials in its histogram, noise, resolution, and the artefacts of the
// reconstruction (cupping, rings, streaks, an object that the field of view cuts). Nothing is changed here; every
// figure says what it was measured on.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/volume.h"

namespace gonio::volume {

struct Histogram {
  double low = 0, high = 0;  // bin b covers low + b * (high - low) / counts.size() ...
  std::vector<std::uint64_t> counts;
  std::uint64_t not_finite = 0;
  double smallest = 0, largest = 0;  // of the values
};
// 8-bit data: 256 bins of width 1 centred at the codes; else `bins` between the extremes (two passes).
Histogram histogram(io::VolumeSource& source, std::size_t bins = 4096);

// One material: a normal component of the histogram's mixture, by expectation maximisation from k-means starts. Between
// two materials voxels that hold both lie anywhere between (partial volume, Santago & Gage 1993): they are a component
// of their own, uniform between two neighbouring means and smeared by the noise. Two components without a mode each are
// one material with a slope in it (cupping), and are not told apart.
struct Material {
  double mean = 0, sd = 0, share = 0;
  double sigma_mean = 0;     // standard error of the mean, from the effective number of voxels
  double partial_above = 0;  // share of the voxels that hold this one and the next denser
};
struct Mixture {
  std::vector<Material> materials;  // by mean
  double partial_share = 0;
  double bic = 0;
};
Mixture materials(const Histogram& histogram, int count);  // as many as asked
Mixture materials(const Histogram& histogram);             // 2 to 5, smallest BIC

struct Look {
  Histogram histogram;
  Mixture mixture;
  // Which materials the figures below are of. Air: the lowest that has a thirtieth of the voxels of the largest (dark
  // streaks and what scanners store beyond their circle are lower and fewer). Object: the densest that has a fifth of
  // the voxels of the largest beside air.
  std::size_t air = 0, object = 0;  // both 0: there is one material only, and no figure below
  double otsu = 0;                  // threshold of greatest between-class variance (Otsu 1979)
  double noise_air = 0;             // sd of high-pass residuals among voxels of air (robust)
  double noise_object = 0;          // the same among voxels whose 26 neighbours are of the densest large material;
                                    // 0: no wall is thick enough
  double noise_correlation = 0;     // of residuals of direct neighbours in air
  std::optional<double> edge_width_voxels{};  // 10 % to 90 % of a normal edge spread, median over the surface
  std::optional<double> sigma_edge_width{};
  // (Value 3 to 5 voxels below the surface - value in the deepest tenth) / (object - air) of one material; 0: none, or
  // no wall is 16 voxels thick.
  double cupping = 0;
  double ring = 0;  // sd of what a radius round the slices' centre has in common at all angles / noise; 0: none
  // By how much means over 3 x 3 x 3 voxels of air vary more within the object's hull than far outside it / (object -
  // air); 0: none
  double streak = 0;
  bool cut_by_field = false;  // the object touches a face of the volume, or leaves the scanner's circle
  std::size_t cut_voxels = 0;
};
// `mask`-less: materials decide what is object. Reads the volume a few times.
Look look(io::VolumeSource& source);

}  // namespace gonio::volume
