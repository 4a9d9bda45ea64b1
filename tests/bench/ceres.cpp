// `scripts/bench ceres`: three problems of calibration as the rooms solve them and by Ceres, on the same simulated
// worlds, in one thread. Times: processor time, the least of five. Errors: against the truth of the simulation.
//   bench-ceres pose      the sample's pose: optim::fit and optim::fit_by_ceres of the same model
//   bench-ceres handeye   twelve numbers of two mountings: robot/handeye/reprojection.h, and the same by fit_by_ceres
//   bench-ceres boards    bundle adjustment of one camera: camera::adjust, and Ceres with its own Schur complement
#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "camera/bundle_adjustment.h"
#include "contrast/measure/sample_pose_problem.h"
#include "optim/ceres_fit.h"
#include "robot/handeye/pose_adjustment.h"
#include "robot/handeye/reprojection.h"
#include "robot/handeye_world.h"

namespace gonio {
namespace {

double now_s() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Side {
  double seconds = 0, error2 = 0, steps = 0;
};
template <class Solve>
double timed(const Solve& solve) {
  double least = HUGE_VAL;
  for (int k = 0; k < 5; ++k) {
    const double begun = now_s();
    solve();
    least = std::min(least, now_s() - begun);
  }
  return least;
}

void print(const char* what, int count, const Side& own, const Side& ceres, double worst) {
  const auto each = static_cast<double>(count);
  std::printf("%-16s own %9.4f ms, %5.1f steps, error %.6g; Ceres %9.4f ms, %5.1f steps, error %.6g\n", what,
              1e3 * own.seconds / each, own.steps / each, std::sqrt(own.error2 / each), 1e3 * ceres.seconds / each,
              ceres.steps / each, std::sqrt(ceres.error2 / each));
  std::printf("%-16s Ceres takes %.2f of the time; its minimum lies at most %.1e of the cost above the own one\n", "",
              ceres.seconds / own.seconds, worst);
}

Vec3 normal3(Random& random, double sigma) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {sigma * x, sigma * y, sigma * z};
}

// --- the sample's pose from four corners in `images` pictures of a robot's camera ---

struct MarkedWorld {
  contrast::CellPattern pattern{12, 12, {0.001, 0.001}, std::vector<unsigned char>(144, 1)};
  Rigid<frame::World, frame::Object> truth{quaternion_of_rotation_vector({pi - 0.05, 0.03, 0.1}), {0.01, 0.02, 0.003}};
  std::vector<camera::CameraModel> cameras;
  std::vector<contrast::CameraPose> poses;
  std::vector<contrast::PlacedMark> marks;

  MarkedWorld(int images, Random& random) {
    for (int i = 0; i < images; ++i) {
      camera::Intrinsics lens;
      lens.fx_px = lens.fy_px = 2400;
      lens.cx_px = lens.cy_px = 100;
      cameras.emplace_back(lens, 201, 201);
      const double side = images > 1 ? static_cast<double>(i) / (images - 1) - 0.5 : 0;
      const Rigid<frame::Camera, frame::World> real{quaternion_of_rotation_vector({pi, 0.9 * side, 0.6 * side}),
                                                    {-0.01, 0.02, 0.3}};
      contrast::CameraPose pose{real, 2e-4, 1e-4};
      const Quaternion turn = quaternion_of_rotation_vector(normal3(random, pose.sigma_rad));
      pose.camera_from_world = {normalized(turn * real.rotation),
                                matrix_of(turn) * real.translation_m + normal3(random, pose.sigma_m)};
      for (int k = 0; k < 4; ++k) {
        const auto pixel = cameras.back().project(real * (truth * contrast::pattern_corner(pattern, k)));
        marks.push_back({static_cast<std::size_t>(i),
                         k,
                         {pixel->x + 0.3 * random.normal(), pixel->y + 0.3 * random.normal()},
                         0.3});
      }
      poses.push_back(pose);
    }
  }
  double error2(const Rigid<frame::World, frame::Object>& found) const {
    const Vec3 middle = contrast::pattern_middle(pattern), d = found * middle - truth * middle;
    return dot(d, d);
  }
};

void pose(int images, int count) {
  Random random(4);
  Side own, ceres;
  double worst = -1;
  optim::Limits limits;
  limits.first_damping = 1e-4;
  limits.small_fall = limits.rounding = {1e-9, 1e-18};
  for (int run = 0; run < count; ++run) {
    const MarkedWorld world(images, random);
    const contrast::SamplePoseProblem problem(world.pattern, world.cameras, world.poses, world.marks);
    auto start = world.truth;  // as far off as the pose of four marks in one picture is
    start.rotation = normalized(quaternion_of_rotation_vector(normal3(random, 0.05)) * start.rotation);
    start.translation_m += normal3(random, 0.003);
    const Eigen::VectorXd x = problem.parameters(start);
    optim::Fit a, b;
    own.seconds += timed([&] { a = optim::fit(problem, x, {}, limits); });
    ceres.seconds += timed([&] { b = optim::fit_by_ceres(problem, x, limits); });
    own.error2 += world.error2(contrast::SamplePoseProblem::pose(a.x));
    ceres.error2 += world.error2(contrast::SamplePoseProblem::pose(b.x));
    own.steps += a.descended.steps, ceres.steps += b.descended.steps;
    worst = std::max(worst, (b.cost - a.cost) / a.cost);
  }
  print(("pose, " + std::to_string(images) + " images").c_str(), count, own, ceres, worst);
}

// --- both mountings of a hand-eye calibration from all corners ---

// Parameters: quaternion and shift of either mounting. Slopes as the room has them (robot/handeye/reprojection.cpp).
struct MountingsModel final : optim::Model {
  const robot::handeye::Setup& setup;
  const std::vector<robot::handeye::View>& views;
  MountingsModel(const robot::handeye::Setup& s, const std::vector<robot::handeye::View>& v) : setup(s), views(v) {}

  static Eigen::VectorXd parameters(const robot::handeye::Solution& s) {
    const auto& [q, t] = s.mount_from_camera;
    const auto& [p, u] = s.stand_from_board;
    Eigen::VectorXd x(14);
    x << q.w, q.x, q.y, q.z, t.x, t.y, t.z, p.w, p.x, p.y, p.z, u.x, u.y, u.z;
    return x;
  }
  static robot::handeye::Solution solution(const Eigen::VectorXd& x) {
    return {{{x[0], x[1], x[2], x[3]}, {x[4], x[5], x[6]}}, {{x[7], x[8], x[9], x[10]}, {x[11], x[12], x[13]}}};
  }
  Eigen::Index freedoms(const Eigen::VectorXd&) const override { return 12; }
  Eigen::VectorXd moved(const Eigen::VectorXd& x, const Eigen::VectorXd& change) const override {
    return parameters(robot::handeye::moved_by(solution(x), robot::handeye::Vector12(change)));
  }
  bool residuals(const Eigen::VectorXd& x, Eigen::VectorXd& r) const override {
    Eigen::Index n = 0;
    for (const auto& view : views) n += 2 * static_cast<Eigen::Index>(view.corners.size());
    r.resize(n);
    Eigen::Index row = 0;
    for (const auto& view : views) {
      const camera::BoardPose pose = robot::handeye::predicted_pose(setup.kind, view, solution(x));
      for (const auto& corner : view.corners) {
        Vec2 pixel;
        if (!camera::predict(setup.lens, pose, setup.extent, setup.warp, corner.board_m, pixel)) return false;
        r[row++] = (pixel.x - corner.pixel.x) / corner.sigma_px;
        r[row++] = (pixel.y - corner.pixel.y) / corner.sigma_px;
      }
    }
    return true;
  }
  Eigen::MatrixXd slopes(const Eigen::VectorXd& x, const Eigen::VectorXd& r) const override {
    using namespace robot::handeye;
    Eigen::MatrixXd j(r.size(), 12);
    std::array<std::array<double, camera::BoardColumn::count>, 2> jacobian{};
    Eigen::Index row = 0;
    for (const View& view : views) {
      const camera::BoardPose pose = predicted_pose(setup.kind, view, solution(x));
      const Deviation d =
          deviation(setup.kind, {view.base_from_tool, pose, Matrix6::Identity(), true, setup.middle_m()}, solution(x));
      const Matrix6x12 by_mountings = -d.by_pose.partialPivLu().solve(d.by_mountings);
      for (const SeenCorner& corner : view.corners) {
        Vec2 pixel;
        camera::predict(setup.lens, pose, setup.extent, setup.warp, corner.board_m, pixel, jacobian);
        for (const auto& of : jacobian)
          j.row(row++) = Eigen::Map<const Eigen::Matrix<double, 1, 6>>(of.data() + camera::BoardColumn::rotation) *
                         by_mountings / corner.sigma_px;
      }
    }
    return j;
  }
};

void handeye(int count) {
  Side own, ceres;
  double worst = -1;
  optim::Limits limits;
  limits.most_steps = 60;
  limits.first_damping = 1e-6;
  limits.small_fall = {1e-12, 0};
  for (int run = 0; run < count; ++run) {
    const tests::HandEyeWorld world;
    const robot::handeye::Setup setup = world.setup();
    const auto views = world.views(static_cast<std::uint64_t>(run));
    Random random(static_cast<std::uint64_t>(run), 3);
    robot::handeye::Solution start = world.truth;
    start.mount_from_camera.translation_m += normal3(random, 0.005);
    start.stand_from_board.rotation =
        normalized(quaternion_of_rotation_vector(normal3(random, 0.02)) * start.stand_from_board.rotation);
    const MountingsModel model(setup, views);
    robot::handeye::Solution a;
    optim::Fit b;
    own.seconds += timed([&] { a = robot::handeye::minimise_reprojection(setup, views, start); });
    ceres.seconds += timed([&] { b = optim::fit_by_ceres(model, MountingsModel::parameters(start), limits); });
    const auto error2 = [&](const robot::handeye::Solution& s) {
      const Vec3 d = s.mount_from_camera.translation_m - world.truth.mount_from_camera.translation_m;
      return dot(d, d);
    };
    own.error2 += error2(a), ceres.error2 += error2(MountingsModel::solution(b.x));
    ceres.steps += b.descended.steps;
    Eigen::VectorXd r;
    model.residuals(MountingsModel::parameters(a), r);
    worst = std::max(worst, (b.cost - r.squaredNorm()) / r.squaredNorm());
  }
  print("hand-eye, 15", count, own, ceres, worst);
}

// --- one camera and a board: bundle adjustment ---
using namespace camera;

struct BoardWorld {
  CalibrationSetup setup;
  std::vector<camera::View> views;
  Adjustment start;
  Intrinsics truth;

  BoardWorld(int pictures, std::uint64_t seed) {
    setup.cameras.resize(1);
    setup.cameras[0].width_px = 1280, setup.cameras[0].height_px = 960;
    setup.boards.resize(1);
    Board& board = setup.boards[0].board;
    board.corner_columns = 11, board.corner_rows = 8, board.square_m = 0.03;
    truth.fx_px = 1000, truth.fy_px = 1005, truth.cx_px = 642, truth.cy_px = 479;
    truth.distortion[0] = -0.1, truth.distortion[1] = 0.02;
    Random random(seed, 5);
    tests::HandEyeWorld hand;
    hand.columns = board.corner_columns, hand.rows = board.corner_rows;
    for (int i = 0; i < pictures; ++i) {
      const auto pose = hand.true_pose(random, i);
      camera::View view;
      view.shot = views.size();
      for (int id = 0; id < board.corners(); ++id) {
        Vec2 pixel;
        const double u = random.normal(), v = random.normal();
        if (!predict(truth, pose, board.extent(), {}, board.corner_m(id), pixel)) continue;
        view.corners.push_back({id, {pixel.x + 0.1 * u, pixel.y + 0.1 * v}, 0});
      }
      start.precision.emplace_back(view.corners.size(), 1.0);
      start.placement_of.push_back(views.size());
      views.push_back(std::move(view));
    }
    start.view_weights.assign(views.size(), 1);
    start.placements.resize(views.size());
    start.loss_px = 0.3;
    camera::start(views, setup, start);
  }
};

struct PlacementManifold final : ceres::Manifold {
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Minus(const double*, const double*, double*) const override { return false; }  // no solver here asks
  bool MinusJacobian(const double*, double*) const override { return false; }
  bool Plus(const double* x, const double* d, double* moved) const override {
    const auto& [q, t] =
        camera::moved({{x[0], x[1], x[2], x[3]}, {x[4], x[5], x[6]}}, {d[0], d[1], d[2], d[3], d[4], d[5]});
    const std::array<double, 7> all{q.w, q.x, q.y, q.z, t.x, t.y, t.z};
    std::ranges::copy(all, moved);
    return true;
  }
  bool PlusJacobian(const double*, double* j) const override {  // slopes are by change: six columns and one of zeros
    std::fill(j, j + 42, 0.0);
    for (int i = 0; i < 6; ++i) j[7 * i] = 1;
    return true;
  }
};

Intrinsics lens_at(const BoardWorld& world, const std::vector<FreeParameter>& free, const double* change) {
  Intrinsics lens = world.start.lenses[0];
  const std::array<double*, 4> pinhole{&lens.fx_px, &lens.fy_px, &lens.cx_px, &lens.cy_px};
  for (std::size_t p = 0; p < free.size(); ++p)
    for (const auto& [column, factor] : free[p].columns)
      (column < 4 ? *pinhole[column] : lens.distortion[column - BoardColumn::distortion]) += factor * change[p];
  return lens;
}

struct CornerCost final : ceres::CostFunction {
  const BoardWorld& world;
  const std::vector<FreeParameter>& free;
  Vec2 at, pixel;
  CornerCost(const BoardWorld& w, const std::vector<FreeParameter>& f, Vec2 board_m, Vec2 seen)
      : world(w), free(f), at(board_m), pixel(seen) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {static_cast<int>(free.size()), 7};
  }
  bool Evaluate(double const* const* x, double* r, double** j) const override {
    const camera::BoardPose pose{{x[1][0], x[1][1], x[1][2], x[1][3]}, {x[1][4], x[1][5], x[1][6]}};
    const Intrinsics lens = lens_at(world, free, x[0]);
    const BoardExtent extent = world.setup.boards[0].board.extent();
    Vec2 found;
    if (j == nullptr) {
      if (!predict(lens, pose, extent, {}, at, found)) return false;
    } else {
      std::array<std::array<double, BoardColumn::count>, 2> d{};
      if (!predict(lens, pose, extent, {}, at, found, d)) return false;
      for (std::size_t a = 0; a < 2; ++a) {
        if (j[0])
          for (std::size_t k = 0; k < free.size(); ++k) {
            double& slope = j[0][a * free.size() + k] = 0;
            for (const auto& [column, factor] : free[k].columns) slope -= factor * d[a][column];
          }
        if (j[1])
          for (std::size_t k = 0; k < 7; ++k) j[1][7 * a + k] = k < 6 ? -d[a][BoardColumn::rotation + k] : 0;
      }
    }
    r[0] = pixel.x - found.x, r[1] = pixel.y - found.y;
    return true;
  }
};

// The same minimum by Ceres: placements eliminated first, dense normal equations of the lens.
Adjustment adjusted_by_ceres(const BoardWorld& world, const std::vector<FreeParameter>& free, double& steps) {
  std::vector<double> shared(free.size());
  std::vector<std::array<double, 7>> placed;
  for (const auto& [q, t] : world.start.placements) placed.push_back({q.w, q.x, q.y, q.z, t.x, t.y, t.z});
  ceres::Problem problem;
  auto* ordering = new ceres::ParameterBlockOrdering;
  for (std::size_t i = 0; i < world.views.size(); ++i) {
    problem.AddParameterBlock(placed[i].data(), 7, new PlacementManifold);
    ordering->AddElementToGroup(placed[i].data(), 0);
    for (const auto& corner : world.views[i].corners)
      problem.AddResidualBlock(
          new CornerCost(world, free, world.setup.boards[0].board.corner_m(corner.id), corner.pixel),
          new ceres::HuberLoss(world.start.loss_px), shared.data(), placed[i].data());
  }
  ordering->AddElementToGroup(shared.data(), 1);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.linear_solver_ordering.reset(ordering);
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-12;
  options.gradient_tolerance = options.parameter_tolerance = 1e-14;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  steps = summary.num_successful_steps;
  Adjustment result = world.start;
  result.lenses[0] = lens_at(world, free, shared.data());
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const auto& x = placed[i];
    result.placements[i] = {{x[0], x[1], x[2], x[3]}, {x[4], x[5], x[6]}};
  }
  return result;
}

void boards(int pictures, int count) {
  Side own, ceres;
  double worst = -1;
  for (int run = 0; run < count; ++run) {
    const BoardWorld world(pictures, static_cast<std::uint64_t>(run));
    const auto free = free_parameters(world.setup, world.start);
    Adjustment a, b;
    double steps = 0;
    own.seconds += timed([&] {
      a = world.start;
      adjust(world.views, world.setup, a);
    });
    ceres.seconds += timed([&] { b = adjusted_by_ceres(world, free, steps); });
    ceres.steps += steps;
    const auto error2 = [&](const Adjustment& s) { return std::pow(s.lenses[0].fx_px - world.truth.fx_px, 2); };
    own.error2 += error2(a), ceres.error2 += error2(b);
    const double least = normal_equations(world.views, world.setup, free, a).cost;
    worst = std::max(worst, (normal_equations(world.views, world.setup, free, b).cost - least) / least);
  }
  print(("boards, " + std::to_string(pictures)).c_str(), count, own, ceres, worst);
}

}  // namespace
}  // namespace gonio

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  gonio::set_threads(1);
  if (what == "pose") {
    for (const int images : {1, 4, 12}) gonio::pose(images, 60 / images);
  } else if (what == "handeye") {
    gonio::handeye(10);
  } else if (what == "boards") {
    for (const int pictures : {15, 60}) gonio::boards(pictures, 4);
  } else {
    return std::fprintf(stderr, "usage: bench-ceres pose | handeye | boards\n"), 64;
  }
}
