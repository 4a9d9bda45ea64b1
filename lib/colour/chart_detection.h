// A chart found in a picture, in any pose and orientation.
//
// Patches are quadrilaterals that lie beside each other in a grid: candidates from local thresholds of several widths
// (patch_candidates.h), grown from neighbour to neighbour into lattices. Each way in which the chart can lie on a
// lattice, turned by quarters and shifted, is judged by colour: what is left, as CIEDE2000, where a 3 x 3 matrix and a
// gradient of light are fitted to what the patches show. The best way counts where it is plausible and no other is
// nearly as good: a chart that is not sure is not found.
#pragma once
#include <string>

#include "colour/chart.h"
#include "colour/chart_pose.h"
#include "io/image.h"

namespace gonio::colour {

struct FoundChart {
  ChartPose pose;
  double misfit_de00 = 0;  // mean difference of the colours, by which it was told
  double next_de00 = 0;    // of the next best way to lay the chart; infinite where there was none
};

inline constexpr double most_misfit_de00 = 12, least_lead = 1.4;  // next_de00 over misfit_de00

// `picture`: R, G, B, linear. Error(data) at `place` where no chart is found, with what came nearest; for a chart
// without a grid.
FoundChart find_chart(const io::Image& picture, const Chart& chart, const std::string& place);

// Mean CIEDE2000 that is left where `pose` is right about colours; infinite where patches reach out of the picture.
double colour_misfit(const io::Image& picture, const Chart& chart, const ChartPose& pose);

}  // namespace gonio::colour
