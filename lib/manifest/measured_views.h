// What was measured of a plan's views belongs to the plan's id, and serves its later runs ("plans": measured).
#pragma once
#include <string>

#include "manifest/sections/forward.h"

namespace gonio::manifest {

struct DriftedFrames;  // sections/plan.h

// The place of the image's camera, as `by` found it, into the plan that the image was taken by: that of the last run
// that has a step of its group. Images without one, or without a place, and frames that a check view calls into
// question leave no trace.
void remember_view(Document& document, const ImageEntry& image, const std::string& by);
// Did that program find where the image's step stands, in this run of the plan or an earlier one?
bool is_remembered(const Document& document, const ImageEntry& image, const std::string& by);
// Why the image's place is not known; null where nothing speaks against it.
const DriftedFrames* drift_of(const Document& document, const ImageEntry& image);

}  // namespace gonio::manifest
