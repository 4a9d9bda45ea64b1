// See picture_names.h.
#include "camera/picture_names.h"

namespace gonio::camera {

std::string camera_in_name(const std::string& name, const std::vector<std::string>& cameras) {
  std::string found;
  bool several = false;
  for (const std::string& camera : cameras) {
    if (name.find(camera) == std::string::npos || found.find(camera) != std::string::npos) continue;
    several = !found.empty() && camera.find(found) == std::string::npos;
    found = camera;
  }
  return several ? "" : found;
}

std::string camera_of_picture(const std::filesystem::path& path, const std::vector<std::string>& cameras) {
  const std::string camera = camera_in_name(path.stem().string(), cameras);
  return camera.empty() ? camera_in_name(path.parent_path().filename().string(), cameras) : camera;
}

}  // namespace gonio::camera
