// A set-up seen from above, to scale: the camera, the scene's centre, and what is moved from one place to another.
// Coordinates in metres, to the right and away from the viewer, who stands at the lower edge.
#pragma once
#include <string>
#include <vector>

namespace gonio::report {

struct FloorPlan {
  struct Place {
    std::string name;
    double right_m = 0, away_m = 0;
  };
  std::string title;  // for those who cannot see it
  Place camera, centre, from, to;
};

// 560 wide and at most 360 high; a bar tells the scale.
std::string svg(const FloorPlan& plan);

}  // namespace gonio::report
