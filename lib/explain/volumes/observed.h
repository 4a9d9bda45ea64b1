// What is read off a volume beside the believed surface, and what is known of each reading.
//
// Places are drawn evenly over the surface by its area, no two nearer than a few voxels, where a wall is flat enough
// to be a wall over two voxels round the place, with material behind and air before it. At each: the edge along the
// normal (volume/threshold.h), and one grey value below and one above the surface, at depths between 3.5 voxels (4.5
// widths of the edges, where that is more) and the next wall less as many.
//
// Noise: of each kind of reading, what a reading differs by from the mean of its six nearest neighbours of the kind:
// voxels' noise and all that a smooth effect cannot do. Readings beyond six such widths are left out and counted.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "explain/volumes/volumes_problem.h"

namespace gonio::explain::volumes {

enum class Reading : std::uint8_t { wall, width, inside, outside };
inline constexpr std::size_t readings = 4;
inline bool is_grey(Reading reading) {
  return reading == Reading::inside || reading == Reading::outside;
}
inline constexpr std::array<double, 4> scatter_shares{0.03, 0.1, 0.3, 1};

struct Row {
  Reading reading = Reading::wall;
  Vec3 at_m{}, normal{};  // scanner's frame, believed; of grey values the place where they were read
  double value = 0, sigma = 1;
  double curvature = 0;  // of the surface, 1/voxel, positive where it bulges
  double depth = 0;      // of grey values: to the nearer wall along the normal, voxels
  double path_m = 0;     // mean length of the rays in the slice's plane through the place
  // What filtered back-projection makes of ... at grey values, as shares of material less air:
  double hardening = 0;  // p^2 / p_max
  // ln(1 + s exp(p) G * (p exp(-p))) / s at the shares s, p in attenuation lengths, G a wide Gaussian
  std::array<double, 4> scatter{};
  double markers = 0;  // the same as hardening for paths through markers
  double marker_path_m = 0;
  double ring = 0;  // what other sectors show at this radius and slice, root mean square one
  std::uint32_t block = 0;
  std::size_t group = 0;
};

struct Observed {
  std::vector<Row> rows;  // by group
  std::size_t groups = 0, blocks = 0;
  double voxel_m = 0;  // the smallest spacing
  double field_m = 0;  // radius of the circle within a slice
  double half_height_m = 0;
  double air = 0, material = 0;  // values of the volume that count as 0 and 1
  Vec3 moved_m{}, turned_rad{};  // of the believed shape, to where the readings were taken
  double typical_width = 0;      // of edges, voxels
  std::size_t sites = 0, left_out = 0;
  double voxel_noise = 0;  // of one voxel, as a share of material less air
  double ring_rms = 0;     // of the template before it was scaled
  double longest_path_m = 0;
};

// Error(data) in words where too little of the surface can be read.
Observed observed(const VolumesInput& input);

}  // namespace gonio::explain::volumes
