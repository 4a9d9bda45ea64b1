// A page that shows a plan: the laboratory in three dimensions at some moments, joints, singular values and clearances
// over time, and the views that cannot be reached.
#pragma once
#include <string>

#include "acquisition/laboratory/laboratory.h"
#include "manifest/sections/forward.h"

namespace gonio::acquisition {

// HTML in one file. The plan belongs to this laboratory (planner.h: way_to).
std::string plan_page(const Laboratory& laboratory, const manifest::Plan& plan);

}  // namespace gonio::acquisition
