// The manifest's pictures of a projection, as clouds in the manifest.
#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"

namespace gonio::scan {

struct ScanRequest {
  std::string projection;            // name in projections
  std::vector<std::string> cameras;  // that look on: one, with a projector, or two and more
  std::string projector{};           // name in cameras; empty: its pixels tell cameras apart, and no more
  double least_reflected = 0, least_difference = 0, least_share = 0.05,
         least_sigmas = 2;              // decode.h; light, 1 where a file is full
  double least_direct = 0.25;           // decode.h
  bool motion = true, indirect = true;  // decode.h
  std::string shape{};                  // that all points lie on, known to the user: "plane" | "sphere"; empty: nothing
  double radius_m = 0;                  // of the sphere, calibrated
  std::filesystem::path page{};         // report to write; empty: none
  bool codes = false;                   // write VIEW-CAMERA-codes.exr
  std::function<std::filesystem::path(const std::string& name)> output_path{};
  std::function<void(const std::filesystem::path&)> note_input{};
};

// Photographs of one view, in the order of the projection's frames, become images of the manifest. With several cameras
// a photograph belongs to the one whose name its file name contains, or else its folder's; of one camera they are in
// the order of the numbers in their names. Error(data) where there are not as many as frames.
void enter_photographs(const std::vector<std::string>& paths, const std::string& projection,
                       const std::vector<std::string>& cameras, const std::string& response,
                       manifest::Document& document);

// Every picture of every view is there once, of one size; the cameras are of one rig, or of images with poses. No pixel
// is looked at. Error(data | no_input).
void check_scan(const manifest::Document& document, const ScanRequest& request);

struct ScanSummary {  // over all views
  std::size_t fewest_points = 0;
  double epipolar_chi_square = 1;  // the largest; 1: as noise says, or not told
};

// Writes VIEW.ply for each `group` of the images (without one: the projection's name) and enters the cloud. Points are
// in the world, where the first camera's images say where it stood, else in the frame of the rig, which is that of its
// first camera. What was found is logged.
ScanSummary scan_document(manifest::Document& document, const ScanRequest& request);

}  // namespace gonio::scan
