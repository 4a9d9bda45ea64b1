// Model "arm": where points on a serial arm's flange are, as a laser tracker or a total station measures them, from
// what the encoders of its joints say:
//   seen = placement * flange(links, joints) * point
// The base model is where the arm stands and where each point sits on the flange: six numbers and three for a point.
//   robot.joint-offset   the joints' zeros are off
//   robot.link-length    links are longer or shorter than nominal
//   robot.sag            joints 2 and 3 yield under the weight they carry
// each by the chain of robot/chain/chain.h. Numbers that do the same to all rows as the base model or as one another
// (the zero of the first joint turns the placement, that of the last the points) are left out, and the remarks say so.
//
// Frames: observed in the tracker's; points in the flange's. Metres, radians. The arm is the manifest's, in the sense
// of robot/kinematics.h; joints are angles between neighbouring links (a controller that states joint 3 against the
// ground states joint 2 + joint 3).
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/text.h"
#include "explain/tables/placement.h"
#include "explain/tables/table_model.h"
#include "inference/wording.h"
#include "manifest/document.h"
#include "manifest/sections/robot.h"
#include "robot/chain/role.h"
#include "robot/kinematics.h"
#include "robot/ur_calibration.h"
#include "stats/intervals.h"

namespace gonio::mechanism {
const Mechanism& robot_joint_offset();
const Mechanism& robot_link_length();
const Mechanism& robot_sag();
}  // namespace gonio::mechanism

namespace gonio::explain::tables {
namespace {

using Values = std::span<const double>;
constexpr std::size_t none = Table::none;
constexpr double same = 1e-6;         // of a column: what is left of it beyond others is rounding
constexpr double turned = 1e-3;       // rad
constexpr double on_the_axis = 0.02;  // of the largest lever arm about a joint: a point there does not see it turn
constexpr int most_rounds = 2000;
constexpr double at_rest_m = 1e-9;

double squares(const std::vector<double>& v) {
  return std::inner_product(v.begin(), v.end(), v.begin(), 0.0);
}

// What directions in a space of observations have in common: Gram and Schmidt, twice, which is as good as QR.
class Span {
 public:
  std::vector<double> beyond(std::vector<double> v) const {
    for (int pass = 0; pass < 2; ++pass)
      for (const std::vector<double>& unit : units_) {
        const double along = std::inner_product(v.begin(), v.end(), unit.begin(), 0.0);
        for (std::size_t i = 0; i < v.size(); ++i) v[i] -= along * unit[i];
      }
    return v;
  }
  // False where v lies in it already.
  bool add(const std::vector<double>& v) {
    std::vector<double> rest = beyond(v);
    const double length = std::sqrt(squares(rest));
    if (!(length > same * std::sqrt(squares(v)))) return false;
    for (double& x : rest) x /= length;
    units_.push_back(std::move(rest));
    return true;
  }

 private:
  std::vector<std::vector<double>> units_;
};

// "1", "1 and 6", "1, 4 and 6"
std::string listed(const std::vector<std::string>& all) {
  std::string text;
  for (std::size_t i = 0; i < all.size(); ++i) text += (i == 0 ? "" : i + 1 == all.size() ? " and " : ", ") + all[i];
  return text;
}

class ArmInTable final : public BoundModel {
 public:
  ArmInTable(const manifest::Document& document, const std::string& name, const Table& table)
      : prefix_("tables/" + name + "/") {
    check_places_observed(table, "arm");
    arm_ = arm_of_table(document, table);
    read_joints(table);
    read_points(table);
    observed_ = observed_places(table);
    start();
    declare_base(table);
    for (const auto* m : {&mechanism::robot_joint_offset(), &mechanism::robot_link_length(), &mechanism::robot_sag()})
      propose(*m);
    declare_conditions();
    find_points_on_axes();
  }

  void predict(Values values, std::size_t first, std::size_t last, std::span<double> prediction) const override {
    for (std::size_t r = first; r < last; ++r) {
      const Vec3 seen = seen_at(values, r);
      for (int axis = 0; axis < 3; ++axis) prediction[3 * (r - first) + static_cast<std::size_t>(axis)] = seen[axis];
    }
  }
  // A third of a square for each of three coordinates: the score is the RMS distance, in metres.
  std::vector<double> norm() const override { return std::vector<double>(3 * rows_.size(), 1.0 / 3); }
  std::size_t blocks_a_group() const override { return 1; }  // points at one pose share what the arm does there
  void apply(Values, Values, manifest::Document&) const override {}
  std::string remarks(std::span<const std::string>, Values, Values) const override {
    std::string text;
    if (!untold_.empty())
      text =
          "Left nominal, since these rows cannot tell them from where the arm stands, where its points sit or other " +
          ("numbers: " + untold_) + ".";
    for (const std::string& sentence : on_axes_) text += (text.empty() ? "" : " ") + sentence;
    return text;
  }

 private:
  struct Row {
    std::vector<double> joints_rad;
    std::size_t point = 0;
  };
  struct Role {
    std::size_t parameter;
    robot::ChainRole role;
  };

  static robot::Arm arm_of_table(const manifest::Document& document, const Table& table) {
    if (const std::size_t column = table.place_of("robot"); column != none) {
      const std::vector<std::string>& names = table.labels[column];
      if (names.size() != 1)
        throw Error(Exit::data, table.place + "/columns/robot", "names no arm, or several", "one table for each arm");
      return document.robots.contains(names[0]) ? robot::arm_of(document, names[0])
                                                : robot::known_arm(names[0], table.place + "/columns/robot");
    }
    if (document.robots.size() == 1) return robot::arm_of(document, document.robots.begin()->first);
    throw Error(Exit::data, table.place, "does not say which arm it is of",
                "one entry in the manifest's robots, or a column robot with its name or that of a known arm");
  }

  void read_joints(const Table& table) {
    rows_.resize(table.rows());
    for (std::size_t j = 0; j < arm_.links.size(); ++j) {
      const std::vector<double>& angle = table.needed(format("joint_%zu_rad", j + 1), "rad");
      for (std::size_t r = 0; r < rows_.size(); ++r) rows_[r].joints_rad.push_back(angle[r]);
      const auto [least, most] = std::ranges::minmax(angle);
      turns_.push_back(most > least);
    }
    if (arm_.links.size() > 6)
      throw Error(Exit::data, table.place, format("is of an arm of %zu joints", arm_.links.size()), "at most 6");
  }

  void read_points(const Table& table) {
    RowsByName by_point = rows_by_name(table, "point");
    points_ = std::move(by_point.names);
    for (std::size_t r = 0; r < rows_.size(); ++r) rows_[r].point = by_point.of_row[r];
  }

  Rigid<frame::Base, frame::Tool> nominal(const Row& row) const { return robot::flange(arm_.links, row.joints_rad); }

  // Placement and points in turn, each the best for the other.
  void start() {
    on_flange_m_.assign(points_.size(), {});
    std::vector<Rigid<frame::Base, frame::Tool>> flanges;
    for (const Row& row : rows_) flanges.push_back(nominal(row));
    std::vector<Vec3> in_base(rows_.size());
    for (int round = 0; round < most_rounds; ++round) {
      for (std::size_t r = 0; r < rows_.size(); ++r) in_base[r] = flanges[r] * on_flange_m_[rows_[r].point];
      start_from(placement_, in_base, observed_);
      std::vector<Vec3> mean(points_.size());
      std::vector<double> count(points_.size());
      for (std::size_t r = 0; r < rows_.size(); ++r) {
        mean[rows_[r].point] += inverse(flanges[r]) * (inverse(placement_.start) * observed_[r]);
        ++count[rows_[r].point];
      }
      double moved = 0;
      for (std::size_t p = 0; p < points_.size(); ++p) {
        const Vec3 now = mean[p] / count[p];
        moved = std::max(moved, gonio::norm(now - on_flange_m_[p]));
        on_flange_m_[p] = now;
      }
      if (moved < at_rest_m) break;
    }
  }

  void declare_base(const Table& table) {
    declare_placement(placement_, prefix_, {}, parameters_, base_);
    first_point_ = parameters_.size();
    for (std::size_t p = 0; p < points_.size(); ++p)
      for (int axis = 0; axis < 3; ++axis) {
        Parameter number;
        number.name = prefix_ + "point " + points_[p] + "/" + "xyz"[axis] + "_m";
        number.unit = "m", number.size = 1e-3, number.start = number.neutral = on_flange_m_[p][axis];
        base_.push_back(parameters_.size());
        parameters_.push_back(std::move(number));
      }
    for (const std::size_t p : base_)
      if (!base_span_.add(slope(p)))
        throw Error(Exit::data, table.place, "cannot tell where the arm stands from where the points sit on its flange",
                    "turn at least three joints, among them those of the wrist, each by tens of degrees");
  }

  void propose(const mechanism::Mechanism& m) {
    Candidate candidate{&m, {}, {}, m.id};
    std::vector<std::string> untold;
    Span span = base_span_;
    for (const mechanism::Parameter& p : m.parameters) {
      const auto role = robot::role_of(p.name);
      if (!role || role->index + (role->part == robot::ChainRole::Part::sag ? 1 : 0) >= arm_.links.size()) continue;
      parameters_.push_back({m.id + "." + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, p.typical, {}, {}});
      roles_.push_back({parameters_.size() - 1, *role});
      if (span.add(slope(parameters_.size() - 1))) {
        candidate.parameters.push_back(parameters_.size() - 1);
      } else {
        untold.push_back(p.name);
        roles_.pop_back(), parameters_.pop_back();
      }
    }
    if (!untold.empty()) untold_ += (untold_.empty() ? "" : "; ") + listed(untold) + " of " + m.id;
    if (!candidate.parameters.empty()) candidates_.push_back(std::move(candidate));
  }

  // Derivative of all rows by a parameter, where the base model starts.
  std::vector<double> slope(std::size_t parameter) const {
    std::vector<double> values, up(3 * rows_.size()), down(up.size());
    for (const Parameter& p : parameters_) values.push_back(p.start);
    const double middle = values[parameter], step = 1e-2 * parameters_[parameter].size;
    values[parameter] = middle + step;
    predict(values, 0, rows_.size(), up);
    values[parameter] = middle - step;
    predict(values, 0, rows_.size(), down);
    for (std::size_t i = 0; i < up.size(); ++i) up[i] = (up[i] - down[i]) / (2 * step);
    return up;
  }

  // A drop of the point (reach), and a turn of what a joint carries.
  void declare_conditions() {
    Condition reach{"robot.reach", "m", "pose", {}, {}, "m"};
    const auto append = [](Condition& c, double value, Vec3 direction) {
      c.values.push_back(value);
      c.direction.insert(c.direction.end(), {direction.x, direction.y, direction.z});
    };
    for (const Row& row : rows_) {
      const Vec3 at = nominal(row) * on_flange_m_[row.point];
      append(reach, std::hypot(at.x, at.y), placement_.start.rotate({0, 0, -1}));
    }
    conditions_.push_back(std::move(reach));
    for (std::size_t j = 0; j < arm_.links.size(); ++j) {
      if (!turns_[j]) continue;
      Condition joint{format("robot.joint-%zu", j + 1), "rad", "pose", {}, {}, "rad"};
      for (const Row& row : rows_) append(joint, row.joints_rad[j], placement_.start.rotate(swept(row, j)));
      conditions_.push_back(std::move(joint));
    }
  }

  // How a row's point moves with a joint, in the base, per radian.
  Vec3 swept(const Row& row, std::size_t joint) const {
    const robot::Motion m = robot::joint_motions(arm_.links, row.joints_rad)[joint];
    return m.shift_m + cross(m.turn_rad, nominal(row).rotate(on_flange_m_[row.point]));
  }

  // Points that stayed on a joint's axis wherever that joint was turned from where it is for most rows.
  void find_points_on_axes() {
    std::vector<std::vector<std::string>> blind(points_.size());
    std::vector<double> farthest(points_.size());
    for (std::size_t j = 0; j < arm_.links.size(); ++j) {
      if (!turns_[j]) continue;
      std::vector<double> angles;
      for (const Row& row : rows_) angles.push_back(row.joints_rad[j]);
      const double usual = stats::median(angles);
      std::vector<double> lever(points_.size());
      for (const Row& row : rows_)
        if (std::abs(row.joints_rad[j] - usual) > turned)
          lever[row.point] = std::max(lever[row.point], gonio::norm(swept(row, j)));
      for (std::size_t p = 0; p < points_.size(); ++p) {
        if (lever[p] > on_the_axis * std::ranges::max(lever)) continue;
        blind[p].push_back(std::to_string(j + 1));
        farthest[p] = std::max(farthest[p], lever[p]);
      }
    }
    for (std::size_t p = 0; p < points_.size(); ++p)
      if (!blind[p].empty())
        on_axes_.push_back("Point " + points_[p] + " lies within " + inference::quantity(farthest[p], "m", 2) +
                           " of the " + (blind[p].size() == 1 ? "axis of joint " : "axes of joints ") +
                           listed(blind[p]) + ": it hardly sees " + (blind[p].size() == 1 ? "it" : "them") + " turn.");
  }

  Vec3 seen_at(Values values, std::size_t r) const {
    const Row& row = rows_[r];
    robot::ChainState state;
    for (const Role& role : roles_) robot::set(state, role.role, values[role.parameter]);
    const double* p = &values[first_point_ + 3 * row.point];
    return placement_.seen(values,
                           robot::corrected_flange(arm_.links, row.joints_rad, {}, state) * Vec3{p[0], p[1], p[2]});
  }

  std::string prefix_;
  robot::Arm arm_;
  std::vector<Row> rows_;
  std::vector<bool> turns_;  // joints that do
  std::vector<std::string> points_;
  std::vector<Vec3> on_flange_m_, observed_;
  Placement placement_;
  std::size_t first_point_ = 0;  // of its parameters
  std::vector<Role> roles_;
  Span base_span_;
  std::string untold_;                // numbers, mechanism by mechanism
  std::vector<std::string> on_axes_;  // sentences
};

}  // namespace

const Model& arm() {
  static const Model model{
      .name = "arm",
      .sentence = "Where points on a serial arm's flange are, as a laser tracker sees them, from its joints' angles.",
      .columns = {{"joint_1_rad", "rad",
                   "of every joint of the arm: joint_2_rad and so on, between neighbouring links"},
                  {"point", "", "which of the points on the flange it is; left out: there is one", false},
                  {"robot", "", "the arm: the manifest's, or one known by name; left out: the manifest's only one",
                   false},
                  {"pose", "", "rows with the same are points seen from one pose of the arm", false}},
      .score_name = "RMS error of place",
      .unit = "m",
      .group_noun = "pose",
      .group = "pose",
      .importance = Importance::share_of_residual,
      .reads_light = false,
      .bind = bind_as<ArmInTable>};
  return model;
}

}  // namespace gonio::explain::tables
