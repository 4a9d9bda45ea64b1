// Pictures for people: what a correction does to the photograph of a chart.
#pragma once
#include "colour/calibration.h"
#include "colour/chart_pose.h"
#include "io/image.h"

namespace gonio::colour {

// Two pictures side by side, sRGB: before, where each channel is only divided by what white reads, and after the
// correction. In the middle of every patch lie halves: on the left what the patch reads there, in even light and
// without offset, on the right its reference. Patches that do not count have no left half. At most `longest` pixels
// wide and high each.
io::Image before_and_after(const io::Image& picture, const Chart& chart, const ChartPose& pose,
                           const Calibration& calibration, int longest = 1200);

}  // namespace gonio::colour
