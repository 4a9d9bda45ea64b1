// See environments.h.
#include "manifest/environments.h"

#include "manifest/sections/environment.h"

namespace gonio::manifest {

Light with_environment(const Document& document, const std::string& name) {
  Light light = document.lights.at(name);
  if (light.environment.empty()) return light;
  const Environment& around = document.environments.at(light.environment);
  light.file = around.file;
  if (around.scale) {
    Parameter& scale = light.parameters["scale"];
    if (!scale.given()) scale = Parameter(1.0);
    for (double& v : scale.value) v *= *around.scale;
  }
  return light;
}

std::string picture_pointer(const Document& document, const std::string& name) {
  const std::string& around = document.lights.at(name).environment;
  return around.empty() ? "/lights/" + name + "/file" : "/environments/" + around + "/file";
}

}  // namespace gonio::manifest
