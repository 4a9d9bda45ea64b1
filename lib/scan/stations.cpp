// See stations.h.
#include "scan/stations.h"

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/rig.h"

namespace gonio::scan {

namespace {

Station station_of(const manifest::Document& document, const std::string& name) {
  const manifest::Camera& camera = document.cameras.at(name);
  Station s{camera::CameraModel(camera, manifest::place(document, "/cameras/" + name)), {}};
  return s;
}

}  // namespace

std::vector<Station> stations_of(const manifest::Document& document, const std::vector<std::string>& names) {
  std::vector<Station> stations;
  for (const std::string& name : names) stations.push_back(station_of(document, name));
  for (const auto& [key, rig] : document.rigs) {
    std::size_t known = 0;
    for (std::size_t k = 0; k < names.size(); ++k)
      for (const manifest::RigMember& member : rig.cameras)
        if (member.camera == names[k]) stations[k].rig_from_camera = member.rig_from_camera, ++known;
    if (known == names.size()) return stations;
  }
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  throw Error(Exit::data, manifest::place(document, "/rigs"), "hold no rig of " + all,
              "calib-charuco --rig calibrates cameras that are held together");
}

}  // namespace gonio::scan
