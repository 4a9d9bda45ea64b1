// What is wrong with a scene, and what the picture will show because of it.
//
// require_closed() is what build_scene() refuses; it warns of what check_lights() finds. check_scene() finds what is
// legal and yet likely a mistake; it looks at every triangle several times and is meant to be called once per scene.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.h"

namespace gonio::scene {

struct Finding {
  std::string pointer;  // JSON pointer of the manifest
  std::string what, consequence;
};
std::vector<Finding> check_scene(const Scene& scene);
std::vector<Finding> check_lights(const Scene& scene);  // the part about lamps within objects: cheap

// Error(data) at place(pointer) where an instance whose surface lets light through is no closed body.
void require_closed(const Scene& scene, const std::function<std::string(const std::string&)>& place);

}  // namespace gonio::scene
