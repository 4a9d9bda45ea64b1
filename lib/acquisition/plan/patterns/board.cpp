// Views of a calibration board that tell most of the camera and of its place on the arm. The board lies across `up`,
// its middle the target; the camera views it from a cone, from several distances, turned about its own axis.
//
// Hand-eye calibration solves R_A R_X = R_X R_B for motions between stations (Tsai & Lenz 1989). A motion by the angle
// t about the unit axis a tells of a small turn w of the camera on the arm through (R_A - 1) w alone, whose square is
// 4 sin^2(t/2) |w - a (a.w)|^2: nothing about turns round its own axis, most at large angles. Their rules, large
// rotations about axes that differ, are this sum: stations are chosen one by one from all of the cone so that
// det sum over pairs of 4 sin^2(t/2) (1 - a a') grows most (D-optimal). Distances take turns, nearest and farthest
// first, which separates focal length from distance in tilted views.
#include <algorithm>
#include <array>
#include <cmath>

#include "acquisition/plan/view_steps.h"

namespace gonio::acquisition::patterns {
namespace {

struct BoardView {
  Direction from;
  double spin_rad = 0;
  manifest::Pose<frame::World, frame::Camera> pose;
  bool taken = false;
};

void add_board_motion(Mat3& m, const Quaternion& a, const Quaternion& b) {
  const Vec3 turn = rotation_vector_of(a * conjugate(b));
  const double angle = norm(turn);
  if (angle < 1e-9) return;
  const Vec3 axis = turn / angle;
  const double weight = 4 * std::pow(std::sin(angle / 2), 2);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) += weight * ((i == j ? 1 : 0) - axis[i] * axis[j]);
}
double determinant(const Mat3& m) {
  const Vec3 a{m(0, 0), m(1, 0), m(2, 0)}, b{m(0, 1), m(1, 1), m(2, 1)}, c{m(0, 2), m(1, 2), m(2, 2)};
  return dot(a, cross(b, c));
}

std::vector<BoardView> board_views(const PatternScene& scene, const PatternNumbers& n) {
  std::vector<BoardView> all;
  for (const double tilt : {0.0, n.at("tilt") / 2, n.at("tilt")})
    for (int k = 0; k < 8; ++k)
      for (const double spin : {0.0, n.at("twist"), -n.at("twist")}) {
        if ((tilt == 0 && k > 0) || (spin != 0 && n.at("twist") == 0)) continue;
        BoardView view{{tilt, n.at("azimuth") + k * pi / 4}, spin, {}};
        view.pose = camera_at(scene, view.from, 1);
        // About the optical axis, applied in the camera's frame.
        view.pose.rotation = normalized(view.pose.rotation * quaternion_of_rotation_vector({0, 0, spin}));
        all.push_back(view);
      }
  return all;
}

std::vector<manifest::PlanStep> board_steps(const PatternScene& scene, const PatternNumbers& n) {
  std::vector<BoardView> views = board_views(scene, n);
  const auto count = static_cast<std::size_t>(n.at("views"));
  const double near = n.at("nearest"), far = std::max(near, n.at("farthest"));
  const std::array<double, 3> distances{near, far, (near + far) / 2};
  Mat3 sum{{1e-3, 0, 0, 0, 1e-3, 0, 0, 0, 1e-3}};  // before two motions the determinant would be 0 for all
  std::vector<Quaternion> stations;
  std::vector<manifest::PlanStep> steps;
  while (steps.size() < count) {
    BoardView* best = nullptr;
    double most = -1;
    Mat3 best_sum;
    for (BoardView& view : views) {
      if (view.taken) continue;
      Mat3 with = sum;
      for (const Quaternion& q : stations) add_board_motion(with, view.pose.rotation, q);
      const double value = determinant(with);
      if (value > most * (1 + 1e-9)) most = value, best = &view, best_sum = with;
    }
    if (best == nullptr) {  // all were taken once: the cone again, from other distances
      for (BoardView& view : views) view.taken = false;
      continue;
    }
    best->taken = true, sum = best_sum;
    stations.push_back(best->pose.rotation);
    manifest::PlanStep step = view_step(scene, image_name("board", steps.size()));
    step.purpose = "board";
    step.world_from_camera = best->pose;
    step.world_from_camera->translation_m =
        place_at(scene, best->from, distances[(steps.size() + steps.size() / views.size()) % 3]);
    steps.push_back(std::move(step));
  }
  return steps;
}

}  // namespace

const ViewPattern& board() {
  static const ViewPattern pattern{
      "board",
      "Views of a calibration board from which camera and hand-eye calibration learn most.",
      "Tsai & Lenz 1989, section on accuracy: large rotations between stations about different axes",
      {{"views", "1", 15, 1, 10000, "of the board"},
       {"tilt", "rad", 40 * degree, degree, 80 * degree, "of the cone: largest angle from the board's normal"},
       {"twist", "rad", 60 * degree, 0, 180 * degree, "about the optical axis, to either side"},
       {"nearest", "m", 0.35, 0.01, 100, "distance from the board's middle"},
       {"farthest", "m", 0.6, 0.01, 100, "distance from the board's middle"},
       {"azimuth", "rad", 0, -2 * pi, 2 * pi, "of the first tilted view"}},
      board_steps};
  return pattern;
}

}  // namespace gonio::acquisition::patterns
