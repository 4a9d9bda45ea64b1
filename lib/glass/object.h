// What one object of a set is made of, before somebody looks at it.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "glass/body.h"
#include "glass/glasses.h"

namespace gonio::glass {

struct Bubble {
  Vec3 centre_m;  // in the body's frame, once it is scaled
  double radius_m;
};
struct MadeObject {
  io::TriangleMesh mesh, filling;  // metres; filling: empty where nothing stands in it
  bool flat = false;               // every triangle has its own normal
  const Glass* glass = nullptr;
  double alpha = 0;   // roughness of the surface; 0: smooth
  Rgb sigma_a_per_m;  // tint
  Rgb liquid_per_m;   // tint of what stands in it
  std::vector<Bubble> bubbles;
  double height_m = 0, radius_m = 0;  // of the body; radius about the vertical through the origin
  std::map<std::string, std::string> facts;
};

// Scale, glass, tint, roughness, bubbles and filling of a body, by chance.
MadeObject made_of_glass(CheckedBody body, Random& random);

}  // namespace gonio::glass
