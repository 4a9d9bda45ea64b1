// The outline of a mirror ball in a picture, and where the ball is.
//
// A sphere is seen under a circular cone whose cut with the picture, through the lens, is fitted to the grey values
// about it (reassembly/detect.h). What a mirror shows beside its outline is as bright as what lies behind it, or
// brighter, or darker, and changes along it; that is why edges of both signs count, and why the picture's range is
// compressed before, v / (v + median), so that an edge between dark things is one. A silhouette, white where the ball
// is, may stand in the place of the picture; a circle, drawn by hand, says where to look. A silhouette of two values
// was decided pixel by pixel: it is in doubt (mirror_outline.h).
//
// The centre follows from the axis, the half angle and the known radius, of several views at once with the covariance
// that each of them has (reassembly/ball_place.h). A picture without a camera is taken as seen from very far: then
// centre and radius of the outline stay pixels. World frame, metres.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "camera/camera_model.h"
#include "geom/rigid.h"
#include "io/image.h"
#include "probe/mirror_ball.h"
#include "reassembly/outline.h"

namespace gonio::probe {

struct Circle {
  Vec2 centre_px;
  double radius_px = 0;
};

struct OutlineWish {
  std::size_t balls = 1;
  std::optional<Circle> near{};  // outlines within a fifth of its radius
  std::optional<io::Image>
      silhouette{};                    // of the picture's size, white where the ball is; else the picture is searched
  std::vector<std::uint8_t> counts{};  // pixels that may be looked at; empty: all
};

// The outlines that show best, at most `balls`, from left to right. Error(data) at `place` where there are fewer, and
// where one leaves the picture.
std::vector<reassembly::Outline> ball_outlines(const io::Image& picture, const camera::CameraModel& camera,
                                               const OutlineWish& wish, const std::string& place);

// A camera that stands so far away that its picture has no perspective: outlines are circles within 1e-4 px.
camera::CameraModel far_camera(int width_px, int height_px);

struct BallSighting {
  std::size_t view = 0;
  reassembly::Outline outline;
};
struct FoundBall {
  Ball ball;
  Mat3 covariance_m2{{}};  // of the centre, by the outlines' covariances and those of the cameras' poses
  double chi_square = 0;
  int degrees = 0;
  std::vector<BallSighting> sightings;
};
struct OutlineView {
  Rigid<frame::World, frame::Camera> world_from_camera;
  std::vector<double> pose_sigma{};  // rotation, rad, and place, m: 3 + 3 numbers; empty: exact
  std::vector<reassembly::Outline> outlines;
};
// Outlines of all views put together to balls of this radius: those whose places agree are one ball. Error(data) at
// `place` where views contradict each other.
std::vector<FoundBall> located_balls(const std::vector<OutlineView>& views, double radius_m, std::size_t balls,
                                     const std::string& place);

}  // namespace gonio::probe
