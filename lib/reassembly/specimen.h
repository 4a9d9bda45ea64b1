// A built-in thing to try reassemble with: a porcelain bowl with markers and its lid, each in a frame of its own as a
// tomograph would give it, six photographs of both on a table by a pair of cameras at three places, and the table as it
// was scanned before the bowl pressed into its cloth. Metres; world z up.
#pragma once
#include <cstdint>
#include <filesystem>

#include "manifest/document.h"

namespace gonio::reassembly {

struct SpecimenWish {
  int width_px = 800, height_px = 600, spp = 4;
  std::uint64_t seed = 1;
};
// Writes below `out`: bowl.json and lid.json (pieces: mesh, surface, markers with covariance), table.ply, the
// photographs, and truth.json, the scene that was photographed. Returns the rig: cameras, images with poses, lights and
// surfaces, and no object. The markers' centres have the tomograph's noise, the photographs the camera's.
manifest::Document specimen(const std::filesystem::path& out, const SpecimenWish& wish = {});

}  // namespace gonio::reassembly
