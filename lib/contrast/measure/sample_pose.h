// Where the sample lies in the world, from corners marked in a few images whose camera poses a robot states.
//
// Unknown are the sample's pose X and, for every image with marks, a small error D_i of the camera's stated pose: a
// turn about the camera's own axes through its centre, and a shift. With corner k at p_k on the sample and the camera's
// projection P,
//     minimise  sum |P(D_i C_i X p_k) - u_ik|^2 / s_ik^2  +  sum |rotation of D_i|^2 / s_r^2 + |shift of D_i|^2 /
//     s_t^2,
// by Ceres (optim/ceres_fit.h; scripts/bench ceres). The robot's repeatability (s_r, s_t) thus counts as what it is,
// and images share out what their marks do not agree on. The start is the better of the two poses that four points of a
// plane leave open in one image (Collins & Bartoli 2014), over all images. The covariance is that of the linearised
// problem, times chi^2 over the degrees of freedom where that is above one.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "camera/camera_model.h"
#include "contrast/measure/pattern.h"
#include "contrast/measure/view_map.h"
#include "geom/rigid.h"

namespace gonio::contrast {

struct CameraPose {
  Rigid<frame::Camera, frame::World> camera_from_world;
  double sigma_rad = 0, sigma_m = 0;  // of one axis, one coordinate; in the camera's frame
};
struct PlacedMark {
  std::size_t image = 0;  // place among the poses
  int corner = 0;
  Vec2 pixel;
  double sigma_px = 0.5;
};
struct SamplePose {
  Rigid<frame::World, frame::Object> world_from_pattern;
  // Of a small turn about the world's axes through the pattern's middle and a shift of that middle: rx ry rz x y z.
  std::array<double, 36> covariance{};
  double chi2 = 0, rms_px = 0;  // of the marks
  int degrees = 0, marks = 0, images = 0;
  bool stated = false;  // by the manifest, and not fitted
};

// `cameras` and `poses`: one for each image. Error(data) at `place` where fewer than three corners are marked in every
// image, or the fit does not come to rest.
SamplePose locate_sample(const CellPattern& pattern, const std::vector<camera::CameraModel>& cameras,
                         const std::vector<CameraPose>& poses, const std::vector<PlacedMark>& marks,
                         const std::string& place);

// Of where the corners of the pattern lie in a picture, from both poses' uncertainty.
CornerCovariance place_covariance(const CellPattern& pattern, const camera::CameraModel& camera, const CameraPose& pose,
                                  const SamplePose& sample);

}  // namespace gonio::contrast
