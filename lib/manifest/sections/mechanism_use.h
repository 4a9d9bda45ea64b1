// "mechanisms": optional physics that is switched on.
#pragma once
#include <string>
#include <vector>

#include "manifest/parameter.h"

namespace gonio::manifest {

// "mechanisms": optional physics that is switched on, by canonical id. `on` names the surfaces or lights it applies to
// (empty: all it can apply to); a parameter is one number, or one per name in `on`.
struct MechanismUse {
  std::vector<std::string> on;
  Parameters parameters;
  Sigmas sigma;
};

}  // namespace gonio::manifest
