// "images": recordings, and under what they were made.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manifest/noise.h"
#include "manifest/parameter.h"
#include "manifest/pose.h"
#include "manifest/sections/developed.h"
#include "manifest/value.h"

namespace gonio::manifest {

struct SeenBoard {  // one of several boards in an image
  std::string board;
  std::optional<Pose<frame::Camera, frame::Board>> camera_from_board;
  std::optional<double> rms_px, weight;
};
struct ImageEntry {  // "images"
  std::string id, file, camera;
  std::optional<Pose<frame::World, frame::Camera>> world_from_camera;  // absent: the camera sits at the world's origin
  std::vector<std::string> light;                   // one name or a list; empty: every light of the scene is on
  std::optional<bool> dark{};                       // true: none is
  std::optional<double> exposure_s, f_number{};     // f_number: of the aperture, as the lens says
  std::optional<double> time_s{}, temperature_K{};  // when it was taken, counted from any moment; of the instrument
  std::optional<double> saturation{};  // stored value from which on a pixel is saturated; absent: the highest code
  Value response;                      // "linear" (default for EXR), "srgb", or a table [[code, linear], ...]
  std::string mask;                    // file id: pixels > 0.5 count
  std::string board;
  std::optional<Pose<frame::Camera, frame::Board>> camera_from_board;
  std::optional<double> rms_px;
  std::optional<double> weight;  // 0: dropped
  std::optional<Noise> noise;
  std::optional<Parameter> gain;  // factor on the simulated radiance, per image (free: unknown exposure)
  std::string group;              // recordings that belong together; held out together
  std::string shot;               // images of a rig's cameras that were taken at the same moment share it
  std::string robot;              // whose tool pose or joints follow
  std::optional<Pose<frame::Base, frame::Tool>> base_from_tool;  // as the robot's controller said
  std::vector<double> joints_rad;
  std::map<std::string, double> shapes{};  // objects whose mesh has shapes: how far through them, 0 to 1
  std::vector<SeenBoard> boards{};         // instead of `board`, where it shows several
  std::vector<DevelopedStep> developed{};  // what was done to the picture, in order
  std::string projection{};                // name in projections
  std::optional<std::int64_t> shows{};     // place in its frames, from 0
};

}  // namespace gonio::manifest
