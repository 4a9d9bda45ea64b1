// Sightings that cannot be what they were taken for: something stands between the camera and the marker. Glass bends
// the ray, what is opaque hides the marker altogether; either way the sighting says nothing of where the marker is.
#pragma once
#include <span>
#include <vector>

#include "reassembly/marker_rows.h"
#include "reassembly/place.h"

namespace gonio::reassembly {

// Of the paired markers of placed pieces, those whose straight line to the camera goes through one of `meshes`.
std::vector<Sighting> hidden_sightings(std::span<const View> views, const Bundles& bundles, const Placement& placement,
                                       std::span<const Piece> pieces, std::span<const PosedMesh> meshes);

}  // namespace gonio::reassembly
