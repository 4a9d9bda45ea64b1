// How far joints carry solids.
#pragma once
#include <vector>

#include "acquisition/laboratory/laboratory.h"

namespace gonio::acquisition {

// For each solid of the arm and each joint a length: no point of the solid is farther from the joint's axis, in
// whatever posture. 0 for joints that do not move it.
std::vector<std::vector<double>> reaches(const LaboratoryArm& arm);

}  // namespace gonio::acquisition
