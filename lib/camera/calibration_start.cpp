// Where the adjustment begins: a pinhole from the homographies, poses from planes, every camera by itself; then the rig
// from what the cameras see in common.
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "camera/bundle_adjustment.h"
#include "camera/camera_model.h"

namespace gonio::camera {
namespace {

constexpr double usual_focal = 1.2;  // of the longer side: a normal lens, where the homographies say nothing
constexpr double least_focal = 0.2, largest_focal = 50;
constexpr double fisheye_focal_low = 0.12, fisheye_focal_high = 3;  // of the longer side
constexpr double least_cosine = 0.1;  // of the angle from the axis, of corners that help to find a pose

std::vector<cv::Point3f> board_points(const View& view, const Board& board) {
  std::vector<cv::Point3f> points;
  for (const Corner& c : view.corners) {
    const Vec2 at = board.corner_m(c.id);
    points.emplace_back(static_cast<float>(at.x), static_cast<float>(at.y), 0.0F);
  }
  return points;
}

std::vector<cv::Point2f> pixels(const View& view) {
  std::vector<cv::Point2f> points;
  for (const Corner& c : view.corners)
    points.emplace_back(static_cast<float>(c.pixel.x), static_cast<float>(c.pixel.y));
  return points;
}

// Sum of squared distances; corners that the lens does not show count as a picture's width away.
double misfit(const View& view, const Board& board, const Intrinsics& lens, const BoardPose& pose) {
  double sum = 0;
  for (const Corner& c : view.corners) {
    Vec2 pixel;
    if (!predict(lens, pose, board.extent(), {}, board.corner_m(c.id), pixel)) {
      sum += 1e6;
      continue;
    }
    sum += dot(pixel - c.pixel, pixel - c.pixel);
  }
  return sum;
}

BoardPose pose_of(const cv::Mat& rotation, const cv::Mat& translation) {
  cv::Matx33d r;
  cv::Rodrigues(rotation, r);
  Mat3 m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m(i, j) = r(i, j);
  }
  return {quaternion_of(m), {translation.at<double>(0), translation.at<double>(1), translation.at<double>(2)}};
}

// A fisheye has no vanishing points to start from: the focal length, of a range, under which the planes fit best.
Intrinsics start_fisheye(const std::vector<View>& views, const std::vector<BoardSetup>& boards,
                         const CameraSetup& camera) {
  const double longer = std::max(camera.width_px, camera.height_px);
  Intrinsics best;
  double least = HUGE_VAL;
  for (double share = fisheye_focal_low; share < fisheye_focal_high; share *= 1.15) {
    Intrinsics lens{share * longer, share * longer, 0.5 * (camera.width_px - 1), 0.5 * (camera.height_px - 1), {}};
    lens.distortion[LensTerm::fisheye] = 1;
    double sum = 0;
    for (const View& view : views) {
      const Board& board = boards[view.board].board;
      sum += std::sqrt(misfit(view, board, lens, start_pose(view, board, lens)));
    }
    if (sum >= least) continue;
    least = sum;
    best = lens;
  }
  return best;
}

// How far two motions of a camera are apart, as a length at the range of the rig's boards.
double apart(const CameraFromRig& a, const CameraFromRig& b, double range_m) {
  return norm(a.translation_m - b.translation_m) +
         range_m * norm(rotation_vector_of(a.rotation * conjugate(b.rotation)));
}

// Of the motions that single placements say, the one closest to all others.
CameraFromRig most_agreed(const std::vector<CameraFromRig>& said, double range_m) {
  CameraFromRig best = said.front();
  double least = HUGE_VAL;
  for (const CameraFromRig& candidate : said) {
    double sum = 0;
    for (const CameraFromRig& other : said) sum += std::min(apart(candidate, other, range_m), 0.1 * range_m);
    if (sum >= least) continue;
    least = sum;
    best = candidate;
  }
  return best;
}

// Camera by camera, those that share placements with cameras whose place is known; cameras that share none with any
// stay at the origin of a rig of their own.
void tie_cameras(const std::vector<View>& views, const std::vector<BoardPose>& poses, Adjustment& state) {
  std::vector<bool> known(state.lenses.size());
  std::vector<bool> placed(state.placements.size());
  const auto place_boards = [&](std::size_t camera) {
    known[camera] = true;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (views[i].camera != camera || state.view_weights[i] == 0 || placed[state.placement_of[i]]) continue;
      state.placements[state.placement_of[i]] = inverse(state.camera_from_rig[camera]) * poses[i];
      placed[state.placement_of[i]] = true;
    }
  };
  for (std::size_t round = 0; round < known.size(); ++round) {
    bool tied = false;
    for (std::size_t c = 0; c < known.size() && !tied; ++c) {
      if (known[c]) continue;
      std::vector<CameraFromRig> said;
      double range_m = 0;
      for (std::size_t i = 0; i < views.size(); ++i) {
        if (views[i].camera != c || state.view_weights[i] == 0 || !placed[state.placement_of[i]]) continue;
        said.push_back(poses[i] * inverse(state.placements[state.placement_of[i]]));
        range_m = std::max(range_m, norm(poses[i].translation_m));
      }
      if (said.empty()) continue;
      state.camera_from_rig[c] = most_agreed(said, range_m);
      state.tied[c] = tied = true;
      place_boards(c);
    }
    if (tied) continue;
    const auto next = std::ranges::find(known, false);
    if (next != known.end()) place_boards(static_cast<std::size_t>(next - known.begin()));
  }
  for (std::size_t c = 0; c < known.size(); ++c) {
    if (!known[c]) place_boards(c);
  }
}

// Poses that fit better from the other solution of the plane, now that the lens is known.
bool try_other_poses(const std::vector<View>& views, const CalibrationSetup& setup, Adjustment& state) {
  const auto sum = [](const std::vector<Vec2>& residual) {
    double total = 0;
    for (const Vec2 r : residual) total += dot(r, r);
    return total;
  };
  bool changed = false;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (state.view_weights[i] == 0) continue;
    const double now = sum(residuals(views[i], setup, state, i));
    PlacedBoard& placed = state.placements[state.placement_of[i]];
    const PlacedBoard before = placed;
    const BoardPose other = start_pose(views[i], setup.boards[views[i].board].board, state.lenses[views[i].camera]);
    placed = inverse(state.camera_from_rig[views[i].camera]) * other;
    if (sum(residuals(views[i], setup, state, i)) < 0.81 * now)
      changed = true;
    else
      placed = before;
  }
  return changed;
}

// One camera alone: its lens, and the poses of its views.
void start_camera(const std::vector<View>& views, const CalibrationSetup& setup, std::size_t camera, Adjustment& state,
                  std::vector<BoardPose>& poses) {
  std::vector<View> own;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].camera != camera || state.view_weights[i] == 0) continue;
    own.push_back(views[i]);
    own.back().camera = 0;
    places.push_back(i);
  }
  const CameraSetup& given = setup.cameras[camera];
  CalibrationSetup alone{{given}, setup.boards};
  Adjustment part;
  part.lenses = {given.start ? *given.start : start_lens(own, setup.boards, given)};
  if (given.fixed.contains("aspect") && !given.start) part.lenses[0].fy_px = part.lenses[0].fx_px;
  part.camera_from_rig.resize(1);
  part.tied.resize(1);
  part.warps = state.warps;
  for (std::size_t i = 0; i < own.size(); ++i) {
    part.placement_of.push_back(i);
    part.view_weights.push_back(state.view_weights[places[i]]);
    part.precision.push_back(state.precision[places[i]]);
    const BoardPose pose = start_pose(own[i], setup.boards[own[i].board].board, part.lenses[0]);
    part.placements.push_back({pose.rotation, pose.translation_m});
  }
  part.loss_px = state.loss_px;
  adjust(own, alone, part);
  if (try_other_poses(own, alone, part)) adjust(own, alone, part);
  state.lenses[camera] = part.lenses[0];
  for (std::size_t i = 0; i < own.size(); ++i) poses[places[i]] = part.pose(own[i], i);
  if (setup.cameras.size() == 1) state.warps = part.warps;
}

}  // namespace

Intrinsics start_lens(const std::vector<View>& views, const std::vector<BoardSetup>& boards,
                      const CameraSetup& camera) {
  if (camera_model_info(camera.model, "calibration").fisheye > 0) return start_fisheye(views, boards, camera);
  const int width_px = camera.width_px, height_px = camera.height_px;
  std::vector<std::vector<cv::Point3f>> objects;
  std::vector<std::vector<cv::Point2f>> images;
  for (const View& view : views) {
    objects.push_back(board_points(view, boards[view.board].board));
    images.push_back(pixels(view));
  }
  const cv::Mat k = cv::initCameraMatrix2D(objects, images, cv::Size(width_px, height_px), 0);
  const double longer = std::max(width_px, height_px);
  const auto plausible = [&](double f) { return f > least_focal * longer && f < largest_focal * longer; };
  double fx = k.at<double>(0, 0), fy = k.at<double>(1, 1);
  if (!plausible(fx)) fx = fy;
  if (!plausible(fy)) fy = fx;
  if (!plausible(fx) || fx / fy > 2 || fy / fx > 2) fx = fy = usual_focal * longer;
  return {fx, fy, 0.5 * (width_px - 1), 0.5 * (height_px - 1), {}};
}

BoardPose start_pose(const View& view, const Board& board, const Intrinsics& lens) {
  // Every corner as seen by a perspective camera of focal length one; what lies too far aside has no place there.
  const CameraModel camera(lens, 1, 1);
  std::vector<cv::Point3f> points;
  std::vector<cv::Point2f> plane;
  const std::vector<cv::Point3f> all = board_points(view, board);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Vec3 d = camera.ray(view.corners[i].pixel).direction;
    if (!(d.z > least_cosine)) continue;
    points.push_back(all[i]);
    plane.emplace_back(static_cast<float>(d.x / d.z), static_cast<float>(d.y / d.z));
  }
  BoardPose best{{}, {0, 0, 1}};
  if (points.size() < 4) return best;
  std::vector<cv::Mat> rotations, translations;
  cv::solvePnPGeneric(points, plane, cv::Matx33d::eye(), cv::noArray(), rotations, translations, false,
                      cv::SOLVEPNP_IPPE);
  double least = HUGE_VAL;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const BoardPose pose = pose_of(rotations[i], translations[i]);
    const double error = misfit(view, board, lens, pose);
    if (error >= least) continue;
    least = error;
    best = pose;
  }
  return best;
}

void start(const std::vector<View>& views, const CalibrationSetup& setup, Adjustment& state) {
  const std::size_t cameras = setup.cameras.size();
  state.lenses.resize(cameras);
  state.camera_from_rig.assign(cameras, {});
  state.tied.assign(cameras, false);
  state.warps.clear();
  for (const BoardSetup& board : setup.boards) state.warps.push_back(board.warp);
  std::vector<BoardPose> poses(views.size());
  for (std::size_t c = 0; c < cameras; ++c) start_camera(views, setup, c, state, poses);
  tie_cameras(views, poses, state);
}

}  // namespace gonio::camera
