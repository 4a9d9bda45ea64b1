// What is written about a lobe: a table as CSV, numbers as JSON, one sentence for people.
#pragma once
#include <string>

#include "manifest/value.h"
#include "relief/lobe.h"

namespace gonio::relief {

std::string lobe_csv(const LobeTable& lobe);  // theta_rad, phi_rad, f and sigma of red, green, blue in 1/sr
manifest::Value lobe_value(double incidence_rad, double azimuth_rad, const LobeTable& lobe);
std::string energy_sentence(const LobeTable& lobe);  // of green

}  // namespace gonio::relief
