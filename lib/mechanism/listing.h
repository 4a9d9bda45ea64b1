// The registry as people read it: grouped by the stage of the simulator, in the order in which light and kinematics
// pass through it. explain --list prints text(), gonio-mechanisms(7) is made of markdown().
#pragma once
#include <string>
#include <vector>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {

struct Stage {
  std::string name;      // Mechanism::stage
  std::string sentence;  // "Lights: what leaves the lamps"
  std::vector<const Mechanism*> mechanisms;
};
std::vector<Stage> by_stage();  // stages without mechanisms are left out; unknown ones come last, by name

std::string text();
std::string markdown();

}  // namespace gonio::mechanism
