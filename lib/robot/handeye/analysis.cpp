#include "robot/handeye/analysis.h"

#include <algorithm>
#include <cmath>

#include "linear/solve.h"
#include "robot/handeye/closed_forms.h"
#include "robot/handeye/next_poses.h"
#include "robot/handeye/pose_adjustment.h"
#include "stats/distributions.h"

namespace gonio::robot::handeye {
namespace {

constexpr double many_outliers = 0.3, clearly_better = 3;

std::vector<View> counted(const std::vector<View>& views, const std::vector<bool>& counts) {
  std::vector<View> list;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (counts[i]) list.push_back(views[i]);
  }
  return list;
}

// What one pose's noise of the robot and of the camera moves the board's middle by, root mean square.
Parts parts_of(const Setup& setup, const std::vector<View>& views, const Refined& r, double scatter_m) {
  double robot2 = 0, camera2 = 0;
  const double n = static_cast<double>(std::max<std::size_t>(1, views.size()));
  for (const View& view : views) {
    const CornerInformation c = corner_information(setup, view, view.camera_from_board, r.noise.corner);
    const Matrix6 covariance = r.noise.corner * r.noise.corner * linear::solve_ldlt(c.information, Matrix6::Identity());
    const Vec3 middle = view.camera_from_board.rotate(setup.middle_m());
    Eigen::Matrix<double, 3, 6> moves;
    moves << -cross_matrix(eigen_of(middle)), Matrix3::Identity();
    camera2 += (moves * covariance * moves.transpose()).trace() / n;
    // The robot turns about its tool: a board in its base is seen at the end of this arm, one in its tool swings by it.
    const Vec3 in_mount = r.solution.mount_from_camera * (view.camera_from_board * setup.middle_m());
    const Vec3 in_stand = r.solution.stand_from_board * setup.middle_m();
    const Vec3 arm = setup.kind == Kind::eye_in_hand ? in_mount : in_stand;
    robot2 += (3 * r.noise.robot_m * r.noise.robot_m + 2 * dot(arm, arm) * r.noise.robot_rad * r.noise.robot_rad) / n;
  }
  const double rest = scatter_m * scatter_m - robot2 - camera2;
  return {std::sqrt(robot2), std::sqrt(camera2), std::sqrt(std::max(0.0, rest))};
}

double inverted_ratio(const Setup& setup, const std::vector<View>& views, double scatter_m) {
  Setup other = setup;
  other.kind = setup.kind == Kind::eye_in_hand ? Kind::eye_to_hand : Kind::eye_in_hand;
  const auto samples = samples_of(other, views);
  const Solution s = closed_form("park", "").solve(samples);
  return scatter_m / std::max(1e-12, scatter(samples, s, setup.middle_m()).translation_m);
}

void enter_complaints(const Setup& setup, std::size_t views, Analysis& a) {
  if (a.inverted_ratio > clearly_better) {
    a.complaints.push_back("the poses fit better inverted: " +
                           std::string(setup.kind == Kind::eye_in_hand
                                           ? "does the camera stand still (--kind eye-to-hand)"
                                           : "does the robot hold the camera (--kind eye-in-hand)") +
                           ", or are they tool_from_base (--pose-direction)?");
  }
  const auto out = static_cast<double>(std::ranges::count(a.consensus.counts, false));
  if (out > many_outliers * static_cast<double>(views)) {
    a.complaints.push_back(std::to_string(static_cast<int>(out)) + " of " + std::to_string(views) +
                           " poses do not fit the others");
  }
  if (!a.consensus.refined.converged) a.complaints.push_back("the refinement did not converge");
  for (const std::string& direction : a.observability.unobservable) {
    a.complaints.push_back("not determined by these poses: " + direction);
  }
}

}  // namespace

const HeldOutErrors* Analysis::held_out_of(const std::string& name) const {
  const auto found = std::ranges::find(held_out, name, &HeldOutErrors::method);
  return found == held_out.end() ? nullptr : &*found;
}

std::optional<double> Analysis::within_m() const {
  const HeldOutErrors* errors = held_out_of(method);
  if (errors == nullptr) return std::nullopt;
  return errors->rms.translation_m * std::sqrt(stats::chi2_quantile(0.95, 3) / 3);
}

Analysis analyse(const Setup& setup, const std::vector<View>& views, const std::string& method) {
  Analysis a;
  a.method = method;
  a.consensus = find_consensus(setup, views);
  const std::vector<View> good = counted(views, a.consensus.counts);
  const std::vector<PoseSample> samples = samples_of(setup, good);
  a.observability = observe(setup, views, a.consensus.counts, a.consensus.refined);
  if (good.size() >= 4) {
    for (const char* name : {"joint", "reprojection"}) a.held_out.push_back(held_out(setup, good, name));
    for (const ClosedForm& form : closed_forms()) a.held_out.push_back(held_out(setup, good, std::string(form.name)));
  }
  a.best_closed = "park";
  for (const HeldOutErrors& e : a.held_out) {
    if (e.method == "joint" || e.method == "reprojection") continue;
    if (e.rms.translation_m < a.held_out_of(a.best_closed)->rms.translation_m) a.best_closed = e.method;
  }
  a.closed = closed_form(a.best_closed, "").solve(samples);
  a.solution = method == "joint" ? a.consensus.refined.solution : closed_form(method, "--method").solve(samples);
  for (const View& view : views) {
    a.before.push_back(error_at(setup, view, a.closed));
    a.after.push_back(error_at(setup, view, a.solution));
  }
  a.scatter = scatter(samples, a.solution, setup.middle_m());
  std::vector<HeldOutView> fitted;
  for (const View& view : good) fitted.push_back(error_at(setup, view, a.solution));
  a.rms_px = root_mean_square(fitted).rms_px;
  a.parts = parts_of(setup, good, a.consensus.refined, a.scatter.translation_m);
  a.inverted_ratio = inverted_ratio(setup, views, a.scatter.translation_m);
  if (a.observability.mount_from_camera) a.next = next_poses(setup, views, a.consensus.counts, a.consensus.refined);
  enter_complaints(setup, views.size(), a);
  return a;
}

}  // namespace gonio::robot::handeye
