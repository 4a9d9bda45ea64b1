// The report page of brdf-fit: the verdict, the numbers with their uncertainty, where the surface fits and where not,
// what else was tried, what was left out, and what it looks like.
#pragma once
#include <string>

#include "goniometry/outputs.h"
#include "io/image.h"

namespace gonio::tools::brdf_fit {

// `sphere`: linear picture of a sphere of the surface; without pixels: none.
std::string page_of(const goniometry::Outcome& outcome, const io::Image& sphere);

}  // namespace gonio::tools::brdf_fit
