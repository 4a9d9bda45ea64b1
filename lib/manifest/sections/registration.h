// "registration": whether views of one thing agree, and how they were moved to each other, by cloud-register.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manifest/parameter.h"
#include "manifest/pose.h"

namespace gonio::manifest {

struct RegisteredPair {  // two views whose surfaces overlap
  std::vector<std::string> clouds{};
  std::vector<double> overlap{};  // share of either's points beside the other's surface
  std::int64_t residuals = 0, patches = 0;
  double rms_m = 0;
  double consistency = 0;                       // rms of residuals over what is predicted; 1: as stated
  double typical = 0;                           // of the middle half
  double rigid = 0, rest = 0;                   // what a motion of one view explains of it, and what would be left
  double rigid_p = 1;                           // of as much by chance
  std::optional<double> shift_m{}, turn_rad{};  // of that motion
  Sigmas sigma{};                               // of consistency and rest
};
struct RegisteredView {
  std::string cloud{};
  std::optional<Pose<frame::World, frame::World>> refined_from_stated{};  // of its points
  std::vector<double> centre_m{};                                         // of its overlaps
  std::vector<double> shift_m{}, turn_rad{};                              // of the motion, at the centre
  std::vector<double> covariance{};                                       // of turn and shift there, 6 x 6, row by row
  Sigmas sigma{};                   // of shift_m and turn_rad: one each, the largest
  std::int64_t held = 0;            // directions of six
  std::vector<std::string> open{};  // directions that nothing holds, in words
};
struct Registration {
  std::string verdict{};                                                  // "compared" | "refined" | "refused"
  std::string why{};                                                      // of a refusal
  std::string fixed{};                                                    // cloud that stays
  double consistency = 0, typical = 0, rigid = 0, rest = 0, rigid_p = 1;  // over all pairs, as the views are left
  std::optional<double> consistency_before{};
  Sigmas sigma{};
  std::int64_t residuals = 0, patches = 0;
  std::optional<double> reach_m{}, limit_m{}, inflation{};
  std::vector<RegisteredPair> pairs{};
  std::vector<RegisteredView> views{};
};

}  // namespace gonio::manifest
