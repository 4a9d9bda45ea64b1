// What is read off a volume beside the believed surface, and what is known of each reading.
//
// Places are drawn evenly over the surface by its area, no two nearer than a few voxels, where a wall is flat enough
// to be a wall over two voxels round the place. At each: the edge along the normal (volume/threshold.h; where the next
// wall is near, both are fitted together), and one grey value below and one above the surface, at depths between 3.5
// voxels (4.5 widths of the edges, where that is more) and the next wall less as many, or half-way through a wall of at
// least four voxels that is thinner than that.
//
// The same is read, at the same places and by the same code, off volumes that a tomograph in small makes of the
// believed shape (simulated_tomograph.h), so that what sampling, reconstruction and the fit of edges do to a reading is
// in the prediction, and so that what a mechanism does to line integrals is known for every reading.
//
// Noise: of each kind of reading, what a reading differs by from the median of its six nearest neighbours of the kind:
// voxels' noise and all that a smooth effect cannot do; more where means of six differ from those round them by more
// than that foretells, for no simulation knows where pixels lay and how finely they saw. Readings beyond six widths of
// their neighbours are left out and counted.
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
// Amounts at which mechanisms that are not in proportion to theirs were simulated.
inline constexpr std::array<double, 4> scatter_shares{0.03, 0.1, 0.3, 1};
inline constexpr std::array<double, 4> streak_floors{0.01, 0.03, 0.1, 0.3};
inline constexpr std::array<double, 4> blur_spreads{0.5, 1, 1.6, 2.4};
inline constexpr double blur_variance = 0.8;  // of the spectrum (volume/spectrum.h)

struct Row {
  Reading reading = Reading::wall;
  std::uint32_t site = 0;
  Vec3 at_m{}, normal{};  // scanner's frame, believed; of grey values the place where they were read
  double value = 0, sigma = 1;
  double simulated = 0;  // the same reading off the simulated volume
  double curvature = 0;  // of the surface, 1/voxel, positive where it bulges
  double depth = 0;      // of grey values: to the nearer wall along the normal, voxels
  double path_m = 0;     // mean length of the rays in the slice's plane through the place
  // What the reading lacks for each unit of ... (equations of lib/volume/mechanisms on line integrals, reconstructed
  // and read), of scatter at the shares above:
  double hardening = 0;
  std::array<double, 4> scatter{};
  double markers = 0;             // the same as hardening for rays through markers
  std::array<double, 4> floor{};  // the same as scatter, of rays through markers, at the floors above
  // What it lacks at each of the spreads above; of widths: the spread that makes an edge alone as wide.
  std::array<double, 4> blur{};
  std::array<double, 4> blur_of_spectrum{};  // beyond that, at the variance above; not of widths
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
  double simulated_width = 0;    // of edges in the simulated volume
  std::size_t sites = 0, left_out = 0;
  double voxel_noise = 0;  // of one voxel, as a share of material less air
  double ring_rms = 0;     // of the template before it was scaled
  double longest_path_m = 0;
};

// Error(data) in words where too little of the surface can be read.
Observed observed(const VolumesInput& input);

}  // namespace gonio::explain::volumes
