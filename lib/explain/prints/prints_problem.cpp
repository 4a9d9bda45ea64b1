// See prints_problem.h.
#include "explain/prints/prints_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "explain/prints/map_readings.h"
#include "explain/prints/print_memo.h"
#include "explain/prints/print_term.h"
#include "explain/prints/prints_outcome.h"
#include "inference/explanation.h"
#include "print/mechanisms/print_shrinkage.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

using namespace prints;

constexpr double um = 1e6, infinity = std::numeric_limits<double>::infinity();
constexpr double place_sigma_px = 0.3, most_place_px = 3;
constexpr double usual_resolution_px = 0.2, resolution_sigma_px = 0.15, coarsest_px = 1;
constexpr double tilt_sigma = 0.1;
constexpr std::size_t kept_predictions = 512, kept_lights = 64, kept_fields = 32, kept_seen = 8;
constexpr double step_of_maps = 1e-3;  // of differences, of a parameter's size; physics: Term::step

class PrintsProblem final : public Problem {
 public:
  explicit PrintsProblem(PrintsInput input)
      : input_(std::move(input)),
        readings_(readings_of(input_)),
        predicted_(kept_predictions),
        spreads_(kept_lights),
        lights_(kept_lights),
        fields_(kept_fields),
        seen_(kept_seen) {
    map_parameters();
    physics_ = parameters_.size();
    for (const Term* term : all_terms()) enter(*term);
    observe();
  }

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    const auto all = predicted_.at({values.begin(), values.end()}, [&] { return predicted(values); });
    const auto first = all->begin() + static_cast<std::ptrdiff_t>(observations_.first[group]);
    std::copy_n(first, prediction.size(), prediction.begin());
  }
  void jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                std::span<double> derivatives) const override {
    const std::size_t rows = observations_.first[group + 1] - observations_.first[group];
    std::vector<double> moved(values.begin(), values.end()), above(rows), below(rows);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const Parameter& p = parameters_[columns[k]];
      const double centre = values[columns[k]],
                   step = (columns[k] < physics_ ? step_of_maps : use_of(columns[k]).term->step) * p.size;
      const double upper = std::min(centre + step, std::max(p.upper, centre)),
                   lower = std::max(centre - step, std::min(p.lower, centre));
      moved[columns[k]] = upper;
      predict(moved, group, above);
      moved[columns[k]] = lower;
      predict(moved, group, below);
      moved[columns[k]] = centre;
      const double scale = upper > lower ? 1 / (upper - lower) : 0;
      for (std::size_t i = 0; i < rows; ++i) derivatives[k * rows + i] = (above[i] - below[i]) * scale;
    }
  }

  std::string domain() const override { return "prints"; }
  std::string unit() const override { return "um"; }
  std::string score_name() const override { return "RMS error of heights"; }
  std::string group_noun() const override { return "patch"; }
  Importance importance() const override { return Importance::share_of_residual; }
  double fit_tolerance() const override { return 1e-5; }
  // A grey value that just cures, or does not, moves the surface by a whole layer.
  bool sets_outliers_aside() const override { return true; }

  std::string remarks(const Explanation&) const override { return prints_remarks(input_, readings_); }
  void apply(const Explanation& e, manifest::Document& document) const override {
    for (const PrintUse& use : uses_) upgrade_print(input_, use, e, document);
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
    return setting;
  }
  // Of all rows: one surface serves all patches.
  std::vector<double> predicted(std::span<const double> values) const {
    const Setting setting = setting_of(values);
    std::vector<std::shared_ptr<const Seen>> seen;
    for (std::size_t m = 0; m < input_.maps.size(); ++m) seen.push_back(seen_by(m, values, setting));
    const Vec2 pixel = input_.sent.printer.pixel_m, cell = pixel * (1.0 / cells_per_pixel);
    const Vec2 centre = input_.sent.centre_m;
    std::vector<double> prediction;
    for (const Reading& reading : readings_.rows) {
      const std::size_t own = reading.map * numbers_of_a_map;
      const Vec2 shift{values[own + Of::x] * pixel.x, values[own + Of::y] * pixel.y};
      double z = 0;
      for (std::uint32_t k = 0; k < reading.points; ++k) {
        const Vec2 point = readings_.points[reading.first + k] - shift - centre;
        const Vec2 from = equation::print_shrinkage_undone(point, setting.shrinkage.x, setting.shrinkage.y) + centre -
                          input_.sent.corner_m;
        z += seen[reading.map]->at(from.x / cell.x, from.y / cell.y) / reading.points;
      }
      const Vec2 at = reading.at_m - centre;
      prediction.push_back(um * equation::print_shrinkage(z, setting.shrinkage.z) + values[own + Of::height] +
                           um * (values[own + Of::tilt_x] * at.x + values[own + Of::tilt_y] * at.y));
    }
    return prediction;
  }
  Field field_of(const Setting& setting) const {
    return printed_field(input_.sent, setting, [this](const Setting& own) {
      const print::Bleed& bleed = own.printer.bleed;
      const std::vector<double> spread{bleed.sigma_m, bleed.tail_share, bleed.tail_m};
      std::vector<double> key{own.shifted_from, own.shift_m.x, own.shift_m.y, own.tilt.x, own.tilt.y};
      key.insert(key.end(), spread.begin(), spread.end());
      return lights_.at(key, [&] {
        return lights_of(input_.sent, own, *spreads_.at(spread, [&] { return spread_of(input_.sent, bleed); }));
      });
    });
  }
  const PrintUse& use_of(std::size_t parameter) const {
    return *(std::ranges::upper_bound(uses_, parameter, {}, &PrintUse::first) - 1);
  }
  std::shared_ptr<const Seen> seen_by(std::size_t map, std::span<const double> values, const Setting& setting) const {
    std::vector<double> key(values.begin() + static_cast<std::ptrdiff_t>(physics_), values.end());
    for (const PrintUse& use : uses_)  // what acts on places alone makes no other surface
      if (use.term->mechanism == &mechanism::print_shrinkage)
        for (std::size_t k = 0; k < use.neutral.size(); ++k) key[use.first - physics_ + k] = 0;
    std::vector<double> own = key;
    const double resolution_px = values[map * numbers_of_a_map + Of::resolution];
    const io::HeightMap& points = input_.maps[map].map;
    own.insert(own.end(), {resolution_px, points.step_x_m, points.step_y_m});
    return seen_.at(own, [&] {
      const auto field = fields_.at(key, [&] { return field_of(setting); });
      const Vec2 point{points.step_x_m / field->cell_m.x, points.step_y_m / field->cell_m.y};
      return Seen(*field, field->top_m, point, resolution_px * cells_per_pixel);
    });
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
      const double layer_um = um * input_.sent.printer.layer_m;
      free("height_um", "um", above.empty() ? 0 : stats::median(above), -infinity, infinity, 0.1 * layer_um, {});
      free("tilt_x", "1", 0, -infinity, infinity, 1e-3, tilt_sigma);
      free("tilt_y", "1", 0, -infinity, infinity, 1e-3, tilt_sigma);
      free("x_px", "px", 0, -most_place_px, most_place_px, 0.1, place_sigma_px);
      free("y_px", "px", 0, -most_place_px, most_place_px, 0.1, place_sigma_px);
      free("resolution_px", "px", usual_resolution_px, 0, coarsest_px, 0.1, resolution_sigma_px);
    }
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
      o.value.push_back(r.z_um), o.sigma.push_back(r.sigma_um), o.norm.push_back(1), o.block.push_back(block);
    }
    o.first.push_back(readings_.rows.size());
    o.conditions = print_conditions(input_, readings_);
  }

  PrintsInput input_;
  Readings readings_;
  std::vector<PrintUse> uses_;
  std::size_t physics_ = 0;  // the first parameter that is no map's
  Memo<std::vector<double>> predicted_;
  Memo<print::Spread> spreads_;
  Memo<Lights> lights_;
  Memo<Field> fields_;
  Memo<Seen> seen_;
};

}  // namespace

std::unique_ptr<Problem> prints_problem(PrintsInput input) {
  return std::make_unique<PrintsProblem>(std::move(input));
}

}  // namespace gonio::explain
