// From point clouds on disk to the manifest's `acceptance` section.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "geom/vector.h"
#include "manifest/sections/forward.h"

namespace gonio::metrology {

struct Region {  // a ball that points must lie in
  Vec3 centre_m;
  double radius_m = 0;
};
// "10mm,-20mm,400mm,15mm": centre and radius, each with its unit. Error(usage) at --region.
Region region_of(const std::string& text);

struct AcceptanceRequest {
  std::vector<std::filesystem::path> clouds;
  double metres_per_unit = 1;                  // of the coordinates in the files
  bool planes = false;                         // else spheres
  std::vector<Region> regions;                 // of the spheres; empty: each cloud is one
  std::optional<double> radius_m, distance_m;  // calibrated
  bool hold_radius = false;
  std::map<std::string, double> limits_m;  // quantity -> largest |value|
  std::uint64_t seed = 0;
  std::function<void(const std::filesystem::path&)> note_input;
};
// Error(usage) for what cannot go together.
void check_acceptance(const AcceptanceRequest& request);
// Replaces the document's `acceptance`. negative where a limit is exceeded; one line on stderr for each that is.
Exit measure_acceptance(manifest::Document& document, const AcceptanceRequest& request);

}  // namespace gonio::metrology
