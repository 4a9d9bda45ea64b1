// What the sources of the detector share: pyramid, cones, candidates, coarse edge points. For detect*.cpp only: the
// pictures are OpenCV's.
#pragma once
#include <algorithm>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "camera/camera_model.h"
#include "reassembly/detect.h"

namespace gonio::reassembly {

struct Cone {
  Vec3 axis;  // unit, camera frame
  double half_angle_rad = 0;
};
// The generator of the cone at `turn` about its axis, opened to `angle`; turn 0 is `across`, 90 degrees `down`.
struct ConeFrame {
  explicit ConeFrame(Vec3 unit_axis) : axis(unit_axis), across(across_of(unit_axis)), down(cross(unit_axis, across)) {}
  Vec3 ray(double turn, double angle) const {
    const Vec3 sideways = across * std::cos(turn) + down * std::sin(turn);
    return axis * std::cos(angle) + sideways * std::sin(angle);
  }
  double angle(Vec3 ray) const { return std::atan2(norm(cross(axis, ray)), dot(axis, ray)); }
  double turn(Vec3 ray) const { return std::atan2(dot(ray, down), dot(ray, across)); }
  Vec3 axis, across, down;
};
// The same cone with its axis moved by angles along across and down.
Cone moved(const Cone& cone, double across_rad, double down_rad, double half_angle_rad);

// Every level is the one before reduced by two; full = scale (p + 1/2) - 1/2.
struct PictureLevel {
  cv::Mat bytes;   // CV_8U
  cv::Mat usable;  // CV_8U; empty: all
  double scale = 1;
  Vec2 to_full(Vec2 p) const { return {scale * (p.x + 0.5) - 0.5, scale * (p.y + 0.5) - 0.5}; }
  Vec2 from_full(Vec2 p) const { return {(p.x + 0.5) / scale - 0.5, (p.y + 0.5) / scale - 0.5}; }
};
struct Pyramid {
  std::vector<PictureLevel> levels;
  cv::Mat values;    // of level 0, CV_8U or CV_32F
  cv::Mat usable;    // CV_8U, empty: all
  double noise = 0;  // standard deviation of a pixel, grey levels of 255
};
Pyramid pyramid_of(const io::GreyImage& picture, const std::vector<unsigned char>& mask, double largest_px);

// Before an outline with this radius lie things both darker and brighter than it: one sign shows less of it than the
// fine fit, which then takes both.
constexpr double large_px = 48;

// Below this radius half a circle is nothing rare in a texture: more of it must show.
constexpr double small_px = 12;
inline double cover_asked(double least_cover, double radius_px) {
  return radius_px < small_px ? std::min(1.0, 1.15 * least_cover) : least_cover;
}

struct OutlineCandidate {
  Cone cone;
  int sign = 1;  // 1: brighter than what surrounds it, -1: darker
  int level = 0;
  double cover = 0;  // roughly
};
// Circles among the edges' directions, best first.
std::vector<OutlineCandidate> circle_candidates(const Pyramid& pyramid, const camera::CameraModel& camera,
                                                const DetectWish& wish);

// How the outline of a cone lies in the picture at one turn: pixel, unit normal (outwards), pixels per radian of the
// half angle along that normal.
struct OutlinePoint {
  Vec2 pixel, normal;
  double px_per_rad = 0;
};
std::optional<OutlinePoint> outline_point(const camera::CameraModel& camera, const ConeFrame& frame, double half_angle,
                                          double turn);
// Mean distance of the outline from where the axis meets the picture; 0 where the lens does not show it.
double outline_radius_px(const camera::CameraModel& camera, const Cone& cone);

// Where the strongest edge of the right sign lies along the normal, one per turn; pixels outwards from the cone.
struct EdgePoint {
  double turn = 0, out_px = 0, px_per_rad = 0;
  bool seen = false;    // an edge was found
  bool agrees = false;  // with the cone that was fitted
};
struct CoarseOutline {
  Cone cone;
  int level = 0;          // the finest at which its edge is not wider than about three pixels
  double radius_px = 0;   // full pixels
  double spread_px = 0;   // robust, of the edge points about the cone
  double cover = 0;       // share of edge points that agree
  double oval_px = 0;     // amplitude of the second harmonic: what tells an ellipse from a sphere's outline,
  double oval_sigma = 0;  // its standard uncertainty,
  double oval_gain = 0;   // and the share of the outline that it explains and the cone does not
  double blur_px = 0;     // at the level
  std::vector<EdgePoint> points;
};
// Nothing where the candidate falls apart.
std::optional<CoarseOutline> coarse_outline(const Pyramid& pyramid, const camera::CameraModel& camera,
                                            const OutlineCandidate& candidate);

// The last step: the grey values themselves about the outline. Nothing where they do not determine a cone, or soon show
// much less of an outline than `least_cover`.
std::optional<Outline> fine_outline(const Pyramid& pyramid, const camera::CameraModel& camera, double least_cover,
                                    const CoarseOutline& coarse);

}  // namespace gonio::reassembly
