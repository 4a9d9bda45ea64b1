// See prints_problem.h.
#include "explain/prints/prints_problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "explain/prints/ground.h"
#include "explain/prints/map_readings.h"
#include "explain/prints/print_memo.h"
#include "explain/prints/print_term.h"
#include "explain/prints/prints_outcome.h"
#include "explain/prints/sight.h"
#include "explain/prints/simulation.h"
#include "inference/explanation.h"
#include "print/mechanisms/print_growth.h"
#include "print/mechanisms/print_shrinkage.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

using namespace prints;

constexpr double um = 1e6, infinity = std::numeric_limits<double>::infinity();
constexpr double place_sigma_px = 0.3, most_place_px = 3;
constexpr double usual_resolution_px = 0.2, resolution_sigma_px = 0.15, coarsest_px = 1;
constexpr double tilt_sigma = 0.1, white_sigma = 0.003, usual_spread_px = 0.05, most_spread_px = 0.25;
constexpr double step_of_spread = 0.4;  // of differences, of a parameter's size; physics: Term::step
constexpr double level_of_ground = 1e-3, lengths_of_a_block = 4;
constexpr std::size_t kept_predictions = 64, kept_slopes = 256, kept_map_slopes = 16;

class PrintsProblem final : public Problem {
 public:
  explicit PrintsProblem(PrintsInput input)
      : input_(std::move(input)), readings_(readings_of(input_)), simulation_(input_.sent) {
    layer_um_ = um * input_.sent.printer.layer_m;
    listen();
    map_parameters();
    print_parameters();
    physics_ = parameters_.size();
    for (const Term* term : all_terms()) enter(*term);
    observe();
    look();
  }

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    const auto all = predicted_.at({values.begin(), values.end()}, [&] { return predicted(values); });
    const auto first = all->begin() + static_cast<std::ptrdiff_t>(observations_.first[group]);
    std::copy_n(first, prediction.size(), prediction.begin());
  }
  void jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                std::span<double> derivatives) const override {
    const std::size_t first = observations_.first[group], rows = observations_.first[group + 1] - first;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const std::size_t column = columns[k];
      const std::span<double> to = derivatives.subspan(k * rows, rows);
      std::vector<double> key(values.begin(), values.end());
      if (column < input_.maps.size() * numbers_of_a_map) {
        const std::size_t map = column / numbers_of_a_map;
        const auto all = map_slopes_.at(key, [&] { return map_slopes(values); });
        for (std::size_t i = 0; i < rows; ++i)
          to[i] = readings_.rows[first + i].map == map ? (*all)[first + i][column % numbers_of_a_map] : 0;
        continue;
      }
      key.push_back(static_cast<double>(column));
      const auto all = slopes_.at(key, [&] { return slope(values, column); });
      std::copy_n(all->begin() + static_cast<std::ptrdiff_t>(first), rows, to.begin());
    }
  }

  std::string domain() const override { return "prints"; }
  std::string unit() const override { return "1"; }
  std::string score_name() const override { return "RMS error of heights over a layer's thickness"; }
  std::string group_noun() const override { return "patch"; }
  // What matters goes with the layers, which a print cannot be finer than: a share of what another effect leaves would
  // name ever smaller ones beside it.
  Importance importance() const override { return Importance::share_of_signal; }
  double fit_tolerance() const override { return 1e-5; }
  // A grey value that just cures, or does not, moves the surface by a whole layer.
  bool sets_outliers_aside() const override { return true; }

  std::string remarks(const Explanation&) const override { return prints_remarks(input_, readings_); }
  std::vector<std::size_t> tested_apart() const override {
    std::vector<std::size_t> apart;
    for (std::size_t c = 0; c < candidates_.size(); ++c)
      if (use_of(candidates_[c].parameters.front()).term->random) apart.push_back(c);
    return apart;
  }
  void conclude(Explanation& e) const override {
    if (!is_heard()) return;
    for (const std::size_t c : tested_apart()) conclude_ground(*this, *ground_, layer_um_, c, e);
  }
  void apply(const Explanation& e, manifest::Document& document) const override {
    for (const PrintUse& use : uses_) upgrade_print(input_, use, e, document);
    for (const std::size_t c : tested_apart())
      if (std::ranges::find(e.named, c) != e.named.end()) write_ground(input_, *ground_, document);
  }
  Illustration illustrate(const Explanation& e, const std::filesystem::path&, manifest::Document&) const override {
    return illustrate_prints(input_, readings_, e);
  }

 private:
  struct Of {  // numbers of a map
    enum : std::size_t { height = 0, tilt_x, tilt_y, x, y, resolution };
  };
  static constexpr std::size_t numbers_of_a_map = 6;

  Setting setting_of(std::span<const double> values) const {
    Setting setting = stated(input_.sent);
    for (const PrintUse& use : uses_) {
      const std::span<const double> p = values.subspan(use.first, use.neutral.size());
      if (!std::ranges::equal(p, use.neutral)) use.term->set(setting, input_.sent, use.form, p);
    }
    const double spread_m = values[spread_] * input_.sent.printer.pixel_m.x;
    setting.printer.bleed.sigma_m = std::hypot(setting.printer.bleed.sigma_m, spread_m);
    if (white_ && values[*white_] != 0) {
      equation::PrintGrowth told = equation::print_growth_of(*setting.printer.growth.law());
      told.white_m *= 1 + values[*white_];
      setting.printer.growth = print::Growth(equation::print_growth(told));
    }
    return setting;
  }
  // Of the map's readings, which stand one after the other.
  void see(std::size_t map, const Setting& setting, std::span<const double> values, std::vector<double>& mean_m,
           std::vector<Sight::Slopes>* slopes) const {
    const std::size_t own = map * numbers_of_a_map;
    const Vec2 pixel = input_.sent.printer.pixel_m;
    const io::HeightMap& points = input_.maps[map].map;
    const Sight::View view{.shift_m = {values[own + Of::x] * pixel.x, values[own + Of::y] * pixel.y},
                           .shrinkage = setting.shrinkage,
                           .point_m = {points.step_x_m, points.step_y_m},
                           .resolution_m = values[own + Of::resolution] * pixel.x};
    sights_[map].heights(*simulation_.field(setting), view, mean_m, slopes);
  }
  // Of all rows: one surface serves all patches.
  std::vector<double> predicted(std::span<const double> values) const {
    const Setting setting = setting_of(values);
    std::vector<double> prediction, mean_m;
    for (std::size_t m = 0; m < input_.maps.size(); ++m) {
      const std::size_t own = m * numbers_of_a_map;
      see(m, setting, values, mean_m, nullptr);
      for (const double z : mean_m) {
        const Vec2 at = readings_.rows[prediction.size()].at_m - input_.sent.centre_m;
        prediction.push_back((um * equation::print_shrinkage(z, setting.shrinkage.z) + values[own + Of::height] +
                              um * (values[own + Of::tilt_x] * at.x + values[own + Of::tilt_y] * at.y)) /
                             layer_um_);
      }
    }
    return prediction;
  }
  using MapSlopes = std::array<double, numbers_of_a_map>;
  std::vector<MapSlopes> map_slopes(std::span<const double> values) const {
    const Setting setting = setting_of(values);
    const Vec2 pixel = input_.sent.printer.pixel_m;
    std::vector<double> mean_m;
    std::vector<Sight::Slopes> slopes;
    std::vector<MapSlopes> all;
    for (std::size_t m = 0; m < input_.maps.size(); ++m) {
      see(m, setting, values, mean_m, &slopes);
      for (const Sight::Slopes& s : slopes) {
        const Vec2 at = readings_.rows[all.size()].at_m - input_.sent.centre_m;
        const double one = um / layer_um_, z = one * equation::print_shrinkage(1, setting.shrinkage.z);
        all.push_back({1 / layer_um_, one * at.x, one * at.y, z * s.shift_x * pixel.x, z * s.shift_y * pixel.y,
                       z * s.resolution * pixel.x});
      }
    }
    return all;
  }
  // By a number of the physics: differences of surfaces.
  std::vector<double> slope(std::span<const double> values, std::size_t column) const {
    const Parameter& p = parameters_[column];
    const double centre = values[column],
                 step = (column < physics_ ? step_of_spread : use_of(column).term->step) * p.size;
    const double upper = std::min(centre + step, std::max(p.upper, centre)),
                 lower = std::max(centre - step, std::min(p.lower, centre));
    std::vector<double> moved(values.begin(), values.end());
    moved[column] = upper;
    std::vector<double> above = predicted(moved);
    moved[column] = lower;
    const std::vector<double> below = predicted(moved);
    const double scale = upper > lower ? 1 / (upper - lower) : 0;
    for (std::size_t i = 0; i < above.size(); ++i) above[i] = (above[i] - below[i]) * scale;
    return above;
  }
  const PrintUse& use_of(std::size_t parameter) const {
    return *(std::ranges::upper_bound(uses_, parameter, {}, &PrintUse::first) - 1);
  }

  std::size_t add(Parameter p) {
    parameters_.push_back(std::move(p));
    return parameters_.size() - 1;
  }
  void map_parameters() {
    for (std::size_t m = 0; m < input_.maps.size(); ++m) {
      const std::string prefix = "prints/" + input_.name + "/measured/" + std::to_string(m) + "/";
      const auto free = [&](const char* name, const char* unit, double start, double lower, double upper, double change,
                            std::optional<double> prior) {
        base_.push_back(add({prefix + name, unit, start, start, lower, upper, change, prior, {}}));
      };
      std::vector<double> above;
      for (const Reading& r : readings_.rows)
        if (r.map == m) above.push_back(r.z_um - r.height_um);
      free("height_um", "um", above.empty() ? 0 : stats::median(above), -infinity, infinity, 0.1 * layer_um_, {});
      free("tilt_x", "1", 0, -infinity, infinity, 1e-3, tilt_sigma);
      free("tilt_y", "1", 0, -infinity, infinity, 1e-3, tilt_sigma);
      free("x_px", "px", 0, -most_place_px, most_place_px, 0.1, place_sigma_px);
      free("y_px", "px", 0, -most_place_px, most_place_px, 0.1, place_sigma_px);
      free("resolution_px", "px", usual_resolution_px, 0, coarsest_px, 0.1, resolution_sigma_px);
    }
  }

  // What every resin does a little: radicals spread before they act, so that walls stand beside the pixels' rims, this
  // way and that. And a law that is stated was fitted to something: white's height is free by what such fits err; a
  // table is what was measured itself.
  void print_parameters() {
    const std::string prefix = "prints/" + input_.name + "/";
    spread_ = add({prefix + "bleed/spread_px",
                   "px",
                   usual_spread_px,
                   usual_spread_px,
                   0,
                   most_spread_px,
                   0.2 * usual_spread_px,
                   usual_spread_px,
                   {}});
    base_.push_back(spread_);
    const print::Growth& growth = input_.sent.printer.growth;
    if (!growth.law() || growth.table()) return;
    white_ = add({prefix + "growth/white", "1", 0, 0, -0.1, 0.1, white_sigma, white_sigma, {}});
    base_.push_back(*white_);
  }

  void enter(const Term& term) {
    const mechanism::Mechanism& m = term.mechanism();
    const auto given = input_.given.find(m.id);
    std::vector<std::string> all;
    for (const mechanism::Parameter& p : m.parameters) all.push_back(p.name);
    std::vector<Form> forms = term.forms != nullptr ? term.forms(input_.sent) : std::vector<Form>{{all, false}};
    std::vector<Bounds> bounds;
    if (term.bounds != nullptr)
      bounds = term.bounds(input_.sent);
    else
      for (const mechanism::Parameter& p : m.parameters) bounds.push_back({p.neutral, p.lower, p.upper, p.start});
    if (given != input_.given.end()) {
      const auto layer = given->second.find("layer");
      forms = {{all, false, "", layer != given->second.end() ? layer->second.scalar() : 0}};
    }
    for (const Form& form : forms) enter(term, form, bounds, forms.size() > 1);
  }
  void enter(const Term& term, const Form& form, const std::vector<Bounds>& bounds, bool several) {
    const mechanism::Mechanism& m = term.mechanism();
    const auto given = input_.given.find(m.id);
    PrintUse use{&term, form, parameters_.size(), {}};
    const std::string of = form.on.empty() ? "" : form.on + ".";
    Candidate candidate{&m, {}, {}, several ? m.id : std::string(), form.finer};
    if (!form.on.empty()) candidate.on = {form.on};
    candidate.gradual = term.gradual;
    for (std::size_t k = 0; k < m.parameters.size(); ++k) {
      const mechanism::Parameter& info = m.parameters[k];
      const Bounds& b = bounds[k];
      Parameter p{m.id + "." + of + info.name, info.unit, b.start, b.neutral, b.lower, b.upper, size_of(b), {}, {}};
      const bool fitted = std::ranges::find(form.parameters, info.name) != form.parameters.end();
      if (given != input_.given.end()) {
        const auto value = given->second.find(info.name);
        if (value != given->second.end()) p.start = p.neutral = value->second.scalar();
        if (value != given->second.end() && info.unit != "" && term.write == nullptr && form.held == 0)
          base_.push_back(parameters_.size());
      } else if (fitted) {
        candidate.parameters.push_back(parameters_.size());
      }
      use.neutral.push_back(b.neutral);
      add(std::move(p));
    }
    if (given == input_.given.end()) candidates_.push_back(std::move(candidate));
    uses_.push_back(std::move(use));
  }
  static double size_of(const Bounds& b) {
    return std::max(std::abs(b.start - b.neutral), 0.005 * (b.upper - b.lower));
  }

  void observe() {
    Observations& o = observations_;
    std::uint32_t block = 0;
    for (std::size_t i = 0; i < readings_.rows.size(); ++i) {
      const Reading& r = readings_.rows[i];
      const Reading* last = i > 0 ? &readings_.rows[i - 1] : nullptr;
      if (last == nullptr || last->map != r.map || last->patch != r.patch) {
        o.first.push_back(i);
        o.group.push_back(input_.maps[r.map].relief + " patch " + std::to_string(r.patch + 1));
      }
      if (last != nullptr && (last->map != r.map || last->patch != r.patch || last->tile != r.tile)) ++block;
      o.value.push_back(r.z_um / layer_um_), o.sigma.push_back(r.sigma_um / layer_um_);
      o.norm.push_back(1), o.block.push_back(block);
    }
    o.first.push_back(readings_.rows.size());
    o.conditions = print_conditions(input_, readings_);
  }

  // What the printer adds at random is noise to all else that is asked.
  void listen() {
    ground_ = ground_of(input_.sent, readings_, usual_resolution_px);
    if (is_heard())
      add_noise(ground_->seen_rms_um, static_cast<int>(std::ceil(lengths_of_a_block * ground_->length_px)), readings_);
  }
  bool is_heard() const { return ground_ && ground_->p < level_of_ground; }
  void look() {
    std::size_t first = 0;
    for (std::size_t m = 0; m < input_.maps.size(); ++m) {
      std::vector<Vec2> points;
      std::vector<std::uint32_t> count;
      for (; first < readings_.rows.size() && readings_.rows[first].map == m; ++first) {
        const Reading& r = readings_.rows[first];
        const auto begin = readings_.points.begin() + static_cast<std::ptrdiff_t>(r.first);
        points.insert(points.end(), begin, begin + static_cast<std::ptrdiff_t>(r.points));
        count.push_back(r.points);
      }
      sights_.emplace_back(input_.sent, points, count);
    }
  }

  PrintsInput input_;
  Readings readings_;
  double layer_um_ = 1;
  std::optional<Ground> ground_;
  std::size_t spread_ = 0;  // places of their parameters
  std::optional<std::size_t> white_;
  std::vector<PrintUse> uses_;
  std::size_t physics_ = 0;  // the first parameter that is no map's
  std::vector<Sight> sights_;
  Simulation simulation_;
  Memo<std::vector<double>> predicted_{kept_predictions}, slopes_{kept_slopes};
  Memo<std::vector<MapSlopes>> map_slopes_{kept_map_slopes};
};

}  // namespace

std::unique_ptr<Problem> prints_problem(PrintsInput input) {
  return std::make_unique<PrintsProblem>(std::move(input));
}

}  // namespace gonio::explain
