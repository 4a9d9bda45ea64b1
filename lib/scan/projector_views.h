// A projector's views of boards, for calib-charuco --projector: what the manifest says of them, and the two questions
// that the calibration asks (camera/calibrate_document.h).
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "camera/calibrate_document.h"
#include "io/grey.h"
#include "manifest/sections/forward.h"

namespace gonio::scan {

struct ProjectorRequest {
  std::string projector;   // name in cameras, from now on
  std::string projection;  // what it shows at every view
  std::string model = "radial-tangential";
};

// Photographs of boards under the projection, a folder for each view and its frames in the order of the numbers in
// their names; with several cameras, the one that the name of the file or the folder contains. Error(usage | data).
void enter_board_sequences(const std::vector<std::string>& paths, const ProjectorRequest& request,
                           const std::vector<std::string>& cameras, const std::string& response,
                           manifest::Document& document);

// Enters the projector among the cameras, with the size of what it shows. Of every view and camera the plain picture
// (white; of cosines alone the first, which stands for their mean) becomes a photograph of the board; an image without
// a file, VIEW-PROJECTOR, is the projector's own view; all of them are one shot. Error(data | no_input) for views that
// are not whole, a projector of another size, and a projection that does not tell both columns and rows.
void enter_projector_views(const ProjectorRequest& request, manifest::Document& document);

// Gives `calibration` the questions' answers. `note_input` hears of every frame.
void look_up_corners(const ProjectorRequest& request, camera::CalibrationRequest& calibration,
                     std::function<void(const std::filesystem::path&)> note_input);

}  // namespace gonio::scan
