// "colour": how a camera's linear numbers become colours, found on a chart by color-calib.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "manifest/parameter.h"

namespace gonio::manifest {

struct ColourPatch {  // one patch of the chart as it was read
  std::string name{};
  std::vector<double> read{}, sigma{};  // R, G, B over `white`, what was taken off included
  std::vector<double> reference{};      // L*, a*, b* under D50
  std::optional<double> fitted_de00{}, held_out_de00{};
  std::string left_out{};  // why it does not count: "clipped", ...; empty: it counts
};
struct ColourAlternative {  // a model that was tried
  std::string model{};
  std::optional<double> fitted_de00{}, held_out_de00{};
  std::string refused{};  // why it was not fitted
};
struct ColourCorrection {                         // "colour"
  std::string model{};                            // colour/correction.h lists them
  std::vector<std::vector<double>> matrix{};      // three rows, one column a term
  std::vector<double> white{};                    // R, G, B of a perfect white: the terms take pixels over these
  std::string to{};                               // "cie-rgb" | "srgb" | "xyz-d50"
  std::vector<std::vector<double>> covariance{};  // of the matrix, row by row; jackknife over patches
  std::optional<double> fitted_de00{}, fitted_sd_de00{}, fitted_most_de00{};
  std::optional<double> held_out_de00{}, held_out_sd_de00{}, held_out_most_de00{};
  std::optional<double> exposure_de00{};    // by which colours move where the exposure does, 0.1 to 10 times
  std::optional<double> noise_gain{};       // of noise over white
  std::optional<double> metamerism_de00{};  // what no correction can mend, colour/metamerism.h
  std::vector<double> offset{};             // R, G, B over white: what was taken off the patches, glare or black
  std::vector<double> gradient{};           // of the light along the chart's rows and columns, over its width, height
  std::vector<double> curve{};              // of the same to second order: width^2, width height, height^2
  Sigmas sigma{};                           // of offset and gradient
  std::string chart{}, edition{}, light{};  // of the reference values
  std::string image{}, camera{};            // that it was found in, and whose it is
  std::vector<double> corners_px{};         // of the chart's patches: x, y, four times
  std::vector<ColourPatch> patches{};
  std::vector<ColourAlternative> alternatives{};
};

}  // namespace gonio::manifest
