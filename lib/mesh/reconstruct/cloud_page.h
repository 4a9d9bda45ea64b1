// What became of clouds, as a page: the mesh coloured by its own standard deviation and by how far its points lie off
// it, and the figures.
#pragma once
#include <string>

#include "manifest/sections/forward.h"
#include "mesh/reconstruct.h"

namespace gonio::mesh {

std::string cloud_page(const MeasuredPoints& points, const Reconstruction& made, const manifest::MeasuredMesh& entry,
                       const std::string& name);

}  // namespace gonio::mesh
