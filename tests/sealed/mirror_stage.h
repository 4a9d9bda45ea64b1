// Two balls that are mirrors, a screen and a panel, and what a ray meets of them.
#pragma once
#include <array>

#include "base/random.h"
#include "sealed/coherent_light.h"

namespace gonio::sealed {

inline constexpr std::array<double, 3> wavelengths = {480e-9, 550e-9, 620e-9};

struct Display {  // a flat lamp, one-sided
  Vec3 centre, out, up, right;
  double half = 0.2, radiance = 1, degree = 0, angle = 0;
};
struct MirrorBall {
  Vec3 centre;
  double radius = 0.05;
  std::array<Mirror, wavelengths.size()> mirror;
  double alpha = 0;
};
struct MosaicCamera {
  double leak = 0, share = 0, retardance = 0, dichroism = 0, veil = 0, dull = 0;
  std::array<double, 4> axis{};  // of the pixels (0, 0), (1, 0), (0, 1), (1, 1)
};
struct MirrorStage {
  std::array<MirrorBall, 2> balls;
  Display screen, panel;
  MosaicCamera camera;
};

// Light that arrives along -way at `origin`. `panel`: is it on? `band`: place in wavelengths.
class Follower {
 public:
  Follower(const MirrorStage& stage, bool panel, std::size_t band, Random& random)
      : stage_(stage), panel_(panel), band_(band), random_(random) {}
  Coherency from(Vec3 origin, Vec3 way, int depth) const;

 private:
  Coherency mirrored(const MirrorBall& ball, Vec3 at, Vec3 n, Vec3 h, Vec3 way, int depth, double weight) const;
  Coherency rough(const MirrorBall& ball, Vec3 at, Vec3 n, Vec3 way, int depth, int k, int count) const;

  const MirrorStage& stage_;
  bool panel_;
  std::size_t band_;
  Random& random_;
};

}  // namespace gonio::sealed
