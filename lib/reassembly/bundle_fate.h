// What became of outlines that belong to no marker. For sources of this folder.
#pragma once
#include <vector>

#include "reassembly/bundle_sight.h"

namespace gonio::reassembly {

// An outline outside all bundles is refracted where a bundle that its view does not show passes near it and looks about
// as large there, or where outlines of two other views come near to its ray without meeting it; else it is alone.
std::vector<std::vector<Fate>> fates(const std::vector<std::vector<Sight>>& sights, const std::vector<Bundle>& found);

// Angle between an outline and where a sphere of this place and radius would be seen; nothing where it cannot be that
// sphere displaced by glass: too far off in angle or size, or exactly there.
bool displaced(const Sight& sight, const Eigen::Vector3d& centre, std::optional<double> radius);

}  // namespace gonio::reassembly
