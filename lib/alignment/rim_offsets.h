// What seen points are off their models' rims, and what a robust loss makes of it. Private to alignment/.
#pragma once
#include "alignment/fit.h"
#include "alignment/seen_points.h"

namespace gonio::alignment {

// Of a whitened residual.
struct Loss {
  double width, reach;
  // rho of an offset and the weight of its square; beyond reach it stays what it is there.
  double cost(double d) const;
  double weight(double d) const { return 1 / (1 + d * d / (width * width)); }
};

// Of a body that dips into the ground, what is beneath has no rim that could be seen: the ground's own cut is there.
bool beneath(const Setting& s, std::size_t body, const RimPlace& place);

// What each sighting's points are off, and by how much its model's rim is accounted for.
SightingFit offsets_of(const Setting& s, const Sighting& sighting, const SeenPoints& seen, double reach_px);

// Root mean square over all sightings of the offsets that count, as Fitted::rms_px has it; but a point without a rim
// within `reach_px` is off by so much, so that settings far off can be told from those nearby.
double rms_offset(const Setting& s, const Question& question, double reach_px);

}  // namespace gonio::alignment
