#include "explain/robot/robot_world.h"

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "camera/corner_table.h"
#include "manifest/document.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mounting.h"
#include "manifest/sections/robot.h"

namespace gonio::explain::tests {
namespace {

using Pose = Eigen::Isometry3d;
using Joints = Eigen::Matrix<double, 6, 1>;
using Six = Eigen::Matrix<double, 6, 1>;

Pose turned_about(const Eigen::Vector3d& axis, const Eigen::Vector3d& through, double angle) {
  Pose p = Pose::Identity();
  p.translate(through).rotate(Eigen::AngleAxisd(angle, axis)).translate(-through);
  return p;
}

// UR5e at zero: arm stretched along -x at the height of the shoulder, wrist below, tool looking along -y.
struct Drawing {
  std::array<Eigen::Vector3d, 6> axis, through;
  Pose home = Pose::Identity();
};
Drawing ur5e(double longer_upper_arm) {
  const double shoulder = 0.1625, elbow = -0.425 - longer_upper_arm, wrist = elbow - 0.3922;
  const Eigen::Vector3d up(0, 0, 1), side(0, -1, 0);
  Drawing d;
  d.axis = {up, side, side, side, -up, side};
  d.through = {Eigen::Vector3d(0, 0, 0),
               Eigen::Vector3d(0, 0, shoulder),
               Eigen::Vector3d(elbow, 0, shoulder),
               Eigen::Vector3d(wrist, 0, shoulder),
               Eigen::Vector3d(wrist, -0.1333, 0),
               Eigen::Vector3d(wrist, 0, shoulder - 0.0997)};
  d.home.translation() = Eigen::Vector3d(wrist, -0.1333 - 0.0996, shoulder - 0.0997);
  d.home.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return d;
}
Drawing grown(Drawing d, double factor) {
  for (Eigen::Vector3d& point : d.through) point *= factor;
  d.home.translation() *= factor;
  return d;
}
Pose tool(const Drawing& d, const Joints& q) {
  Pose p = Pose::Identity();
  for (int i = 0; i < 6; ++i) {
    const auto k = static_cast<std::size_t>(i);
    p = p * turned_about(d.axis[k], d.through[k], q[i]);
  }
  return p * d.home;
}

Six difference(const Pose& from, const Pose& to) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(to.linear() * from.linear().transpose()));
  Six d;
  d << turn.axis() * turn.angle(), to.translation() - from.translation();
  return d;
}

// Newton from a posture above the table; false where it ends nowhere or far from that posture.
bool reach(const Drawing& d, const Pose& goal, Joints& q) {
  const Joints start = q;
  for (int i = 0; i < 60; ++i) {
    const Six error = difference(tool(d, q), goal);
    if (error.norm() < 1e-10) return (q - start).cwiseAbs().maxCoeff() < 2.5;
    Eigen::Matrix<double, 6, 6> slope;
    for (int k = 0; k < 6; ++k) {
      Joints up = q;
      up[k] += 1e-6;
      slope.col(k) = difference(tool(d, q), tool(d, up)) / 1e-6;
    }
    const Joints step = (slope.transpose() * slope + 1e-8 * Eigen::Matrix<double, 6, 6>::Identity())
                            .ldlt()
                            .solve(slope.transpose() * error);
    q += step * std::min(1.0, 0.3 / step.cwiseAbs().maxCoeff());
  }
  return false;
}

// The arm hangs by what the weight at its tool does to joints 2 and 3: found by moving them.
Joints hanging(const Drawing& d, Joints q, double rad_per_m) {
  const Joints straight = q;
  for (const int j : {1, 2}) {
    Joints up = straight, down = straight;
    up[j] += 1e-5, down[j] -= 1e-5;
    q[j] -= rad_per_m * (tool(d, up).translation().z() - tool(d, down).translation().z()) / 2e-5;
  }
  return q;
}

template <class To, class From>
manifest::Pose<To, From> section(const Pose& p) {
  Eigen::Quaterniond q(p.linear());
  if (q.w() < 0) q.coeffs() *= -1;
  manifest::Pose<To, From> pose;
  pose.rotation = {q.w(), q.x(), q.y(), q.z()};
  pose.translation_m = {p.translation().x(), p.translation().y(), p.translation().z()};
  return pose;
}

struct Dice {
  std::mt19937_64 engine;
  double between(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine); }
  double normal(double sigma) { return std::normal_distribution<double>(0, 1)(engine) * sigma; }
  Pose shaken(const Pose& p, double turn, double shift) {
    const Eigen::Vector3d w(normal(turn), normal(turn), normal(turn)), t(normal(shift), normal(shift), normal(shift));
    Pose xi = Pose::Identity();
    xi.translate(t);
    if (w.norm() > 0) xi.rotate(Eigen::AngleAxisd(w.norm(), w.normalized()));
    return p * xi;
  }
};

constexpr double focal = 1000, square = 0.03;
constexpr int columns = 8, rows = 6;

// Corners of the true board as the camera sees them, noise added; the table holds the corners of the stated board.
camera::ImageCorners photograph(const Pose& camera_from_board, const CellTruth& truth, Dice& dice,
                                const std::string& name) {
  camera::ImageCorners image{name, {}};
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const double xi = 2.0 * c / (columns - 1) - 1;
      const Eigen::Vector3d point(c * square * (1 + truth.board_stretch), r * square * (1 + truth.board_stretch),
                                  truth.board_sag_m * (1 - xi * xi));
      const Eigen::Vector3d seen = camera_from_board * point;
      image.corners.push_back({r * columns + c,
                               {c * square, r * square},
                               {640 + focal * seen.x() / seen.z() + dice.normal(truth.corner_px),
                                480 + focal * seen.y() / seen.z() + dice.normal(truth.corner_px)},
                               0.1});
    }
  return image;
}

void describe(manifest::Document& d) {
  manifest::Camera& camera = d.cameras["cam"];
  camera.width_px = 1280, camera.height_px = 960;
  camera.fx_px = focal, camera.fy_px = focal, camera.cx_px = 640.0, camera.cy_px = 480.0;
  camera.sigma = {{"fx_px", {0.3}}, {"fy_px", {0.3}}, {"cx_px", {0.3}}, {"cy_px", {0.3}}};
  manifest::Board& board = d.boards["board"];
  board.kind = "checkerboard";
  board.inner_corners = {columns, rows};
  board.square_m = square;
  d.robots["arm"].model = "ur5e";
}

// Where the camera is, about the board's middle.
struct Viewpoint {
  double tilt = 0, around = 0, range = 0, roll = 0;
};
Viewpoint thrown(const CellTruth& truth, Dice& dice) {
  Viewpoint v;
  v.tilt = dice.between(0, truth.tilt_rad);
  v.around = dice.between(0, 2 * pi);
  v.range = dice.between(0.35, 0.7);
  return v;
}
// A drive around the board: every part of the viewpoint swings in a time of its own.
Viewpoint driven(const CellTruth& truth, double t) {
  const auto swing = [&](double period) { return std::sin(2 * pi * t / period); };
  return {0.5 * truth.tilt_rad * (1.1 + swing(3.1)), 2.5 * swing(6.3), 0.5 + 0.12 * swing(2.3), 0.7 * swing(3.7)};
}
Pose board_from_camera(const Viewpoint& v, const Eigen::Vector3d& middle) {
  Pose p = Pose::Identity();
  p.rotate(Eigen::AngleAxisd(v.around, Eigen::Vector3d::UnitZ()))
      .rotate(Eigen::AngleAxisd(v.tilt, Eigen::Vector3d::UnitX()));
  p.rotate(Eigen::AngleAxisd(v.roll - v.around, Eigen::Vector3d::UnitZ()));
  p.translation() = middle - p.linear() * Eigen::Vector3d(0, 0, v.range);
  return p;
}

}  // namespace

manifest::Document robot_cell(const CellTruth& truth, std::size_t views, std::uint64_t seed) {
  Dice dice{std::mt19937_64(seed * 7919 + 13)};
  const Drawing nominal = ur5e(0), real = ur5e(truth.longer_upper_arm_m);
  Joints offset;
  for (int i = 0; i < 6; ++i) offset[i] = truth.joint_offset_rad[static_cast<std::size_t>(i)];
  Pose tool_from_camera = Pose::Identity(), base_from_board = Pose::Identity();
  tool_from_camera.translate(Eigen::Vector3d(0.03, -0.06, 0.05))
      .rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d(0.1, 0.2, 1).normalized()));
  base_from_board.translate(Eigen::Vector3d(-0.55, 0.05, 0.02));
  base_from_board.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;  // face up: z away from the viewer
  const Eigen::Vector3d middle(0.5 * (columns - 1) * square, 0.5 * (rows - 1) * square, 0);

  manifest::Document d;
  describe(d);
  camera::CornerTable table{"cam", "board", {}};
  Joints before = Joints::Zero();
  for (int tries = 0; table.images.size() < views && tries < 10000; ++tries) {
    // A camera that looks at the board's middle from 0.35 to 0.7 m, aslant, rolled.
    const double now_s = 0.1 * tries;
    Viewpoint viewpoint = truth.in_motion ? driven(truth, now_s) : thrown(truth, dice);
    if (!truth.in_motion) viewpoint.roll = dice.between(-1, 1);
    const auto joints_at = [&](const Viewpoint& at, Joints& q) {
      return reach(nominal, base_from_board * board_from_camera(at, middle) * tool_from_camera.inverse(), q);
    };
    Joints q;
    q << -0.3, -1.5, 1.4, -1.5, -1.57, 0.3;
    if (!joints_at(viewpoint, q)) continue;
    Joints truly = q;
    if (truth.lag_s != 0 && !joints_at(driven(truth, now_s + truth.lag_s), truly)) continue;
    for (int i = 0; i < 6 && !table.images.empty(); ++i)
      truly[i] += (q[i] > before[i] ? 0.5 : -0.5) * truth.backlash_rad[static_cast<std::size_t>(i)];
    before = q;
    const double warmer = truth.warming_K * static_cast<double>(table.images.size()) / static_cast<double>(views - 1);
    const Drawing warm = grown(real, 1 + truth.growth_per_K * warmer);
    const Pose stands = dice.shaken(tool(warm, hanging(warm, truly + offset, truth.sag_rad_per_m)),
                                    truth.robot_turn_rad, truth.robot_shift_m);
    const Pose camera_from_board = (stands * tool_from_camera).inverse() * base_from_board;
    manifest::ImageEntry image;
    image.id = "view" + std::to_string(table.images.size());
    image.camera = "cam", image.board = "board", image.robot = "arm";
    image.base_from_tool = section<frame::Base, frame::Tool>(tool(nominal, q));
    if (truth.in_motion) image.time_s = now_s;
    if (truth.warming_K != 0) image.temperature_K = 295 + warmer;
    for (int i = 0; i < 6; ++i) image.joints_rad.push_back(q[i]);
    image.camera_from_board = section<frame::Camera, frame::Board>(dice.shaken(camera_from_board, 1e-3, 1e-3));
    table.images.push_back(photograph(camera_from_board, truth, dice, image.id));
    d.images.push_back(image);
  }
  camera::write_corners(table, "corners", {}, d);
  manifest::Mounting& mounting = d.mountings["hand"];
  mounting.kind = "eye-in-hand";
  mounting.robot = "arm", mounting.camera = "cam", mounting.board = "board";
  mounting.tool_from_camera = section<frame::Tool, frame::Camera>(dice.shaken(tool_from_camera, 5e-3, 3e-3));
  mounting.base_from_board = section<frame::Base, frame::Board>(dice.shaken(base_from_board, 5e-3, 3e-3));
  return d;
}

}  // namespace gonio::explain::tests
