// Worlds whose assumptions are broken in the ways in which users break them: align() has to say so, or its intervals
// have to hold what is true all the same.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "alignment/alignment_world.h"

namespace gonio::alignment::testing {

enum class Breakage {
  size,       // the mesh is 2 to 10 % too large, its scale is held
  stretch,    // 3 to 10 % too long along one axis
  focal,      // 3 % wrong
  missing,    // one photograph's object lacks a piece with 15 to 30 % of its outline
  foreign,    // something else is joined to it
  lamp,       // held, 5 % too high
  ground,     // 5 mm too high
  other,      // another mesh
  exchanged,  // two views have each other's masks
  start       // 120 degrees off
};
const std::vector<Breakage>& breakages();
std::string name_of(Breakage breakage);

// One of that kind, by `seed`, of one of the solids that look alike from nowhere; `number` chooses solid, views, lamps.
// Views are two and more where they are exchanged.
World broken_world(Breakage breakage, std::size_t number, std::uint64_t seed);

}  // namespace gonio::alignment::testing
