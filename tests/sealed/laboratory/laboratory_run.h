// The chain of programs that a sealed laboratory is asked by: acquire | calib-charuco | handeye | explain.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "sealed/laboratory/laboratory_case.h"

namespace gonio::sealed {

// In `folder` (empty at first): lab.json, the frames, out.json as explain printed it, status.txt (explain's exit
// status, seconds of the clock for the whole chain). The truth is written to `truths`, whose path acquire alone is
// given. What failed, in words; empty: nothing. `hypotheses`: those that explain is asked for, all where there are
// none.
std::string run_laboratory(const LaboratoryCase& sealed, int spp, const std::filesystem::path& folder,
                           const std::filesystem::path& truths, const std::vector<std::string>& hypotheses = {});

}  // namespace gonio::sealed
