// "clouds": points that were measured, by structured-light.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gonio::manifest {

struct Cloud {
  std::string file{};                  // file id of a PLY file
  std::vector<std::string> cameras{};  // that saw it, the first one first; a projector is one
  std::string projection{};            // name in projections
  std::int64_t points = 0;
  std::optional<double> sigma_m{};              // median of the points' largest standard deviation
  std::optional<double> reprojection_px{};      // median distance of the points' pictures from what was seen
  std::optional<double> epipolar_chi_square{};  // what cameras contradict each other by, over what noise says; 1: that
  std::map<std::string, std::int64_t> refused{};  // pixels of the first camera without a point, by reason
};

}  // namespace gonio::manifest
