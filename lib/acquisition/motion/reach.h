// How far joints carry solids.
#pragma once
#include <vector>

#include "acquisition/laboratory/laboratory.h"

namespace gonio::acquisition {

// For each joint a length: no point of the arm's solids is farther from the joint's axis, in whatever posture.
std::vector<double> reaches(const LaboratoryArm& arm);

}  // namespace gonio::acquisition
