// A cloud on disk: PLY whose points have their errors and the pixel of the first camera that saw them.
#pragma once
#include <filesystem>
#include <vector>

#include "scan/triangulate.h"

namespace gonio::scan {

// In the world; a cloud that nobody placed there stands in its rig's frame, and `world_from_rig` is the identity.
// Covariances turn along. Colours are linear floats; `camera`, where others than the first saw a point first, counts
// the cloud's cameras from 0.
void write_cloud(const std::filesystem::path& path, const Cloud& cloud,
                 const Rigid<frame::World, frame::Rig>& world_from_rig);

// The points, back in the rig's frame. Error(data) for files without the properties that write_cloud() gives them.
std::vector<ScanPoint> read_cloud(const std::filesystem::path& path,
                                  const Rigid<frame::World, frame::Rig>& world_from_rig);

}  // namespace gonio::scan
