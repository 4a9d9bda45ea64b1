// What the parameters of mechanisms move in the chain from board to camera (chain.h), by their names.
#pragma once
#include <cstddef>
#include <optional>
#include <string>

#include "robot/chain/chain.h"

namespace gonio::robot {

struct ChainRole {
  enum class Part { hand, fixed, pinhole, distortion, joint, a, d, sag, warp, scale, backlash, growth, lag };
  Part part = Part::hand;
  std::size_t index = 0;
};
// Of a mechanism's parameter; nothing for names that the chain does not know.
std::optional<ChainRole> role_of(const std::string& parameter);
void set(ChainState& state, const ChainRole& role, double value);

}  // namespace gonio::robot
