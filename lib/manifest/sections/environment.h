// "environments": pictures of all directions about a place, as light-probe writes them. A light refers to one by name.
#pragma once
#include <optional>
#include <string>

#include "manifest/parameter.h"

namespace gonio::manifest {

struct Environment {
  std::string file{};                   // file id of the picture
  std::string projection = "lat-long";  // that render reads
  std::optional<double> blind_sr{};     // solid angle that no photograph showed
  std::optional<double> scale{};        // radiance, W/(m^2 sr), of a picture value of one; absent: 1
  Sigmas sigma{};                       // of the scale
};

}  // namespace gonio::manifest
