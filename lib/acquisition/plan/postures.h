// One arm alone: the postures that put its tool at one of some places, without regard to the other arms.
//
// Branches of the inverse kinematics are parted by singular postures: the determinant of the Jacobian, whose factors'
// signs number them (robot/inverse), vanishes between any two. A plan that stays away from singular postures therefore
// never leaves the branch in which its arms stand at home, and no other is looked at.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "acquisition/laboratory/laboratory.h"

namespace gonio::acquisition {

struct Postures {
  std::vector<Joints> all;  // nearest to home first
  std::string why;          // where there are none: what stopped most of them
};

class PostureSearch {
 public:
  PostureSearch(const Laboratory& laboratory, const std::string& arm);
  ~PostureSearch();

  // Up to `most`. Inverse kinematics, turns, limits, singular values, collisions with itself and with what stands.
  Postures find(const std::vector<Rigid<frame::World, frame::Tool>>& tools, std::size_t most) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace gonio::acquisition
