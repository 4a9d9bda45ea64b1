// Calibration of the cameras of a manifest from its images: what the program calib-charuco does between reading and
// writing.
//
// Reads `images` (with `board` and `camera`, which may be left out where there is only one), `boards`, `cameras` and
// `files`. Writes the cameras (intrinsics, distortion, sigma, covariance, rms_px), the boards (layout, warp),
// camera_from_board, rms_px and weight of every image, and the table of corners. Images are searched in parallel;
// results do not depend on the number of threads.
#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "base/error.h"
#include "camera/calibration.h"
#include "manifest/document.h"

namespace gonio::camera {

struct CalibrationRequest {
  CalibrationOptions calibration;
  bool model_given = false;  // else a camera that the manifest knows keeps its model
  DetectionOptions detection;
  std::filesystem::path corners_csv;                             // empty: the table's rows stand in the manifest
  std::function<void(const std::filesystem::path&)> note_input;  // called for every picture read
};

// Quick form: enters board, camera and pictures as "board", "camera" and images named after the files.
void enter_board(const Board& board, manifest::Document& document);
void enter_pictures(const std::vector<std::string>& paths, const std::string& model, manifest::Document& document);

// Everything that can be refused without looking at a picture.
void check_calibration(const manifest::Document& document);

// Exit::quality where a gate failed (each said on stderr in one sentence); Error(data) where no picture shows its
// board.
Exit calibrate_document(manifest::Document& document, const CalibrationRequest& request);

}  // namespace gonio::camera
