// Simulated rigs of structured light for explain, by rays in closed form.
//   prove-clouds FOLDER WORLD SEED   writes FOLDER/clouds.json, whose clouds c0, c1, ... lie on known shapes
//   prove-clouds --list              prints a line for each world: name, mechanism that it conceals or "nothing", the
//                                    parameter and its true value
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>

#include "scan/clouds_world.h"

namespace {

using gonio::tests::CloudsWorld;
using Shape = CloudsWorld::Shape;

struct World {
  const char *name, *mechanism, *parameter;
  double truth;
  CloudsWorld world;
};

const World worlds[] = {
    {"null-planes", "nothing", "-", 0, {.shape = Shape::planes}},
    {"null-balls", "nothing", "-", 0, {.shape = Shape::balls}},
    {"gamma-planes", "projector.gamma", "gamma", 1.3, {.shape = Shape::planes, .gamma = 1.3}},
    {"gamma-balls", "projector.gamma", "gamma", 0.8, {.shape = Shape::balls, .gamma = 0.8}},
    {"lens-planes", "projector.lens", "k1", -0.05, {.shape = Shape::planes, .k1 = -0.05}},
    {"lens-balls", "projector.lens", "k1", 0.05, {.shape = Shape::balls, .k1 = 0.05}},
    {"moved-planes", "projector.moved", "turn_y_rad", 0.002, {.shape = Shape::planes, .turned_rad = 0.002}},
    {"moved-balls", "projector.moved", "x_m", 0.001, {.shape = Shape::balls, .nudged_m = 0.001}},
    {"drift-balls", "rig.drift", "turn_y_rad_per_s", 2e-7, {.shape = Shape::balls, .turns_rad_per_s = 2e-7}},
    {"deep-balls", "structured-light.subsurface", "depth_m", 3e-4, {.shape = Shape::balls, .depth_m = 3e-4}},
    {"spread-balls",
     "structured-light.subsurface",
     "spread_m",
     1e-3,
     {.shape = Shape::balls, .scatter_m = 1e-3, .read = 5e-4, .gain = 1e5}},
    {"moving-planes", "structured-light.motion", "-", 0, {.shape = Shape::planes, .clouds = 8, .moves_m = 2e-3}},
    {"edge-planes",
     "structured-light.edge",
     "spread_px2",
     1.0 + 1.0 / 12,
     {.shape = Shape::planes, .print_m = 0.02, .blur_px = 1}},
    // Beside a tone curve that the manifest states.
    {"defocus-planes",
     "structured-light.defocus",
     "spot_px2",
     1.0 + 1.0 / 12,
     {.shape = Shape::planes, .gamma = 2, .gamma_known = true, .spot_px = 1}},
    // Of things whose shape is not known: clouds against each other.
    {"null-overlaps", "nothing", "-", 0, {.shape = Shape::balls, .overlaps = true}},
    {"gamma-overlaps", "projector.gamma", "gamma", 1.3, {.shape = Shape::balls, .gamma = 1.3, .overlaps = true}},
    {"lens-overlaps", "projector.lens", "k1", 0.05, {.shape = Shape::planes, .k1 = 0.05, .overlaps = true}},
    // By lib/render; how deep light of a translucent solid comes from is not known, and is more than nothing.
    {"rendered-null-balls", "nothing", "-", 0, {.shape = Shape::balls, .rendered = 64}},
    {"rendered-gamma-planes", "projector.gamma", "gamma", 1.3, {.shape = Shape::planes, .gamma = 1.3, .rendered = 64}},
    {"rendered-moved-planes",
     "projector.moved",
     "turn_y_rad",
     0.002,
     {.shape = Shape::planes, .turned_rad = 0.002, .rendered = 64}},
    {"rendered-grooves",
     "structured-light.interreflection",
     "albedo",
     0.8,
     {.shape = Shape::grooves, .rendered = 256, .albedo = 0.8}},
    {"rendered-dark-grooves", "nothing", "-", 0, {.shape = Shape::grooves, .rendered = 256, .albedo = 0.01}},
    {"rendered-marble-balls",
     "structured-light.subsurface",
     "-",
     0,
     {.shape = Shape::balls, .rendered = 512, .scattering_per_m = 3000}},
};

}  // namespace

int main(int count, char** words) {
  if (count == 2 && std::string(words[1]) == "--list") {
    for (const World& w : worlds) std::printf("%s %s %s %.9g\n", w.name, w.mechanism, w.parameter, w.truth);
    return 0;
  }
  if (count != 4) return std::fprintf(stderr, "usage: prove-clouds FOLDER WORLD SEED\n"), 64;
  for (const World& w : worlds) {
    if (std::string(words[2]) != w.name) continue;
    CloudsWorld world = w.world;
    world.seed = std::strtoull(words[3], nullptr, 10);
    (void)gonio::tests::measured_clouds(world, words[1]);
    return 0;
  }
  return std::fprintf(stderr, "prove-clouds: no world %s\n", words[2]), 64;
}
