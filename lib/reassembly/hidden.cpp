// See hidden.h.
#include "reassembly/hidden.h"

#include <algorithm>

namespace gonio::reassembly {

std::vector<Sighting> hidden_sightings(std::span<const View> views, const Bundles& bundles, const Placement& placement,
                                       std::span<const Piece> pieces, std::span<const PosedMesh> meshes) {
  std::vector<Sighting> hidden;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const Placed& placed = placement.pieces[p];
    if (placed.verdict != Verdict::placed) continue;
    for (const Pair& pair : placed.pairs) {
      const PieceMarker& marker = pieces[p].markers[pair.marker];
      const Vec3 there = placed.world_from_object * (placement.scale * marker.centre_m);
      for (const Sighting& s : bundles.found[pair.bundle].sightings)
        if (walls_between(views[s.view].world_from_camera.translation_m, there, marker.radius_m, meshes)[0].path_m > 0)
          hidden.push_back(s);
    }
  }
  return hidden;
}

}  // namespace gonio::reassembly
