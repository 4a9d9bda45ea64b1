#include "robot/handeye/next_poses.h"

#include <algorithm>
#include <cmath>

#include "linear/solve.h"
#include "robot/handeye/pose_adjustment.h"
#include "robot/handeye/viewpoint.h"
#include "stats/intervals.h"

namespace gonio::robot::handeye {
namespace {

constexpr double margin_px = 5, least_gain = 0.02;

struct Candidate {
  std::string words;
  Matrix12 information;
};

// Corners of a typical view as that pose would show them; none where one falls out of the picture.
View imagined(const Setup& setup, const View& like, const camera::BoardPose& pose, const Solution& solution) {
  View view = like;
  view.camera_from_board = pose;
  for (SeenCorner& corner : view.corners) {
    const bool seen = camera::predict(setup.lens, pose, setup.extent, setup.warp, corner.board_m, corner.pixel);
    if (!seen || corner.pixel.x < margin_px || corner.pixel.y < margin_px ||
        corner.pixel.x > setup.width_px - margin_px || corner.pixel.y > setup.height_px - margin_px) {
      view.corners.clear();
      return view;
    }
  }
  const auto implied = solution.stand_from_board * inverse(pose) * inverse(solution.mount_from_camera);
  const Rigid<frame::Base, frame::Tool> forward{implied.rotation, implied.translation_m};
  const auto back = inverse(implied);
  view.base_from_tool =
      setup.kind == Kind::eye_in_hand ? forward : Rigid<frame::Base, frame::Tool>{back.rotation, back.translation_m};
  return view;
}

std::vector<Candidate> candidates(const Setup& setup, const View& like, double distance_m, const Refined& refined) {
  std::vector<Candidate> list;
  const double s2 = refined.noise.corner * refined.noise.corner;
  for (const double far : {0.8, 1.0, 1.25})
    for (const double tilt : {0.0, 30.0, 50.0})
      for (const double azimuth : {0.0, 90.0, 180.0, 270.0})
        for (const double spin : {0.0, 90.0, 180.0, -90.0}) {
          if (tilt == 0 && azimuth > 0) continue;
          const Viewpoint from{tilt, azimuth, spin, far * distance_m};
          const View view = imagined(setup, like, pose_of(from, setup.middle_m()), refined.solution);
          if (view.corners.empty()) continue;
          const CornerInformation c = corner_information(setup, view, view.camera_from_board, 1);
          const ObservedPose o{view.base_from_tool, view.camera_from_board,
                               s2 * linear::solve_ldlt(c.information, Matrix6::Identity()), true, setup.middle_m()};
          list.push_back({in_words(from, setup.kind == Kind::eye_in_hand ? "turn the camera" : "turn the board"),
                          information(setup.kind, {o}, refined.solution, refined.noise)});
        }
  return list;
}

// Variance of the board's middle through the camera's place alone: turns act at the board's distance.
double spread(const Matrix12& n, double distance_m) {
  Matrix12 scaled = n;
  scaled.diagonal() *= 1 + 1e-12;
  const Matrix12 covariance = linear::solve_ldlt(scaled, Matrix12::Identity());
  return covariance.diagonal().segment<3>(0).sum() * distance_m * distance_m +
         covariance.diagonal().segment<3>(3).sum();
}

}  // namespace

std::vector<std::string> next_poses(const Setup& setup, const std::vector<View>& views, const std::vector<bool>& counts,
                                    const Refined& refined, std::size_t most) {
  std::vector<double> distances;
  const View* like = nullptr;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!counts[i]) continue;
    distances.push_back(norm(views[i].camera_from_board * setup.middle_m()));
    if (like == nullptr || views[i].corners.size() > like->corners.size()) like = &views[i];
  }
  if (like == nullptr) return {};
  const double distance = stats::median(distances);
  const std::vector<Candidate> list = candidates(setup, *like, distance, refined);
  Matrix12 n = Eigen::Map<const Eigen::Matrix<double, 12, 12, Eigen::RowMajor>>(refined.information.data());
  std::vector<std::string> sentences;
  while (sentences.size() < most) {
    const double before = spread(n, distance);
    const Candidate* best = nullptr;
    double least = before;
    for (const Candidate& c : list) {
      const double after = spread(n + c.information, distance);
      if (!(after < least)) continue;
      least = after;
      best = &c;
    }
    if (best == nullptr || !(std::sqrt(least) < (1 - least_gain) * std::sqrt(before))) break;
    n += best->information;
    char gain[80];
    std::snprintf(gain, sizeof gain, ": sigma of the camera's place %.3g mm instead of %.3g mm", std::sqrt(least) * 1e3,
                  std::sqrt(before) * 1e3);
    sentences.push_back(best->words + gain);
  }
  return sentences;
}

}  // namespace gonio::robot::handeye
