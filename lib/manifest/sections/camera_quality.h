// "quality" of the cameras.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gonio::manifest {

// How well a calibration predicts pixels, judged over the image and by calibrating each half of the views alone.
struct CameraQuality {
  std::optional<double> predicts_within_px;  // at 95 %, over the image at the distances below; expected of this fit
  std::vector<double> distances_m;
  std::optional<double> halves_differ_px;  // root mean square over the image of the two halves' predictions' difference
  std::optional<double> halves_expected_px;  // what their covariances expect of it
  std::optional<bool> halves_agree;
  std::optional<double> coverage;            // share of the image that corners reach, 0 .. 1
  std::vector<std::string> next;             // what to photograph next, one sentence each
  std::map<std::string, std::string> files;  // maps and pictures: "projection-sigma" -> file id
};

}  // namespace gonio::manifest
