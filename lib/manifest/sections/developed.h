// "developed" of an image: what was done to its picture on the way from the sensor's numbers, in the order in which it
// was done, one entry a step.
//   black           the code without light taken off
//   linearity       codes made proportional to light, by a table
//   dark            dark current and offset of each sample taken off; `frames` without light were averaged
//   flat            shading and each sample's sensitivity divided out; `frames` of an even light were averaged
//   defects         hot and dead samples left out, as dark and flat frames show them
//   exposure-times  how long exposures lasted was found from the frames themselves
//   merge           `frames` exposures became one picture, in codes per second; `exposures_s` as they were used, with
//                   `sigma` where they were found, 0 for those taken as stated
//   demosaic        filters interpolated; `by` bilinear or gradient
//   white-balance   each colour multiplied by one number
//   colour          a correction of colours applied; `by` its name in the manifest's "colour"
//   undistort       lens distortion taken out; `by` the kernel of the interpolation
// A picture without any has not been developed, or nobody said how: what must not be done twice is refused where it is
// stated. Programs of others may write steps of these names.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "manifest/parameter.h"

namespace gonio::manifest {

namespace develop_step {
inline constexpr const char *black = "black", *linearity = "linearity", *dark = "dark", *flat = "flat",
                            *defects = "defects", *exposure_times = "exposure-times", *merge = "merge",
                            *demosaic = "demosaic", *white_balance = "white-balance", *colour = "colour",
                            *undistort = "undistort";
inline constexpr std::array all{black, linearity, dark,          flat,   defects,  exposure_times,
                                merge, demosaic,  white_balance, colour, undistort};
}  // namespace develop_step

struct DevelopedStep {
  std::string step, by{};  // of develop_step
  std::optional<std::int64_t> frames{};
  std::vector<double> exposures_s{};
  Sigmas sigma{};  // of "exposures_s"
};

}  // namespace gonio::manifest
