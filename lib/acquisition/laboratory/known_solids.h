// Solids of the links of known arms: cylinders and boxes round the makers' collision models, from a table. The models
// stick out of them by 0.3 mm at most, and they reach beyond the models by 48 mm at most (Universal Robots, where the
// models' own hulls are coarse; 37 mm for the UR5) or 151 mm (the foot and the shoulder of the ABB IRB 1600), as
// tests/acquisition measures.
#pragma once
#include <string>
#include <vector>

#include "acquisition/laboratory/solid.h"

namespace gonio::acquisition {

// As `links` of the section gives its own: with all joints at zero.
struct LinkSolid {
  Solid solid;  // its name, shape and link
  Rigid<frame::Base, frame::Object> base_from_body{};
};
std::vector<LinkSolid> known_solids(const std::string& model);  // empty: no arm that is known

}  // namespace gonio::acquisition
