// "clouds": points that were measured, by structured-light.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manifest/pose.h"

namespace gonio::manifest {

struct KnownShape {                  // what is known of a thing that was measured
  std::string model{};               // "plane" | "sphere" | "mesh"
  std::optional<double> radius_m{};  // of the sphere, calibrated
  std::string mesh{};                // name in meshes
  // Roughly: where the mesh stands among the points. A fit begins there.
  std::optional<Pose<frame::World, frame::Object>> world_from_object{};
};
struct Cloud {
  std::string file{};                  // file id of a PLY file
  std::vector<std::string> cameras{};  // that saw it, the first one first; a projector is one
  std::string projection{};            // name in projections
  std::int64_t points = 0;
  std::optional<double> sigma_m{};              // median of the points' largest standard deviation
  std::optional<double> reprojection_px{};      // median distance of the points' pictures from what was seen
  std::optional<double> epipolar_chi_square{};  // what cameras contradict each other by, over what noise says; 1: that
  std::map<std::string, std::int64_t> refused{};  // pixels of the first camera without a point, by reason
  std::optional<KnownShape> shape{};              // that all its points lie on
};

}  // namespace gonio::manifest
