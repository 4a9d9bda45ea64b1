// Hand-eye calibration of a manifest: images with camera_from_board and base_from_tool and the table of corners in;
// mountings and frames out.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "manifest/sections/forward.h"
#include "robot/handeye/analysis.h"
#include "robot/pose_list.h"

namespace gonio::robot {

struct HandEyeRequest {
  handeye::Kind kind = handeye::Kind::eye_in_hand;
  std::string method = "joint", table = "corners", robot, camera, board;
};
struct HandEyeInput {
  handeye::Setup setup;
  std::vector<handeye::View> views;
  std::string camera, board, robot;   // robot: empty where no image names it
  std::vector<std::string> left_out;  // images that show no board or were dropped: "id: why"
};

// Writes the listed poses into the images' base_from_tool, in their order or by name. Error(data) where the numbers
// differ, a name is missing, or an image has another pose already.
void enter_poses(const PoseList& list, bool by_name, manifest::Document& document);

// Error(data) for missing poses, boards, corners, images of several robots; for fewer than three poses, and poses that
// do not move.
HandEyeInput handeye_input(const manifest::Document& document, const HandEyeRequest& request);

// `mountings` (under the camera's name) and `frames`. What the poses do not determine is left out.
void enter_mounting(const HandEyeInput& input, const HandEyeRequest& request, const handeye::Analysis& analysis,
                    manifest::Document& document);

// What was found, one line each, for stderr.
std::vector<std::string> summary_of(const HandEyeInput& input, const handeye::Analysis& analysis);
std::vector<std::string> outlier_lines(const HandEyeInput& input, const handeye::Analysis& analysis);

}  // namespace gonio::robot
