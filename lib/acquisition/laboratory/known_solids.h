// Solids of the links of known arms: cylinders and boxes that hold the makers' collision models, from
// tables. What they add is stated by a test that holds them against those models (tests/acquisition).
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
