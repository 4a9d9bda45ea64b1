// The graph of frames: links between named frames, the loops that they close, and what is wrong where one does not.
//
// Links that join two parts of the graph make a forest; every other link closes one loop with the way through the
// forest: a fundamental set. A closure is a rotation vector and a translation; uncertainties of different links are
// taken as independent and carried to the loop's end to first order (a turn d of a link moves what lies at l behind it
// by d x l). Its square under the summed covariance is chi-square with six degrees.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "manifest/pose.h"

namespace gonio::manifest {

struct AnyFrame {};
using Motion = Rigid<AnyFrame, AnyFrame>;

struct FrameEdge {
  std::string to, from;  // frames' names
  Motion to_from;
  // Of (rotation vector applied on the left, translation added), both about the axes of `to`: rad, m. Row by row.
  std::array<double, 36> covariance{};
  std::string place;  // where it is said, for messages
};

std::array<double, 36> covariance_of(const PoseSigma& sigma);

// What the digits of a document leave open of a pose whatever its sigma says, is part of every closure's covariance:
// 2e-6 rad, what a rotation that is orthonormal to 1e-6 leaves, one part in a million of the translation, and 1 um.
std::array<double, 36> with_rounding(const FrameEdge& edge);

struct Stride {  // a link walked along (p_to = to_from * p_from) or against its direction
  std::size_t edge = 0;
  bool along = true;
};
struct FrameLoop {
  std::size_t closing = 0;  // the link that closes it
  std::vector<Stride> way;  // the other way from its `to` to its `from`
};
// One for each link beyond a forest, in the order of the links. Links from a frame to itself are left out.
std::vector<FrameLoop> fundamental_loops(std::span<const FrameEdge> edges);

struct Closure {  // of what the closing link says against the way; in the axes of its `to`
  Vec3 turn_rad, shift_m;
  std::array<double, 36> covariance{};
  double chi_square() const;  // six degrees
};
Closure closure_of(std::span<const FrameEdge> edges, const FrameLoop& loop);

enum class FrameMistake {
  inverted,           // the link the other way round; also: the names of its two frames swapped
  rotation_inverted,  // its rotation the other way round, its place not
  mirrored,           // one axis counted the other way in both frames: left-handed numbers
  flipped_from,       // two axes of `from` counted the other way (half a turn: a camera that looks along -z)
  flipped_to,         // likewise of `to`
  millimetres,        // its place in mm where m is meant
  metres,             // its place a thousand times too small
  scalar_last,        // its quaternion written x, y, z, w
  exchanged           // with another link: left for right
};
struct FrameFault {
  FrameMistake mistake = FrameMistake::inverted;
  std::size_t edge = 0, other = 0;  // the second: of what was exchanged
  char axis = ' ';                  // of what was mirrored, or about which it was flipped: x, y or z
  double chi_square = 0;            // of all loops with the link mended
};
struct LoopCheck {
  std::vector<FrameLoop> loops;
  std::vector<double> turn_rad, shift_m;  // of each loop's closure, absolute
  std::vector<double> p;                  // by its chi-square
  std::vector<std::size_t> broken;        // p below `false_alarm` over the number of loops
  std::vector<FrameFault> faults;         // single mistakes after whose mending all loops close, best first
  std::string sentence;                   // names the link and what is wrong with it; empty: all close
  std::string remark;                     // where there is no loop: that nothing was checked
};
// Graphs of which every link is true are found broken with a probability of `false_alarm` at most (Bonferroni).
LoopCheck check_loops(std::span<const FrameEdge> edges, double false_alarm = 1e-3);

// What the link would say without the mistake.
Motion mended(const Motion& m, FrameMistake mistake, char axis);

}  // namespace gonio::manifest
