// "lights".
#pragma once
#include <string>

#include "manifest/parameter.h"

namespace gonio::manifest {

struct Light {
  std::string model = "point";
  Parameters parameters;
  std::string file;  // picture or table of models that have one: file id
  std::string environment{};  // instead of a file: name in environments
  Sigmas sigma;
};

}  // namespace gonio::manifest
