// Model "temperature": what a joint's sensor of temperature says over time. The base model knows no heating: one level
// for each session, a stretch of rows without a long gap. The mechanisms are the drives of one warm body
// (robot/mechanisms/robot_warm_up.h): something that stays the same, the motor's current squared, the joint's speed.
// The body begins every session at the session's own level, since nothing is known of the gap before it, and heads for
// one target throughout. The drive is taken to change evenly between two rows. A task that repeats drives all three
// alike: then they are said not to be told apart.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/text.h"
#include "explain/tables/model_parameters.h"
#include "explain/tables/table_conditions.h"
#include "explain/tables/table_model.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"
#include "robot/mechanisms/robot_warm_up.h"
#include "stats/intervals.h"

namespace gonio::explain::tables {
namespace {

constexpr double gap_s = 60, gap_steps = 20;           // longer than both: a new session
constexpr std::size_t rate = 0, target = 1, rise = 2;  // places among a mechanism's parameters

// Of every row: 1, current^2, |speed|.
struct Drive {
  const mechanism::Mechanism& (*mechanism)();
  const char *column, *unit, *condition;
  double (*of)(double value);
};
constexpr std::array<Drive, 3> drives{{
    {mechanism::robot_warm_up, "", "", "", nullptr},
    {mechanism::robot_joule_heating, "current_A", "A", "robot.current", [](double v) { return v * v; }},
    {mechanism::robot_friction_heating, "speed", "rad/s", "robot.speed", [](double v) { return std::abs(v); }},
}};

class Temperature final : public BoundModel {
 public:
  Temperature(const manifest::Document& document, const std::string& name, const Table& table)
      : name_(name), time_(table.needed("time_s", "s")), order_(time_.size()), session_(time_.size(), 0) {
    if (table.observed.size() != 1)
      throw Error(Exit::data, table.place + "/observed", "names " + std::to_string(table.observed.size()) + " columns",
                  "model temperature predicts one: a table for each joint");
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::ranges::stable_sort(order_, {}, [this](std::size_t r) { return time_[r]; });
    find_sessions();
    add_levels(document.tables.at(name), table);
    for (const Drive& drive : drives) add_heating(drive, table);
    add_condition("robot.time", "s", time_);
    for (const Drive& drive : drives)
      if (const std::size_t c = table.place_of(drive.column); c != Table::none && table.varies(drive.column))
        add_condition(drive.condition, drive.unit, table.values[c]);
  }

  void predict(std::span<const double> values, std::size_t first, std::size_t last,
               std::span<double> prediction) const override {
    for (std::size_t r = first; r < last; ++r) prediction[r - first] = values[session_[r]];
    for (const Heating& heating : heatings_) {
      if (values[heating.first + rate] == 0) continue;
      const std::vector<double> body = temperatures(heating, values);
      for (std::size_t r = first; r < last; ++r) prediction[r - first] += body[r] - values[session_[r]];
    }
  }
  std::vector<double> norm() const override { return std::vector<double>(time_.size(), 1.0); }
  std::size_t blocks_a_group() const override { return 4; }

  void apply(std::span<const double> values, std::span<const double> sigma,
             manifest::Document& document) const override {
    for (const std::size_t p : base_)
      store_parameter(document.tables.at(name_), parameters_[p].name.substr(parameters_[p].name.rfind('/') + 1),
                      values[p], sigma[p]);
  }

  // What it means for the arm, by the growth that robot.thermal is usual with.
  std::string remarks(std::span<const std::string> named, std::span<const double> values,
                      std::span<const double> sigma) const override {
    for (const Heating& heating : heatings_) {
      if (std::ranges::find(named, heating.mechanism->id) == named.end()) continue;
      const double per_s = values[heating.first + rate], sigma_per_s = sigma[heating.first + rate];
      const std::vector<double> body = temperatures(heating, values);
      const double warmer = *std::ranges::max_element(body) - body[order_.front()];
      return format(
          "Its time constant is %.3g +- %.2g min, and it was %.3g K warmer at most than at the beginning: links "
          "between joints that warm alike grow by %.2g to %.2g mm per metre (10 to 25 ppm/K, robot.thermal).",
          1 / per_s / 60, sigma_per_s / (per_s * per_s) / 60, warmer, 1e-2 * warmer, 2.5e-2 * warmer);
    }
    return {};
  }

 private:
  struct Heating {
    const mechanism::Mechanism* mechanism;
    std::size_t first;          // of its parameters among the model's
    std::vector<double> drive;  // by row; empty: none but the target itself
  };

  void find_sessions() {
    std::vector<double> steps;
    for (std::size_t k = 1; k < order_.size(); ++k) steps.push_back(time_[order_[k]] - time_[order_[k - 1]]);
    const double longest_s = std::max(gap_s, gap_steps * stats::median(steps));
    for (std::size_t k = 1; k < order_.size(); ++k)
      session_[order_[k]] = session_[order_[k - 1]] + (steps[k - 1] > longest_s ? 1 : 0);
  }

  void add_levels(const manifest::Table& section, const Table& table) {
    const std::vector<double>& y = table.values[table.observed[0]];
    for (std::size_t s = 0; s <= session_[order_.back()]; ++s) {
      std::vector<double> own;
      for (std::size_t r = 0; r < y.size(); ++r)
        if (session_[r] == s) own.push_back(y[r]);
      const std::string label = s == 0 ? "level_K" : "level_" + std::to_string(s + 1) + "_K";
      ModelParameter level = model_parameter(section, name_, label, "K", stats::median(own), true);
      level.parameter.size = 1;
      for (std::size_t g = 0; g < table.group.size(); ++g)
        for (std::size_t r = table.first[g]; r < table.first[g + 1]; ++r)
          if (session_[r] == s && (level.parameter.groups.empty() || level.parameter.groups.back() != g))
            level.parameter.groups.push_back(g);
      if (level.parameter.groups.size() == table.group.size()) level.parameter.groups.clear();
      if (level.free) base_.push_back(parameters_.size());
      parameters_.push_back(std::move(level.parameter));
    }
  }

  void add_heating(const Drive& drive, const Table& table) {
    Heating heating{&drive.mechanism(), parameters_.size(), {}};
    if (drive.of != nullptr) {
      if (!table.varies(drive.column)) return;
      const std::vector<double>& given = table.needed(drive.column, drive.unit);
      for (const double v : given) heating.drive.push_back(drive.of(v));
    }
    // What is driven holds the one that stays the same within it: its drive at the mean.
    Candidate candidate{heating.mechanism, {}, {}, "", !heating.drive.empty()};
    for (const mechanism::Parameter& p : heating.mechanism->parameters) {
      candidate.parameters.push_back(parameters_.size());
      Parameter own;
      own.name = heating.mechanism->id + "." + p.name;
      own.unit = p.unit;
      own.start = p.start, own.neutral = p.neutral, own.lower = p.lower, own.upper = p.upper;
      own.size = 0.1 * p.start;
      parameters_.push_back(std::move(own));
    }
    // The search begins with a time constant of a quarter of the recording, and ends a little above what was seen.
    const auto [least, most] = std::ranges::minmax_element(table.values[table.observed[0]]);
    const double range = std::max(*most - *least, 1e-3);
    const auto begin = [&](std::size_t k, double start, double size) {
      Parameter& p = parameters_[heating.first + k];
      p.start = std::clamp(start, p.lower + 1e-3 * (p.upper - p.lower) * (k != rate), p.upper);
      p.size = size;
    };
    begin(rate, 4 / longest_session(), 0.4 / longest_session());
    begin(target, heating.drive.empty() ? *most + 0.2 * range : *least, range);
    parameters_[heating.first + target].neutral = parameters_[heating.first + target].start;
    if (!heating.drive.empty()) {
      const double held = 1.2 * range / stats::mean(heating.drive);
      begin(rise, held, 0.1 * held);
    }
    candidates_.push_back(std::move(candidate));
    heatings_.push_back(std::move(heating));
  }

  double longest_session() const {
    double longest = 0;
    for (std::size_t k = 0, begin = 0; k < order_.size(); ++k) {
      if (session_[order_[k]] != session_[order_[begin]]) begin = k;
      longest = std::max(longest, time_[order_[k]] - time_[order_[begin]]);
    }
    return longest;
  }

  void add_condition(const std::string& name, const std::string& unit, const std::vector<double>& values) {
    Condition condition;
    condition.name = name, condition.unit = unit, condition.stage = "pose", condition.values = values;
    conditions_.push_back(std::move(condition));
  }

  // By row: from the session's level, towards the target.
  std::vector<double> temperatures(const Heating& heating, std::span<const double> values) const {
    std::vector<double> body(time_.size());
    const double* own = values.data() + heating.first;
    for (std::size_t k = 0; k < order_.size(); ++k) {
      const std::size_t now = order_[k];
      body[now] = values[session_[now]];
      if (k == 0 || session_[order_[k - 1]] != session_[now]) continue;
      const std::size_t before = order_[k - 1];
      const double held = heating.drive.empty() ? 0 : own[rise] * 0.5 * (heating.drive[before] + heating.drive[now]);
      body[now] =
          equation::first_order_heating(body[before], own[target] + held, own[rate], time_[now] - time_[before]);
    }
    return body;
  }

  std::string name_;
  std::vector<double> time_;
  std::vector<std::size_t> order_, session_;  // rows by time; the session of each row
  std::vector<Heating> heatings_;
};

}  // namespace

const Model& temperature() {
  static const Model model{.name = "temperature",
                           .sentence = "Temperature of a joint over time: a level, and what heats it.",
                           .columns = {{"time_s", "s", "when"},
                                       {"current_A", "A", "of the joint's motor, root mean square of a row", false},
                                       {"speed", "rad/s", "of the joint, mean modulus of a row", false}},
                           .score_name = "RMSE",
                           .unit = "K",
                           .group_noun = "period",
                           .importance = Importance::share_of_residual,
                           .reads_light = false,
                           .bind = bind_as<Temperature>};
  return model;
}

}  // namespace gonio::explain::tables
