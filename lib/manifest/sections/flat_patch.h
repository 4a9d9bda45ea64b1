// "goniometer": flat samples and white tiles.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "manifest/pose.h"

namespace gonio::manifest {

// "goniometer": a flat sample that images show, or a white tile: one whose reflectance is stated. Its frame: z the
// normal, x from where azimuths count.
struct FlatPatch {
  std::optional<Pose<frame::World, frame::Object>> world_from_sample;
  std::vector<std::vector<double>> polygon_m;  // corners [x, y] in its frame; or a disc:
  std::optional<double> radius_m;
  std::vector<double> centre_m;          // of the disc, [x, y]; empty: the origin
  std::vector<std::string> images;       // ids of the images that show it; empty: all
  std::string tile;                      // of a sample: name of the patch that its readings refer to
  std::vector<double> reflectance;       // of a tile that is Lambertian (but for reference.tile): 1 or 3
  std::string surface;                   // of a tile that is not: name of the surface that says how it reflects
  std::optional<double> relative_sigma;  // of what a tile reflects, common to all readings
  std::string values;  // of the images: "radiance" (default), or "exposure": radiance times exposure_s
};

}  // namespace gonio::manifest
