// "surfaces": how objects reflect.
#pragma once
#include <map>
#include <string>

#include "manifest/parameter.h"

namespace gonio::manifest {

struct LawUse {  // how a parameter varies over an object: a registered law (surface/law.h) and its parameters
  std::string law;
  Parameters parameters;
};
// "surfaces" and "lights": a registered model and its parameters, validated against the registry (manifest/model.h).
struct Surface {
  std::string model = "diffuse";
  Parameters parameters;
  std::map<std::string, std::string> textures;  // parameter -> file id
  Sigmas sigma;
  std::string file{};                             // models that read a table (MERL): file id
  std::string base{};                             // models that lie on another surface: its name
  std::map<std::string, std::string> spectra{};   // parameter -> file id: refractiveindex.info YAML, or CSV
  std::map<std::string, std::string> vertices{};  // parameter -> the vertices' property (R, G, B: x for x_r...)
  std::map<std::string, std::map<std::string, Parameter>> labels{};  // parameter -> face label -> value
  std::map<std::string, LawUse> laws{};                              // parameter -> how it varies over the object
};

}  // namespace gonio::manifest
