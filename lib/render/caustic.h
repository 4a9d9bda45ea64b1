// Light that no path finds: of a lamp without extent, by way of smooth interfaces, on what the camera sees through
// smooth interfaces alone - a point lamp's light on the bottom of a glass, or inside of a polished cloudy body. Neither
// a path from the camera can hit the lamp, nor a path from the lamp the camera.
//
// The share of each lamp's power is estimated by tracing photons up to the first event that spreads them, and asking
// whether that place can be seen directly, or else lies where rays from the camera through smooth interfaces end (in
// the same cell of a grid, 1/32 of the scene's size wide, on the same object). It is an estimate of what the picture
// lacks at its source, not of the picture's error.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "render/ray_caster.h"
#include "scene/scene.h"

namespace gonio::render {

struct Missing {
  struct Lamp {
    std::string light;
    double share = 0;     // of the light's power
    std::string objects;  // ids of the objects that it is missing on or in, separated by ", "
  };
  std::vector<Lamp> lamps;  // with a share above 1e-4
  // One line for a person, without the program's name; empty where nothing is missing.
  std::string sentence() const;
};

Missing missing_light(const scene::Scene& scene, std::size_t view, const RayCaster& caster);

}  // namespace gonio::render
