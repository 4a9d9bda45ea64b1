// A camera in the hand of an arm of UR5e's dimensions, before a board on the table. The arm is a product of rotations
// about axes read off its drawing (Lynch & Park 2017, section 4.1.1), not a chain of Denavit and Hartenberg. It stops
// for every photograph while it warms up; in the design "in motion" it photographs on its way, four times a second.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "geom/vector.h"
#include "sealed/camera_chain.h"
#include "sealed/recording.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

using Pose = Eigen::Isometry3d;
using Six = Eigen::Matrix<double, 6, 1>;
using Vector = Eigen::Vector3d;

constexpr double focal = 1000, square = 0.03, corner_px = 0.1;
constexpr int columns = 8, rows = 6;
constexpr std::size_t per_view = 2 * columns * rows;

struct Arm {
  std::array<Vector, 6> axis, through;
  Pose home = Pose::Identity();
};
// At zero: stretched along -x at the height of the shoulder, wrist below, tool looking along -y.
Arm ur5e(double longer_upper_arm, double grown = 0) {
  const double more = 1 + grown;  // of all lengths
  const double shoulder = 0.1625 * more, elbow = -0.425 * more - longer_upper_arm, wrist = elbow - 0.3922 * more;
  const double side_1 = -0.1333 * more, side_2 = -0.0996 * more, drop = 0.0997 * more;
  const Vector up(0, 0, 1), side(0, -1, 0);
  Arm a;
  a.axis = {up, side, side, side, -up, side};
  a.through = {Vector(0, 0, 0),
               Vector(0, 0, shoulder),
               Vector(elbow, 0, shoulder),
               Vector(wrist, 0, shoulder),
               Vector(wrist, side_1, 0),
               Vector(wrist, 0, shoulder - drop)};
  a.home.translation() = Vector(wrist, side_1 + side_2, shoulder - drop);
  a.home.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return a;
}
Pose turn(const Vector& axis, const Vector& through, double angle) {
  Pose p = Pose::Identity();
  p.translate(through).rotate(Eigen::AngleAxisd(angle, axis)).translate(-through);
  return p;
}
Pose tool(const Arm& a, const Six& q) {
  Pose p = Pose::Identity();
  for (int i = 0; i < 6; ++i) {
    const auto k = static_cast<std::size_t>(i);
    p = p * turn(a.axis[k], a.through[k], q[i]);
  }
  return p * a.home;
}

Six difference(const Pose& from, const Pose& to) {
  const Eigen::AngleAxisd angle(Eigen::Matrix3d(to.linear() * from.linear().transpose()));
  Six d;
  d << angle.axis() * angle.angle(), to.translation() - from.translation();
  return d;
}
Pose moved(const Pose& p, const double* six) {  // by a rotation vector and a shift, on the right
  const Vector w(six[0], six[1], six[2]);
  Pose xi = Pose::Identity();
  xi.translate(Vector(six[3], six[4], six[5]));
  if (w.norm() > 0) xi.rotate(Eigen::AngleAxisd(w.norm(), w.normalized()));
  return p * xi;
}

// Newton from a posture above the table; false where it ends nowhere or far from that posture.
bool reach(const Arm& a, const Pose& goal, Six& q) {
  const Six start = q;
  for (int i = 0; i < 60; ++i) {
    const Six error = difference(tool(a, q), goal);
    if (error.norm() < 1e-10) return (q - start).cwiseAbs().maxCoeff() < 2.5;
    Eigen::Matrix<double, 6, 6> slope;
    for (int k = 0; k < 6; ++k) {
      Six up = q;
      up[k] += 1e-6;
      slope.col(k) = difference(tool(a, q), tool(a, up)) / 1e-6;
    }
    const Six step = (slope.transpose() * slope + 1e-8 * Eigen::Matrix<double, 6, 6>::Identity())
                         .ldlt()
                         .solve(slope.transpose() * error);
    q += step * std::min(1.0, 0.3 / step.cwiseAbs().maxCoeff());
  }
  return false;
}

// The arm hangs by what a weight at its tool does to joints 2 and 3: found by moving them.
Six hanging(const Arm& a, Six q, double rad_per_m) {
  const Six straight = q;
  for (const int j : {1, 2}) {
    Six up = straight, down = straight;
    up[j] += 1e-5, down[j] -= 1e-5;
    q[j] -= rad_per_m * (tool(a, up).translation().z() - tool(a, down).translation().z()) / 2e-5;
  }
  return q;
}

struct View {
  Six joints;
  std::array<double, 6> shaken{};  // how far the arm stands from where its model puts it: noise
  double time_s = 0, warmer = 0;   // K above the first
};

class RobotWorld final : public World {
 public:
  std::vector<EffectKind> effects() const override;
  void design(Random& random, const std::string& variant) override;
  Numbers base() const override { return Numbers(12, 0.0); }
  Numbers base_steps() const override {
    return {1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5};
  }
  Numbers simulate(const Numbers& base, const Sizes& sizes) const override;
  Numbers sigma(const Numbers& clean) const override {  // the poses' noise counted as if corners had it one by one
    return Numbers(clean.size(), std::hypot(corner_px, focal * std::hypot(noise_m_ / 0.5, noise_rad_)));
  }
  Numbers noisy(const Numbers& clean, Random& random) const override {
    Numbers values = clean;
    for (double& v : values) v += corner_px * random.normal();
    return values;
  }
  Numbers norm(const Numbers& observed) const override { return Numbers(observed.size(), 0.5); }
  bool relative() const override { return false; }
  bool asks_rivals() const override { return false; }
  bool knows_floor() const override { return false; }
  void write(const Numbers& observed, const Numbers& stated, Case& into) const override;

 private:
  Pose camera_from_board(const View& view, Six joints, const Numbers& base, const Sizes& sizes) const;
  std::vector<Six> stood(const Sizes& sizes) const;
  Pose tool_on_the_way(double time_s) const;
  bool moves_ = false;
  double phase_ = 0;
  std::vector<View> views_;
  Pose tool_from_camera_ = Pose::Identity(), base_from_board_ = Pose::Identity();
  double noise_m_ = 5e-5, noise_rad_ = 5e-5;
};

std::vector<EffectKind> RobotWorld::effects() const {
  const std::vector<std::string> joints{"robot.joint-2", "robot.joint-3", "robot.joint-4", "robot.joint-5"},
      arm{"robot.reach", "robot.joint-2", "robot.joint-3"},
      board{"camera.distance", "board.x", "board.y", "board.radius"}, pose{"pose"};
  std::vector<EffectKind> k;
  const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
  add({"joint zeros", "robot.joint-offset", pose, joints, 4e-4, 1.5e-3})
      .of_either_sign()
      .of_parts(4)
      .means({"joint_2_rad", "joint_3_rad", "joint_4_rad", "joint_5_rad"});
  add({"hanging arm", "robot.sag", pose, arm, 3e-4, 1.5e-3}).means({"joint_2_rad_per_m", "joint_3_rad_per_m"});
  add({"longer upper arm", "robot.link-length", pose, arm, 3e-4, 2e-3}).of_either_sign().means({"a_2_m"}, {-1});
  add({"larger board", "board.scale", {"board"}, board, 1e-3, 8e-3}).of_either_sign().means({"scale_x", "scale_y"});
  add({"play of the gears",
       "robot.backlash",
       pose,
       {"robot.approach-1", "robot.approach-2", "robot.approach-3", "robot.approach-4", "robot.approach-5"},
       2e-4,
       1e-3})
      .of_parts(4)
      .means({"backlash_2_rad", "backlash_3_rad", "backlash_4_rad", "backlash_5_rad"}, {-1, -1, -1, -1});
  add({"cold start", "robot.thermal", pose, {"robot.temperature", "robot.reach"}, 1e-5, 5e-5}).means({"growth_per_K"});
  add({"late poses", "robot.time-offset", pose, {"robot.speed"}, 2e-3, 3e-2})
      .of_either_sign()
      .means({"lag_s"})
      .only_for("in motion");
  add({"yielding table", "", pose, {"robot.joint-1"}, 5e-4, 2e-3});
  return k;
}

// Where the camera goes when it does not stop: tilted, turned and lifted by slow waves.
Pose RobotWorld::tool_on_the_way(double t) const {
  const Vector middle(0.5 * (columns - 1) * square, 0.5 * (rows - 1) * square, 0);
  const double tilt = 0.35 + 0.3 * std::sin(0.9 * t + phase_), around = 0.5 * t + phase_, roll = std::sin(0.7 * t);
  Pose from_camera = Pose::Identity();
  from_camera.rotate(Eigen::AngleAxisd(around, Vector::UnitZ())).rotate(Eigen::AngleAxisd(tilt, Vector::UnitX()));
  from_camera.rotate(Eigen::AngleAxisd(roll - around, Vector::UnitZ()));
  from_camera.translation() = middle - from_camera.linear() * Vector(0, 0, 0.5 + 0.12 * std::sin(1.1 * t));
  return base_from_board_ * from_camera * tool_from_camera_.inverse();
}

// The joints behind the gears. Those with play stand still until the motor has taken it up (the play operator of
// hysteresis); a moving arm has gone on by the time its pose is read.
std::vector<Six> RobotWorld::stood(const Sizes& sizes) const {
  const double late = size_of(sizes, "late poses");
  std::vector<Six> joints;
  for (const View& view : views_) {
    joints.push_back(view.joints);
    if (late != 0) reach(ur5e(0), tool_on_the_way(view.time_s + late), joints.back());
  }
  if (!sizes.contains("play of the gears")) return joints;
  Six driven = joints[0];
  for (std::size_t v = 0; v < joints.size(); ++v)
    for (std::size_t j = 0; j < 4; ++j) {
      const double half = 0.5 * size_of(sizes, "play of the gears", j);
      double& q = joints[v][static_cast<int>(j) + 1];
      double& stands = driven[static_cast<int>(j) + 1];
      q = stands = std::clamp(stands, q - half, q + half);
    }
  return joints;
}

// The pose in which an image was taken: zeros off, links longer or warmer, joints hanging, and the base tilting to
// where the arm points (outside the library).
Pose RobotWorld::camera_from_board(const View& view, Six q, const Numbers& base, const Sizes& sizes) const {
  for (std::size_t j = 0; j < 4; ++j) q[static_cast<int>(j) + 1] += size_of(sizes, "joint zeros", j);
  const Arm real = ur5e(size_of(sizes, "longer upper arm"), size_of(sizes, "cold start") * (view.warmer - 8));
  q = hanging(real, q, size_of(sizes, "hanging arm"));
  Pose stands = moved(tool(real, q), view.shaken.data());
  if (const double tilt = size_of(sizes, "yielding table"); tilt > 0) {
    const Vector at = stands.translation();
    stands = Eigen::AngleAxisd(tilt * std::sin(6 * q[0]), Vector(-at.y(), at.x(), 0).normalized()) * stands;
  }
  return (stands * moved(tool_from_camera_, base.data())).inverse() * moved(base_from_board_, &base[6]);
}

Numbers RobotWorld::simulate(const Numbers& base, const Sizes& sizes) const {
  Numbers pixels;
  const double larger = 1 + size_of(sizes, "larger board");
  const std::vector<Six> joints = stood(sizes);
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const Pose pose = camera_from_board(views_[v], joints[v], base, sizes);
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        const Vector p = pose * Vector(c * square * larger, r * square * larger, 0);
        pixels.push_back(640 + focal * p.x() / p.z());
        pixels.push_back(480 + focal * p.y() / p.z());
      }
  }
  return pixels;
}

void RobotWorld::design(Random& random, const std::string& variant) {
  moves_ = variant == "in motion";
  phase_ = random.uniform(0, 2 * pi);
  noise_m_ = random.uniform(3e-5, 1.5e-4);
  noise_rad_ = random.uniform(3e-5, 1.5e-4);
  tool_from_camera_.translate(Vector(0.03, -0.06, 0.05));
  tool_from_camera_.rotate(Eigen::AngleAxisd(0.4, Vector(0.1, 0.2, 1).normalized()));
  base_from_board_.translate(Vector(-0.55, 0.05, 0.02));
  base_from_board_.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;  // face up: z away from the viewer
  const Vector middle(0.5 * (columns - 1) * square, 0.5 * (rows - 1) * square, 0);
  const Arm nominal = ur5e(0);
  const std::size_t wanted = 30 + random.below(16);
  Six posture;
  posture << -0.3, -1.5, 1.4, -1.5, -1.57, 0.3;
  double clock = 0;
  for (int tries = 0; views_.size() < wanted && tries < 10000; ++tries) {
    clock += moves_ ? 0.25 : random.uniform(20, 40);
    const double tilt = random.uniform(0, 0.7), around = random.uniform(0, 2 * pi), roll = random.uniform(-1, 1);
    Pose from_camera = Pose::Identity();
    from_camera.rotate(Eigen::AngleAxisd(around, Vector::UnitZ())).rotate(Eigen::AngleAxisd(tilt, Vector::UnitX()));
    from_camera.rotate(Eigen::AngleAxisd(roll - around, Vector::UnitZ()));
    from_camera.translation() = middle - from_camera.linear() * Vector(0, 0, random.uniform(0.35, 0.7));
    View view{.joints = posture, .time_s = clock, .warmer = 16 * (1 - std::exp(-clock / 500))};
    const Pose goal = base_from_board_ * from_camera * tool_from_camera_.inverse();
    if (!reach(nominal, moves_ ? tool_on_the_way(clock) : goal, view.joints)) continue;
    for (std::size_t k = 0; k < 6; ++k) view.shaken[k] = (k < 3 ? noise_rad_ : noise_m_) * random.normal();
    views_.push_back(view);
  }
}

Value matrix_of(const Pose& p) {
  std::vector<double> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r.push_back(p.linear()(i, j));
  return pose(r, p.translation().x(), p.translation().y(), p.translation().z());
}

void RobotWorld::write(const Numbers& observed, const Numbers&, Case& into) const {
  Random random(into.spec.seed, 0x706f7365u);
  const auto nearly = [&](const Pose& p, double rad, double m) {
    std::array<double, 6> off{};
    for (std::size_t k = 0; k < 6; ++k) off[k] = (k < 3 ? rad : m) * random.normal();
    return matrix_of(moved(p, off.data()));
  };
  Value m = Value::object(), images = Value::array(), lines = Value::array();
  const Arm nominal = ur5e(0);
  std::size_t i = 0;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const std::string id = "view" + std::to_string(v);
    Value image = Value::object({{"id", id}, {"camera", "cam"}, {"board", "board"}, {"robot", "arm"}});
    image["base_from_tool"] = matrix_of(tool(nominal, views_[v].joints));
    image["joints_rad"] = Value(std::vector<double>(views_[v].joints.data(), views_[v].joints.data() + 6));
    image["camera_from_board"] = nearly(camera_from_board(views_[v], views_[v].joints, base(), {}), 1e-3, 1e-3);
    image["time_s"] = views_[v].time_s;
    if (!moves_) image["temperature_K"] = 294 + views_[v].warmer;
    images.push_back(image);
    for (int k = 0; k < rows * columns; ++k, i += 2)
      lines.push_back(Value(Value::Array{id, k, (k % columns) * square, (k / columns) * square, observed[i],
                                         observed[i + 1], corner_px}));
  }
  m["robots"]["arm"]["model"] = "ur5e";
  m["boards"]["board"] = Value::object(
      {{"kind", "checkerboard"}, {"inner_corners", Value(Value::Array{columns, rows})}, {"square_m", square}});
  m["cameras"]["cam"] = Value::object({{"model", "pinhole"},
                                       {"width_px", 1280},
                                       {"height_px", 960},
                                       {"fx_px", focal},
                                       {"fy_px", focal},
                                       {"cx_px", 640},
                                       {"cy_px", 480}});
  for (const char* p : {"fx_px", "fy_px", "cx_px", "cy_px"}) m["cameras"]["cam"]["sigma"][p] = 0.3;
  m["images"] = images;
  Value table = Value::object({{"model", "camera"}, {"camera", "cam"}, {"board", "board"}});
  for (const auto& [name, unit] : {std::pair{"image", ""},
                                   {"corner", "1"},
                                   {"board_x_m", "m"},
                                   {"board_y_m", "m"},
                                   {"u_px", "px"},
                                   {"v_px", "px"},
                                   {"sigma_px", "px"}})
    table["columns"][name] = unit;
  table["observed"] = std::vector<std::string>{"u_px", "v_px"};
  table["sigma"] = std::vector<std::string>{"sigma_px"};
  table["rows"] = lines;
  m["tables"]["corners"] = table;
  Value& hand = m["mountings"]["hand"];
  hand = Value::object({{"kind", "eye-in-hand"}, {"robot", "arm"}, {"camera", "cam"}, {"board", "board"}});
  hand["tool_from_camera"] = nearly(tool_from_camera_, 5e-3, 3e-3);
  hand["base_from_board"] = nearly(base_from_board_, 5e-3, 3e-3);
  finish(m, into);
}

}  // namespace

std::unique_ptr<World> robot_world() {
  return std::make_unique<RobotWorld>();
}

}  // namespace gonio::sealed
