// What is written about lobes: a table as CSV that brdf-fit and explain read, an entry of the manifest, one sentence.
#pragma once
#include <string>

#include "manifest/sections/forward.h"
#include "relief/lobe_surface.h"

namespace gonio::relief {

// One row for every direction of every lobe: both directions, f and sigma of red, green, blue in 1/sr.
std::string lobe_csv(const std::vector<TracedLobe>& lobes);
manifest::Table lobe_columns();  // the section of "tables" about that table
// What the lobe says; not what it was traced over.
manifest::ReliefLobe lobe_entry(double incidence_rad, double azimuth_rad, const LobeTable& lobe);
// How well the surface predicts the lobes: the section of "surface_fits" beside it. `source` says what was measured.
manifest::SurfaceFit surface_entry(const RoughSurface& rough, const std::vector<TracedLobe>& lobes,
                                   const std::string& source);
std::string energy_sentence(const LobeTable& lobe);  // of green

}  // namespace gonio::relief
