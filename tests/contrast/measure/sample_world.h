// A plate of micro-ridges whose cells are a data matrix, photographed with the renderer before and after a turn by a
// quarter: what contrast measure is held against. Cells of bit 1 have ridges at the azimuth 0, the others at 90
// degrees; their walls lean so that the turn by -90 degrees exchanges the roles. Every cell has an azimuth and
// roughnesses of its own, a little beside the class's; planted defects are far beside them. The camera's stated poses
// are the true ones plus a robot's errors.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "contrast/measure/measure.h"
#include "manifest/sections/forward.h"

namespace gonio::tests {

struct SampleWorld {
  contrast::CellPattern pattern;
  std::vector<std::size_t> defects;
  std::vector<double> tilts_rad;
  int side_px = 150;
  double focal_px = 2400, distance_m = 0.3;
  double gain = 40000, read = 5e-4;         // noise of the pictures
  double robot_m = 5e-5, robot_rad = 1e-4;  // of the stated poses
  double corner_px = 0.3;                   // of marked corners
  double cell_spread = 0.02;                // of a sound cell's roughness, relative; of its azimuth, in rad
  std::uint64_t seed = 1;
  int spp = 4;
};

SampleWorld data_matrix_world(const std::string& text, std::size_t defects, std::uint64_t seed);

// Renders, adds noise, and writes the pictures into `folder`; the manifest has the pattern, its placements "before" and
// "after", and the table "corners" of marks in three images of each. `with_text`: the pattern is known.
manifest::Document photographed(const SampleWorld& world, const std::filesystem::path& folder, bool with_text = true);

// Where a corner of the pattern lies in the picture of that placement and tilt.
Vec2 true_corner_px(const SampleWorld& world, int placement, std::size_t tilt, int corner);

// The signed Michelson contrast of the two classes' nominal surfaces, each over the whole pattern, from the surfaces
// themselves: of the image of that placement and tilt.
double true_michelson(const SampleWorld& world, int placement, std::size_t tilt);

}  // namespace gonio::tests
