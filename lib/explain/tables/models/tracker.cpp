// Model "tracker": where a point of a machine is, as a laser tracker or a total station measures it, from where the
// machine's controller says that it is. The base model is the machine's placement: one rigid motion for the whole
// table, or one for each of the places that the column `placement` names (a station of a mobile robot, a height of its
// column), since a placement that was fitted hides whatever is the same throughout it.
//   robot.axis-scale, robot.squareness  errors of the axes
//   robot.compliance   what carries the arm yields: the floor and, where its height varies from row to row, the column
//   robot.thermal      the machine grows with time, or with its temperature
//
// Frames: nominal in the machine's base, z up; observed in the tracker's (explain/tables/placement.h). Metres, radians.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "explain/tables/model_parameters.h"
#include "explain/tables/placement.h"
#include "explain/tables/table_model.h"
#include "geom/rigid.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"
#include "robot/mechanisms/robot_axes.h"
#include "robot/mechanisms/robot_compliance.h"

namespace gonio::mechanism {
const Mechanism& robot_thermal();
}

namespace gonio::explain::tables {
namespace {

using Values = std::span<const double>;
constexpr std::size_t fewest_points = 4;

class Tracker final : public BoundModel {
 public:
  Tracker(const manifest::Document& document, const std::string& name, const Table& table) : name_(name) {
    check_places_observed(table, "tracker");
    read_points(table);
    declare_foot(document.tables.at(name));
    declare_placements(table);
    scale_ = declare(mechanism::robot_axis_scale());
    squareness_ = declare(mechanism::robot_squareness());
    propose(mechanism::robot_axis_scale(), {scale_, scale_ + 1, scale_ + 2});
    propose(mechanism::robot_squareness(), {squareness_, squareness_ + 1, squareness_ + 2});
    declare_yielding();
    declare_growth(table);
    declare_conditions();
  }

  void predict(Values values, std::size_t first, std::size_t last, std::span<double> prediction) const override {
    for (std::size_t r = first; r < last; ++r) {
      const Vec3 seen = seen_at(values, r);
      for (int axis = 0; axis < 3; ++axis) prediction[3 * (r - first) + static_cast<std::size_t>(axis)] = seen[axis];
    }
  }
  // A third of a square for each of three coordinates: the score is the RMS distance, in metres.
  std::vector<double> norm() const override { return std::vector<double>(3 * rows_.size(), 1.0 / 3); }

  void apply(Values values, Values sigma, manifest::Document& document) const override {
    for (std::size_t p = foot_; p < foot_ + 3; ++p) {
      const std::string& full = parameters_[p].name;
      if (sigma[p] > 0)
        store_parameter(document.tables.at(name_), full.substr(full.rfind('/') + 1), values[p], sigma[p]);
    }
  }

 private:
  struct Row {
    Vec3 nominal_m, load_m;
    double height_m = 0;
    double warmer_K = 0, later_s = 0;
    std::size_t placement = 0;
  };
  void read_points(const Table& table) {
    rows_.resize(table.rows());
    const std::vector<double>&x = table.needed("nominal_x_m", "m"), &y = table.needed("nominal_y_m", "m"),
          &z = table.needed("nominal_z_m", "m");
    const auto given = [&](const char* column, const char* unit) -> const std::vector<double>* {
      return table.find(column) == nullptr ? nullptr : &table.needed(column, unit);
    };
    const auto *load_x = given("load_x_m", "m"), *load_y = given("load_y_m", "m"), *height = given("height_m", "m");
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      Row& row = rows_[r];
      row.nominal_m = {x[r], y[r], z[r]};
      row.load_m = {load_x ? (*load_x)[r] : x[r], load_y ? (*load_y)[r] : y[r], 0};
      row.height_m = height ? (*height)[r] : 0;
    }
    observed_ = observed_places(table);
    rises_ = table.varies("height_m");
  }

  void declare_foot(const manifest::Table& section) {
    for (const char* axis : {"foot_x_m", "foot_y_m", "foot_z_m"}) {
      ModelParameter p = model_parameter(section, name_, axis, "m", 0, false);
      p.parameter.size = 0.01;
      if (p.free) base_.push_back(parameters_.size());
      parameters_.push_back(std::move(p.parameter));
    }
  }

  void declare_placements(const Table& table) {
    const RowsByName by_placement = rows_by_name(table, "placement");
    for (const std::string& name : by_placement.names) placements_.push_back({name, {}, {}});
    for (std::size_t r = 0; r < rows_.size(); ++r) rows_[r].placement = by_placement.of_row[r];
    for (std::size_t k = 0; k < placements_.size(); ++k) start(placements_[k], k, table);
  }

  void start(Placement& placement, std::size_t k, const Table& table) {
    std::vector<Vec3> from, to;
    std::vector<std::size_t> groups;
    for (std::size_t g = 0; g < table.group.size(); ++g)
      for (std::size_t r = table.first[g]; r < table.first[g + 1]; ++r) {
        if (rows_[r].placement != k) continue;
        from.push_back(rows_[r].nominal_m), to.push_back(observed_[r]);
        if (groups.empty() || groups.back() != g) groups.push_back(g);
      }
    if (from.size() < fewest_points)
      throw Error(Exit::data, table.place,
                  "has " + std::to_string(from.size()) + " rows of the placement \"" + placement.name + "\"",
                  "a placement is six numbers: measure at least " + std::to_string(fewest_points) + " points of each");
    start_from(placement, from, to);
    if (groups.size() == table.group.size()) groups.clear();
    declare_placement(placement, "tables/" + name_ + "/" + (placements_.size() > 1 ? placement.name + "/" : ""), groups,
                      parameters_, base_);
  }

  // The place of the first of its numbers.
  std::size_t declare(const mechanism::Mechanism& m) {
    const std::size_t first = parameters_.size();
    for (const mechanism::Parameter& p : m.parameters)
      parameters_.push_back({m.id + "." + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, p.typical, {}, {}});
    return first;
  }
  void propose(const mechanism::Mechanism& m, std::vector<std::size_t> places) {
    candidates_.push_back({&m, {}, std::move(places), m.id});
  }

  void declare_yielding() {
    yielding_ = declare(mechanism::robot_compliance());
    std::vector<std::size_t> places = {yielding_, yielding_ + 1};
    // A column that stays as high as it is bends as the floor yields.
    if (rises_) places.insert(places.end(), {yielding_ + 2, yielding_ + 3});
    propose(mechanism::robot_compliance(), std::move(places));
  }

  void declare_growth(const Table& table) {
    const mechanism::Mechanism& m = mechanism::robot_thermal();
    growth_ = declare(m);
    const auto departures = [&](const char* column, const char* unit, double Row::*place) {
      if (!table.varies(column)) return false;
      const std::vector<double>& given = table.needed(column, unit);
      const double mean = std::accumulate(given.begin(), given.end(), 0.0) / static_cast<double>(given.size());
      for (std::size_t r = 0; r < rows_.size(); ++r) rows_[r].*place = given[r] - mean;
      return true;
    };
    warms_ = departures("temperature_K", "K", &Row::warmer_K);
    if (warms_) propose(m, {growth_});
    lasts_ = departures("time_s", "s", &Row::later_s);
    if (lasts_) propose(m, {growth_ + 1});
  }

  // Each is a curve in metres along a direction of the machine, as the tracker sees it.
  void declare_conditions() {
    Condition reach{"robot.reach", "m", "pose", {}, {}, "m"};
    std::array<Condition, 3> axes{Condition{"robot.x", "m", "pose", {}, {}, "m"},
                                  {"robot.y", "m", "pose", {}, {}, "m"},
                                  {"robot.z", "m", "pose", {}, {}, "m"}};
    const auto append = [](Condition& c, double value, Vec3 direction) {
      c.values.push_back(value);
      c.direction.insert(c.direction.end(), {direction.x, direction.y, direction.z});
    };
    const Vec3 foot{parameters_[foot_].start, parameters_[foot_ + 1].start, 0};
    constexpr std::array<Vec3, 3> along{Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (const Row& row : rows_) {
      const auto& seen = placements_[row.placement].start;
      const Vec3 lever = row.load_m - foot;
      const double length = std::hypot(lever.x, lever.y);
      append(reach, length, length > 0 ? seen.rotate({lever.x / length, lever.y / length, 0}) : Vec3{});
      for (std::size_t axis = 0; axis < 3; ++axis)
        append(axes[axis], row.nominal_m[static_cast<int>(axis)], seen.rotate(along[axis]));
    }
    conditions_ = {std::move(reach), std::move(axes[0]), std::move(axes[1]), std::move(axes[2])};
    const auto scalar = [&](bool there, const char* name, const char* unit, double Row::*place) {
      if (!there) return;
      Condition c{name, unit, "pose", {}, {}, "m"};
      for (const Row& row : rows_) {
        const double length = gonio::norm(row.nominal_m);
        const Vec3 outwards = length > 0 ? row.nominal_m / length : Vec3{};
        append(c, row.*place, placements_[row.placement].start.rotate(outwards));
      }
      conditions_.push_back(std::move(c));
    };
    scalar(warms_, "robot.temperature", "K", &Row::warmer_K);
    scalar(lasts_, "robot.time", "s", &Row::later_s);
  }

  Vec3 seen_at(Values values, std::size_t r) const {
    const Row& row = rows_[r];
    const Vec3 foot{values[foot_], values[foot_ + 1], values[foot_ + 2]};
    const double* share = &values[scale_];
    const double* angle = &values[squareness_];
    Vec3 p = equation::robot_axis_scale(row.nominal_m, {share[0], share[1], share[2]});
    p = equation::robot_squareness(p, angle[0], angle[1], angle[2]);
    p *= 1 + values[growth_] * row.warmer_K + values[growth_ + 1] * row.later_s;
    const double* y = &values[yielding_];
    p += equation::robot_compliance(p, foot, row.load_m, row.height_m, {y[0], y[1], y[2], y[3]});
    return placements_[row.placement].seen(values, p);
  }

  std::string name_;
  std::vector<Row> rows_;
  std::vector<Vec3> observed_;
  std::vector<Placement> placements_;
  std::size_t foot_ = 0, scale_ = 0, squareness_ = 0, yielding_ = 0, growth_ = 0;  // first of their parameters
  bool rises_ = false, warms_ = false, lasts_ = false;
};

}  // namespace

const Model& tracker() {
  static const Model model{
      .name = "tracker",
      .sentence = "Where a point of a machine is, as a laser tracker sees it, from where its controller says it is.",
      .columns = {{"nominal_x_m", "m", "where the controller says the point is, in the machine's base, z up"},
                  {"nominal_y_m", "m", "likewise"},
                  {"nominal_z_m", "m", "likewise"},
                  {"load_x_m", "m", "where the arm's centre of mass is; left out: at the point", false},
                  {"load_y_m", "m", "likewise", false},
                  {"height_m", "m", "of the column under the arm, above its foot", false},
                  {"placement", "", "rows with the same were measured from one place of the machine", false},
                  {"temperature_K", "K", "of the machine", false},
                  {"time_s", "s", "when the row was measured", false}},
      .score_name = "RMS error of place",
      .unit = "m",
      .group_noun = "station",
      .group = "placement",
      .importance = Importance::share_of_residual,
      .reads_light = false,
      .bind = bind_as<Tracker>};
  return model;
}

}  // namespace gonio::explain::tables
