// Calibration of the cameras of a manifest from its images: what the program calib-charuco does between reading and
// writing.
//
// Reads `images` (with `board` or `boards`, `camera` and `shot`; the first two may be left out where there is only
// one), `boards`, `cameras` and `files`. Cameras whose images share shots are one rig and calibrated together. Writes
// the cameras (intrinsics, distortion, sigma, covariance, rms_px), the `rigs`, the boards (layout, warp, flatness),
// pose, rms_px and weight of every image, and the tables of corners. Images are searched in parallel; results do not
// depend on the number of threads.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "camera/calibration.h"
#include "manifest/sections/forward.h"

namespace gonio::camera {

struct CameraResult;  // quality/projection_law.h
struct Quality;       // quality/quality.h

// What a camera's picture shows of a board.
struct SeenBoard {
  std::size_t image = 0;   // place in images
  std::size_t camera = 0;  // of the calibration: LookedUp::At
  const Detection& detection;
};

struct CalibrationRequest {
  std::string model = "radial-tangential";  // one of calibrated_models(), or "auto": chosen by held-out views
  bool model_given = false;                 // else a camera that the manifest knows keeps its model
  std::set<std::string> fixed;              // fixable_terms()
  bool board_warp = false;                  // free every board's sag; "auto" decides where it is not given
  DetectionOptions detection;
  bool judge = true;  // say how well each camera predicts, and hold halves of the views against each other
  std::vector<double> distances_m;  // at which that is judged; empty: quality/quality.h's usual ones
  // Writes what it likes about a camera that was judged and enters that; `suffix` ("-left") keeps several cameras
  // apart.
  std::function<void(const CameraResult& camera, const Quality& quality, const std::string& suffix,
                     manifest::Document& document)>
      report;
  // Pictures that are no file of their own (a mean of several): of images for which it answers.
  std::function<std::optional<io::GreyImage>(const manifest::Document& document, std::size_t image)> picture{};
  // Corners of images that have no file, because no camera took them: a projector's views. `seen`: the same board in
  // the same shot. The camera of such an image states its size.
  std::function<Detection(const manifest::Document& document, std::size_t image, const std::string& board,
                          const std::vector<SeenBoard>& seen)>
      look_up{};
  std::filesystem::path corners_csv;                             // empty: the table's rows stand in the manifest
  std::function<void(const std::filesystem::path&)> note_input;  // called for every picture read
};

// Quick form: enters board, camera and pictures as "board", "camera" and images named after the files.
void enter_board(const Board& board, manifest::Document& document);
void enter_pictures(const std::vector<std::string>& paths, const std::string& model, manifest::Document& document);
// The same for a rig. A picture belongs to the camera whose name its file name contains (else its folder's name); what
// the name says beside that is the shot: left01.jpg and right01.jpg, or left/01.png and right/01.png. Error(usage)
// where a name contains none or several of the cameras, where a camera has two pictures of one shot, or where a camera
// shares no shot with another.
void enter_rig(const std::vector<std::string>& cameras, const std::vector<std::string>& paths, const std::string& model,
               manifest::Document& document);

// Everything that can be refused without looking at a picture. `projector`: images without a file are its views.
void check_calibration(const manifest::Document& document, bool projector = false);

// Exit::quality where a gate failed (each said on stderr in one sentence); Error(data) where no picture shows its
// board.
Exit calibrate_document(manifest::Document& document, const CalibrationRequest& request);

}  // namespace gonio::camera
