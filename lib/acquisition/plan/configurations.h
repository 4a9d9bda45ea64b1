// All arms' joints in one list, arm after arm in the order of their names: what plans are searched with.
#pragma once
#include <string>
#include <vector>

#include "acquisition/laboratory/laboratory.h"

namespace gonio::acquisition {

using Configuration = std::vector<double>;  // rad

class Configurations {
 public:
  explicit Configurations(const Laboratory& laboratory);

  State state(const Configuration& joints) const;
  Configuration packed(const State& state) const;
  const Configuration& home() const { return home_; }
  void put(Configuration& joints, const std::string& arm, const Joints& of_arm) const;
  Joints of(const Configuration& joints, const std::string& arm) const;

  // Seconds from one to the other, all joints in proportion, at rest at both ends: the slowest joint's, or what the
  // tools' speed allows on the chord between where they are (their true way is no shorter).
  struct Placed {
    Configuration joints;
    std::vector<Vec3> tools_m;  // of every arm
  };
  Placed placed(Configuration joints) const;
  double time(const Placed& from, const Placed& to) const;
  double largest_turn(const Placed& from, const Placed& to) const;  // of one joint, rad

 private:
  struct Arm {
    std::string name;
    std::size_t first = 0, count = 0;
    const LaboratoryArm* arm = nullptr;
  };
  const Arm& find(const std::string& name) const;
  std::vector<Arm> arms_;
  struct Alike {  // joints of one speed and acceleration: the farthest of them is the slowest
    double speed = 0, acceleration = 0;
    std::vector<std::size_t> joints;
  };
  std::vector<Alike> alike_;
  double tool_speed_ = 0;
  Configuration home_;
};

}  // namespace gonio::acquisition
