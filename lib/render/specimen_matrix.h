// A built-in sample for contrast(1): a plate of micro-ridges whose cells are a data matrix that says GONIO. Metres;
// world z the plate's normal.
//
// A scene knows no time. The plate that is photographed, turned about its normal by a quarter and photographed again
// therefore lies there twice, `apart_m` from each other under one lamp so far away that both get the same light: the
// images "before-K" see the one, "after-K" the other. Every cell has an azimuth and roughnesses of its own, by a
// standard deviation of 2 % beside its class's, the same in both; two cells are far beside: one is worn, one scratched.
#pragma once
#include <filesystem>

#include "manifest/sections/forward.h"

namespace gonio::render {

// Writes plate.ply into `out`. The pattern states where the plate lies in both placements, and neither its bits nor its
// text.
manifest::Document matrix_specimen(const std::filesystem::path& out);

}  // namespace gonio::render
