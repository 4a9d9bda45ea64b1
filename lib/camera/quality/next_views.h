// What to photograph next: places, tilts and distances of the board are tried one after the other, each by how far the
// corners that it would add lower the projection's mean variance over the image.
//
// Linear and Gaussian: a view adds A - B C^-1 B' to the information about the shared numbers (its pose is unknown too),
// at the noise of the views so far, and its points to those that the implied rigid motion is found by
// (projection_law.h). Several suggestions are chosen one after the other, each given those before it.
#pragma once
#include <string>
#include <vector>

#include "camera/quality/projection_map.h"

namespace gonio::camera {

struct NextView {
  BoardPose camera_from_board;
  std::string
      sentence;  // "the board in the lower left, tilted by 40 degrees about the vertical, right edge towards ..."
  double sigma_before_px = 0, sigma_after_px = 0;  // square root of the mean variance, with the suggestions before it
};
// `distances_m`: where the projection shall be good. The board is the one that most views show.
std::vector<NextView> next_views(const CameraResult& camera, const std::vector<double>& distances_m,
                                 std::size_t count = 3);

}  // namespace gonio::camera
