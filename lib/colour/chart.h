// Charts of coloured patches: where the patches lie and what colour they are.
//
// A chart's own coordinates run from 0 to 1 along its width (u) and its height (v) between the outer edges of the
// patches that lie at its border, as the chart is read: u to the right, v down, the first patch at the upper left.
// Reference colours are CIE XYZ of the 1931 observer over the perfect diffuser's Y, adapted to D50 where they were
// given for another white.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "optics/colorimetry.h"

namespace gonio::colour {

struct Patch {
  std::string name{};
  Vec2 centre{};                                             // chart's coordinates
  Vec2 size{};                                               // of its coloured area, chart's coordinates
  optics::Xyz xyz{};                                         // under D50
  optics::Lab lab{};                                         // about D50's white
  bool neutral = false;                                      // chroma C*ab below 6
  std::function<double(double wavelength_m)> reflectance{};  // where the chart's file has it; else empty
};

struct Chart {
  std::string name, edition, light;  // light: that the reference colours were computed or measured under
  int columns = 0, rows = 0;         // of a grid, patches row by row; 0: patches lie anywhere, and are not searched for
  double height_over_width = 1;
  std::vector<Patch> patches;
};

// The ColorChecker Classic, 6 x 4 patches from dark skin to black. Editions: "after-2014" and "before-2014", L*a*b*
// under D50 as X-Rite published them for charts made since November 2014, and before.
// Error(usage) at `place` for others.
Chart colorchecker_classic(const std::string& edition, const std::string& place);
std::vector<std::string> colorchecker_editions();

// A chart's description in JSON:
//   {"name": "my SG", "edition": "of 2019", "grid": [14, 10], "patch_share": 0.8, "aspect": 0.7,
//    "patches": [{"name": "A1", "lab": [96.5, -0.9, 0.6]}, ...]}
// grid        columns and rows; patches stand row by row, `patch_share` of the distance between centres wide
// aspect      height over width of the area of the patches; left out: square patches
// patches     each with one of "lab", "xyz" (perfect diffuser: Y = 1), "reflectance"; without a grid each with "centre"
//             [u, v] and "size" [du, dv], too
// white       [X, Y, Z] about which lab and xyz are given; left out: D50
// wavelengths_nm  of the reflectances, growing; they cover 400 to 700 nm, and end values hold beyond
// Reflectances are lit by `light` (relative power over metres), whose name is `light_name`.
// Error(data | no_input) at FILE#/pointer.
Chart read_chart(const std::filesystem::path& path, const std::function<double(double)>& light,
                 const std::string& light_name);
Chart parse_chart(const std::string& json, const std::string& place, const std::function<double(double)>& light,
                  const std::string& light_name);

}  // namespace gonio::colour
