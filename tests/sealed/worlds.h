// All worlds, one file each, and what is to be made of them.
#pragma once
#include <memory>
#include <span>

#include "sealed/world.h"

namespace gonio::sealed {

// Designs in which effects cannot be told apart or cannot be seen: by construction, and checked by the maker's count.
struct Special {
  Kind kind;
  std::vector<std::string> effects;
  std::string variant;
  int whole = -1, quick = -1;  // cases; below zero: as the world's share says
};
struct Share {  // how many cases of a domain, in all and in the ten minutes
  int nulls = 0, distractors = 0, singles = 0, pairs = 0, specials = 0, outside = 0;
  std::size_t every = 1;  // single effects: only every so many-th of them
};
struct WorldEntry {
  std::string domain;
  std::unique_ptr<World> (*make)();
  std::vector<Special> specials;
  Share whole, quick;  // singles, specials, outside: of each effect; nulls, distractors, pairs: in all
};
std::span<const WorldEntry> all_worlds();
std::vector<Spec> all_specs();  // of all worlds, in an order that says nothing

std::unique_ptr<World> boards_world();
std::unique_ptr<World> images_world();
std::unique_ptr<World> sensor_world();
std::unique_ptr<World> expression_world();
std::unique_ptr<World> surface_world();
std::unique_ptr<World> light_world();
std::unique_ptr<World> robot_world();
std::unique_ptr<World> tracks_world();
std::unique_ptr<World> volume_world();
std::unique_ptr<World> exposures_world();
std::unique_ptr<World> photometric_world();
std::unique_ptr<World> gloss_world();
std::unique_ptr<World> heights_world();
std::unique_ptr<World> tomograph_world();
std::unique_ptr<World> markers_world();
std::unique_ptr<World> prints_world();
std::unique_ptr<World> polarization_world();
std::unique_ptr<World> polarimeter_world();

}  // namespace gonio::sealed
