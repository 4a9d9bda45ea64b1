// See next_views.h.
#include "camera/quality/next_views.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "base/parallel.h"
#include "camera/camera_model.h"
#include "camera/quality/linear_law.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"
#include "stats/intervals.h"

namespace gonio::camera {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
constexpr int grid_side = 20;
constexpr double steep = 40 * pi / 180;
constexpr double margin_px = 5;
constexpr double least_share = 0.5;  // of the board's corners that must be in the picture (all of a checkerboard's)

struct Place {
  double x, y;  // in the image, shares of its size
  const char* words;
};
constexpr std::array<Place, 9> places = {{{0.5, 0.5, "in the middle"},
                                          {0.25, 0.5, "on the left"},
                                          {0.75, 0.5, "on the right"},
                                          {0.5, 0.27, "at the top"},
                                          {0.5, 0.73, "at the bottom"},
                                          {0.25, 0.27, "in the upper left"},
                                          {0.75, 0.27, "in the upper right"},
                                          {0.25, 0.73, "in the lower left"},
                                          {0.75, 0.73, "in the lower right"}}};
struct Tilt {
  double about_x, about_y;  // camera's axes
  const char* words;
};
constexpr std::array<Tilt, 9> tilts = {
    {{0, 0, "facing the camera"},
     {0, steep, "tilted 40 degrees about the vertical, its right edge away"},
     {0, -steep, "tilted 40 degrees about the vertical, its left edge away"},
     {steep, 0, "tilted 40 degrees about the horizontal, its lower edge towards the camera"},
     {-steep, 0, "tilted 40 degrees about the horizontal, its upper edge towards the camera"},
     {0.7 * steep, 0.7 * steep, "tilted 40 degrees about a diagonal, its upper right corner away"},
     {0.7 * steep, -0.7 * steep, "tilted 40 degrees about a diagonal, its upper left corner away"},
     {-0.7 * steep, 0.7 * steep, "tilted 40 degrees about a diagonal, its lower right corner away"},
     {-0.7 * steep, -0.7 * steep, "tilted 40 degrees about a diagonal, its lower left corner away"}}};

struct CandidateView {
  BoardPose pose;
  std::size_t place = 0, tilt = 0;
  double distance_m = 0;
  Eigen::MatrixXd information{};  // about the shared numbers; empty: cannot be seen
  Eigen::MatrixXd
      by_shared{};  // what they do to the right-hand side of the rigid motion's least squares, through this pose
  Matrix6 by_noise = Matrix6::Zero(),
          normal = Matrix6::Zero();  // and the noise of its corners; and what the view adds to the matrix
};

// Distances that the session has shown to be possible, and one at which the board fills half of the picture's width.
std::vector<double> candidate_distances(const CameraResult& camera, const Board& board) {
  std::vector<double> seen;
  for (std::size_t v = 0; v < camera.views.size(); ++v) {
    if (!camera.uses(v)) continue;
    const BoardExtent extent = camera.board(v).extent();
    seen.push_back(norm(camera.calibration.views[v].camera_from_board * Vec3{extent.middle_m.x, extent.middle_m.y, 0}));
  }
  const double filling = camera.lens().fx_px * 2 * board.extent().half_m.x / (0.5 * camera.width_px());
  std::vector<double> result = {stats::quantile(seen, 0.1), stats::median(seen), filling};
  std::ranges::sort(result);
  const auto close = [](double a, double b) { return b < 1.15 * a; };
  result.erase(std::unique(result.begin(), result.end(), close), result.end());
  return result;
}

BoardPose pose_of(const Board& board, Vec3 direction, double distance_m, const Tilt& tilt) {
  const BoardExtent extent = board.extent();
  BoardPose pose;
  pose.rotation = quaternion_of_rotation_vector({tilt.about_x, tilt.about_y, 0});
  pose.translation_m = direction * distance_m - pose.rotate({extent.middle_m.x, extent.middle_m.y, 0});
  return pose;
}

void fill_information(const CameraResult& camera, std::size_t place, const std::vector<Direction>& columns,
                      CandidateView& candidate) {
  const Board& board = camera.setup.boards[place].board;
  const BoardWarp& warp = camera.calibration.boards[place].warp;
  std::vector<Vec2> points;
  for (int id = 0; id < board.corners(); ++id) {
    Vec2 pixel;
    if (!predict(camera.lens(), candidate.pose, board.extent(), warp, board.corner_m(id), pixel)) continue;
    if (pixel.x < margin_px || pixel.y < margin_px || pixel.x > camera.width_px() - 1 - margin_px ||
        pixel.y > camera.height_px() - 1 - margin_px)
      continue;
    points.push_back(board.corner_m(id));
  }
  const double needed = board.kind == BoardKind::checkerboard ? 1 : least_share;
  if (static_cast<double>(points.size()) < std::max(6.0, needed * board.corners())) return;
  const std::vector<double> weights(points.size(), 1 / (camera.noise_px() * camera.noise_px()));
  const ViewEquations e = view_equations(camera.lens(), candidate.pose, board, warp, columns, points, weights);
  const linear::Ldlt own(e.c);
  const AlignmentPart part = alignment_part(board, candidate.pose, warp, points);
  candidate.information = e.a - e.b * own.solve(e.b.transpose());
  candidate.by_shared = -part.by_pose * own.solve(e.b.transpose());
  add_warp(camera.calibration.shared, place, part, candidate.by_shared);
  candidate.by_noise = part.by_pose * own.solve(Matrix6(part.by_pose.transpose()));
  candidate.normal = part.normal;
}

std::vector<CandidateView> candidates(const CameraResult& camera, std::size_t board_place) {
  const Board& board = camera.setup.boards[board_place].board;
  const CameraModel model(camera.lens(), camera.width_px(), camera.height_px());
  std::vector<CandidateView> result;
  for (const double distance : candidate_distances(camera, board))
    for (std::size_t place = 0; place < places.size(); ++place) {
      const Vec3 direction =
          model.ray({places[place].x * (camera.width_px() - 1), places[place].y * (camera.height_px() - 1)}).direction;
      for (std::size_t tilt = 0; tilt < tilts.size(); ++tilt)
        result.push_back({pose_of(board, direction, distance, tilts[tilt]), place, tilt, distance});
    }
  const std::vector<Direction> columns = directions(camera, board_place);
  parallel_for(0, result.size(), [&](std::size_t k) { fill_information(camera, board_place, columns, result[k]); });
  std::erase_if(result, [](const CandidateView& v) { return v.information.size() == 0; });
  return result;
}

// Mean over the image and the distances of [P_s P_T]' [P_s P_T], P_s and P_T the pixel's derivatives by the shared
// numbers and by the rigid motion alone.
Eigen::MatrixXd target_of(const ProjectionLaw& law, const CameraResult& camera, const std::vector<double>& distances) {
  const auto k = static_cast<Eigen::Index>(camera.calibration.shared.size());
  Eigen::MatrixXd target = Eigen::MatrixXd::Zero(k + 6, k + 6);
  const CameraModel model(camera.lens(), camera.width_px(), camera.height_px());
  const ImageGrid grid = image_grid(camera.width_px(), camera.height_px(), grid_side);
  double count = 0;
  for (const double distance : distances)
    for (int j = 0; j < grid.rows; ++j)
      for (int i = 0; i < grid.columns; ++i) {
        const bool far = !std::isfinite(distance);
        const Vec3 direction = model.ray(grid.pixel(i, j)).direction;
        PixelDerivatives d;
        if (!pixel_derivatives(camera.lens(), law.linear(), far ? direction : direction * distance, far, d)) continue;
        Eigen::MatrixXd joint(2, k + 6);
        joint << d.by_shared - d.by_motion * law.linear().drift, d.by_motion;
        target += joint.transpose() * joint;
        count += 1;
      }
  return target / std::max(count, 1.0);
}

// Covariance after information J is added: S - S J^1/2 (1 + J^1/2 S J^1/2)^-1 J^1/2 S, without inverting S.
Eigen::MatrixXd updated(const Eigen::MatrixXd& s, const Eigen::MatrixXd& information) {
  const linear::SymmetricEigen<Eigen::MatrixXd> eigen(0.5 * (information + information.transpose()));
  const Eigen::MatrixXd root = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd middle = Eigen::MatrixXd::Identity(s.rows(), s.cols()) + root.transpose() * s * root;
  const Eigen::MatrixXd sr = s * root;
  return s - sr * linear::solve_ldlt(middle, sr.transpose());
}

// The law with a view added.
LinearLaw with(const LinearLaw& law, const CandidateView& v) {
  LinearLaw result = law;
  result.shared = updated(law.shared, v.information);
  result.normal = law.normal + v.normal;
  const linear::Ldlt normal(result.normal);
  result.drift = normal.solve(law.normal * law.drift + v.by_shared);
  const Matrix6 by_noise = law.normal * law.scatter * law.normal + v.by_noise;
  result.scatter = normal.solve(Matrix6(normal.solve(by_noise).transpose()));
  return result;
}

double mean_sigma(const Eigen::MatrixXd& target, const LinearLaw& law) {
  const Eigen::Index k = law.shared.rows();
  Eigen::MatrixXd covariance(k + 6, k + 6);
  const Eigen::MatrixXd cross = law.drift * law.shared;
  covariance << law.shared, cross.transpose(), cross, cross * law.drift.transpose() + law.scatter;
  return std::sqrt(std::max(0.0, (target * covariance).trace()));
}

std::string sentence_of(const CandidateView& v, double before, double after) {
  char text[320];
  std::snprintf(text, sizeof text,
                "the board %s of the picture at %.2g m, %s: lowers the projection's mean sigma from %.2g to %.2g px",
                places[v.place].words, v.distance_m, tilts[v.tilt].words, before, after);
  return text;
}

}  // namespace

std::vector<NextView> next_views(const CameraResult& camera, const std::vector<double>& distances_m,
                                 std::size_t count) {
  std::vector<NextView> result;
  if (camera.calibration.covariance.empty()) return result;
  std::vector<int> seen(camera.setup.boards.size());
  for (std::size_t v = 0; v < camera.views.size(); ++v) seen[camera.views[v].board] += camera.uses(v);
  const auto board = static_cast<std::size_t>(std::ranges::max_element(seen) - seen.begin());
  const ProjectionLaw law(camera);
  const Eigen::MatrixXd target = target_of(law, camera, distances_m);
  const std::vector<CandidateView> all = candidates(camera, board);
  LinearLaw state = law.linear();
  for (std::size_t n = 0; n < count && !all.empty(); ++n) {
    std::vector<double> after(all.size());
    parallel_for(0, all.size(), [&](std::size_t k) { after[k] = mean_sigma(target, with(state, all[k])); });
    const auto best = static_cast<std::size_t>(std::ranges::min_element(after) - after.begin());
    const double before = mean_sigma(target, state);
    result.push_back({all[best].pose, sentence_of(all[best], before, after[best]), before, after[best]});
    state = with(state, all[best]);
  }
  return result;
}

}  // namespace gonio::camera
