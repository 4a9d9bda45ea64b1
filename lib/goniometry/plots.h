// Drawings of samples and what the surface predicts of them, for the page and as files of their own.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "goniometry/outputs.h"
#include "report/plot.h"

namespace gonio::goniometry {

// Scans in the plane of incidence: f over the eye's signed zenith, positive on the mirror direction's side, measured
// and fitted, for up to five incidences. Nothing where no series has five samples within 3 degrees of its plane.
std::optional<report::Plot> scan_plot(const Outcome& outcome, std::size_t band);
// Samples and the surface around the normal, in the plane of incidence, the radius log10(1 + 100 f), for the same
// incidences; without scans the surface for 15, 45 and 70 degrees.
report::Plot lobe_plot(const Outcome& outcome, std::size_t band);
// Mean residual on the scale log(1 + 100 f cos cos), all bands together, in cells of theta_h and theta_d.
report::HeatStrip residual_map(const Outcome& outcome);

// Every plot as a drawing that stands alone, with colours of its own.
std::string standalone_svg(const report::Plot& plot);

}  // namespace gonio::goniometry
