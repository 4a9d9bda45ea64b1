// See traced_problem.h.
#include "explain/traced/traced_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/text.h"
#include "explain/traced/layer_steps.h"
#include "explain/traced/takes.h"
#include "explain/traced/traced_model.h"
#include "inference/estimable.h"
#include "manifest/document.h"
#include "report/colour_map.h"

namespace gonio::mechanism {
const Mechanism& surface_directional_subsurface();
}

namespace gonio::explain::traced {
namespace {

constexpr double own_error = 0.005;  // of the radiance: what two good tracers differ by
constexpr double estimable = 0.02;   // share of a number's signature that free and earlier numbers must leave
constexpr double never = 2;
constexpr std::size_t most_drawn = 4;

class TracedProblem final : public Problem {
 public:
  TracedProblem(const manifest::Document& document, const Options& options)
      : left_out_(behind_the_lens(document)), model_(document, options.repeats, options.pixels, options.paths) {
    if (model_.sampled().pixels.empty())
      throw Error(Exit::data, manifest::place(document, "/images"), "no picture shows the object", "check the poses");
    observe();
    for (std::size_t a = 0; a < model_.knobs().surfaces.size(); ++a)
      if (model_.knobs().surfaces[a].rough) {
        const LayerSteps steps = find_layers(model_, a, observations_);
        model_.begin_layers(a, steps.layer_m, steps.offset_m);
      }
    declare();
  }

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    model_.predict(values, group, prediction);
  }
  std::optional<inference::Bias> bias(std::span<const double> values,
                                      std::span<const std::size_t> candidates) const override {
    std::vector<std::size_t> named;
    for (const std::size_t c : candidates) named.push_back(question_of_[c]);
    const TracedModel::Traced exact = model_.trace(model_.scene_with(values, {}, named, true), model_.paths());
    inference::Bias bias{exact.radiance, exact.variance};
    for (std::size_t g = 0; g < observations_.groups(); ++g) {
      const std::size_t from = observations_.first[g];
      std::vector<double> fast(observations_.first[g + 1] - from);
      model_.predict(values, g, fast);
      for (std::size_t i = 0; i < fast.size(); ++i) bias.value[from + i] -= fast[i];
    }
    return bias;
  }
  bool excludes(std::size_t a, std::size_t b) const override {
    return varies(a) && varies(b) && candidates_[a].on == candidates_[b].on;
  }
  std::string domain() const override { return "traced"; }
  std::string unit() const override { return "1"; }
  std::string score_name() const override { return "relative RMSE"; }
  std::string group_noun() const override { return "cell"; }
  Importance importance() const override { return Importance::share_of_signal; }
  inference::Simulator simulator() const override { return inference::Simulator::errs; }
  bool outliers_are_effects() const override { return true; }
  double fit_tolerance() const override { return 1e-6; }

  std::string remarks(const Explanation&) const override {
    std::string text;
    for (const std::string& id : left_out_) text += (text.empty() ? "" : ", ") + id;
    return text.empty() ? "" : "What acts behind the lens (" + text + ") is left out here.";
  }
  void apply(const Explanation& e, manifest::Document& document) const override {
    std::vector<std::size_t> named;
    for (const std::size_t c : e.named) named.push_back(question_of_[c]);
    model_.write(e.values, e.sigma, named, false, document);
  }
  Illustration illustrate(const Explanation& e, const std::filesystem::path&, manifest::Document&) const override;

 private:
  // A roughness follows one law at most.
  bool varies(std::size_t c) const {
    const Acts acts = model_.knobs().knobs[candidates_[c].parameters[0]].acts;
    return acts == Acts::slopes || acts == Acts::layers || acts == Acts::reach_m;
  }

  void observe() {
    Observations& o = observations_;
    const Sampled& sampled = model_.sampled();
    for (std::size_t g = 0; g + 1 < sampled.first.size(); ++g) {
      o.first.push_back(o.value.size()), o.group.push_back(sampled.groups[g]);
      for (std::size_t p = sampled.first[g]; p < sampled.first[g + 1]; ++p) {
        const SampledPixel& pixel = sampled.pixels[p];
        const relighting::Recording& image = model_.recordings().images[pixel.image];
        const Rgb mean = relighting::local_mean(image, pixel.x, pixel.y);
        const auto place = static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(image.picture.width) +
                           static_cast<std::size_t>(pixel.x);
        for (std::size_t c = 0; c < 3; ++c) {
          const double y = image.picture.at(pixel.x, pixel.y, static_cast<int>(c));
          const double level = mean[static_cast<int>(c)];
          const double noise = (image.grey ? std::sqrt(3.0) : 1) * relighting::noise_sigma(image, level, 3 * place + c);
          o.value.push_back(y), o.norm.push_back(y * y), o.block.push_back(pixel.block);
          o.sigma.push_back(
              std::sqrt(noise * noise + model_.stated().variance[3 * p + c] + own_error * own_error * level * level));
        }
      }
    }
    o.first.push_back(o.value.size());
    observe_conditions();
  }

  void observe_conditions() {
    const double none = std::numeric_limits<double>::quiet_NaN();
    Condition height{"object.height", "m", "surface", {}, {}, ""}, slope{"object.slope", "1", "surface", {}, {}, ""},
        curvature{"surface.curvature", "1/m", "surface", {}, {}, ""},
        incidence{"surface.incidence-angle", "rad", "surface", {}, {}, ""},
        path{"volume.path-length", "m", "transport", {}, {}, ""};
    for (std::size_t p = 0; p < model_.sampled().pixels.size(); ++p) {
      const SampledPixel& pixel = model_.sampled().pixels[p];
      const double z = std::abs(pixel.here.normal.z);
      const double values[] = {pixel.here.position_m.z, 2 * z * std::sqrt(std::max(0.0, 1 - z * z)),
                               std::abs(pixel.here.mean_curvature_per_m), pixel.incidence_rad, pixel.path_m};
      Condition* const all[] = {&height, &slope, &curvature, &incidence, &path};
      for (std::size_t k = 0; k < 5; ++k)
        for (std::size_t c = 0; c < 3; ++c) {
          all[k]->values.push_back(pixel.surface ? values[k] : none);
          all[k]->direction.push_back(model_.stated().radiance[3 * p + c]);
        }
    }
    for (Condition* c : {&height, &slope, &curvature, &incidence, &path}) {
      c->curve_unit = "1";
      double low = 1e300, high = -1e300;
      for (const double v : c->values)
        if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
      if (low < high) observations_.conditions.push_back(std::move(*c));
    }
  }

  void declare() {
    const Knobs& knobs = model_.knobs();
    for (const Knob& knob : knobs.knobs) {
      Parameter p = knob.parameter;
      if (!knob.images.empty()) p.groups = groups_of(knob.images);
      parameters_.push_back(std::move(p));
    }
    std::vector<double> values, usual;
    for (const Parameter& p : parameters_) values.push_back(p.neutral);
    std::vector<Estimable::Column> columns;
    std::vector<std::size_t> free;
    for (const Question& q : knobs.questions)
      if (q.mechanism == nullptr)
        for (const std::size_t k : q.knobs) {
          free.push_back(k), columns.push_back(whitened_slopes(*this, k, values));
          usual.push_back(parameters_[k].size / 0.02);
        }
    std::vector<Estimable::Column> held;
    for (const std::size_t k : Estimable({}).kept(columns, never, usual))
      base_.push_back(free[k]), held.push_back(columns[k]);
    const Estimable beside(held);
    for (std::size_t n = 0; n < knobs.questions.size(); ++n) {
      const Question& q = knobs.questions[n];
      if (q.mechanism == nullptr) continue;
      Candidate c;
      c.mechanism = q.mechanism, c.on = q.on;
      std::vector<double> begun = values;
      for (const std::size_t k : q.knobs) begun[k] = parameters_[k].start;
      std::vector<Estimable::Column> own;
      std::vector<double> sizes;
      for (const std::size_t k : q.knobs)
        own.push_back(whitened_slopes(*this, k, begun)), sizes.push_back(10 * parameters_[k].size);
      for (const std::size_t k : beside.kept(own, estimable, sizes)) c.parameters.push_back(q.knobs[k]);
      if (c.parameters.empty() || c.parameters[0] != q.knobs[0]) {
        if (c.parameters.empty() || q.knobs.size() == 1 || knobs.knobs[q.knobs[0]].acts >= Acts::alpha) continue;
      }
      candidates_.push_back(std::move(c)), question_of_.push_back(n);
    }
  }

  std::vector<std::size_t> groups_of(const std::vector<std::size_t>& images) const {
    std::vector<std::size_t> groups;
    const Sampled& sampled = model_.sampled();
    for (std::size_t g = 0; g + 1 < sampled.first.size(); ++g)
      if (std::ranges::binary_search(images, sampled.pixels[sampled.first[g]].image)) groups.push_back(g);
    return groups.size() + 1 == sampled.first.size() ? std::vector<std::size_t>{} : groups;
  }

  std::vector<std::string> left_out_;
  TracedModel model_;
  std::vector<std::size_t> question_of_;  // of a candidate
};

// Sampled pixels of the pictures that are worst simulated: red where the recording is brighter.
Illustration TracedProblem::illustrate(const Explanation& e, const std::filesystem::path&, manifest::Document&) const {
  Illustration result;
  const Observations& o = observations_;
  if (e.residual_before.size() != o.rows()) return result;
  const Sampled& sampled = model_.sampled();
  double squares = 0;
  for (const double y : o.value) squares += y * y;
  const double scale = 0.2 * std::sqrt(squares / static_cast<double>(o.rows()));
  const auto drawn = [&](std::size_t image, const std::vector<double>& residual) {
    const auto& picture = model_.recordings().images[image].picture;
    const double radius = std::max(0.7, picture.width / 250.0);
    std::string svg =
        format("<svg viewBox=\"0 0 %d %d\" role=\"img\" style=\"background:#888;min-width:min(22rem,85vw)\">",
               picture.width, picture.height);
    for (std::size_t p = 0; p < sampled.pixels.size(); ++p) {
      if (sampled.pixels[p].image != image) continue;
      const double mean = (residual[3 * p] + residual[3 * p + 1] + residual[3 * p + 2]) / 3;
      svg += format("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" fill=\"%s\"/>", sampled.pixels[p].x + 0.5,
                    sampled.pixels[p].y + 0.5, radius, report::hex(report::signed_colour(mean / scale)).c_str());
    }
    return svg + "</svg>";
  };
  std::vector<std::pair<double, std::size_t>> worst;
  for (std::size_t g = 0; g < model_.recordings().images.size(); ++g) worst.emplace_back(0, g);
  for (std::size_t p = 0; p < sampled.pixels.size(); ++p)
    for (std::size_t c = 0; c < 3; ++c)
      worst[sampled.pixels[p].image].first += std::pow(e.residual_before[3 * p + c] / o.sigma[3 * p + c], 2);
  std::sort(worst.rbegin(), worst.rend());
  for (std::size_t k = 0; k < std::min(most_drawn, worst.size()); ++k) {
    const std::size_t image = worst[k].second;
    const std::string& id = model_.recordings().images[image].id;
    result.pictures.push_back(
        {id + ": sampled pixels, recording less simulation (red: the recording is brighter, full colour at " +
             format("%.3g)", scale),
         "", drawn(image, e.residual_before)});
    if (!e.named.empty())
      result.pictures.push_back({id + ": the same with the named physics", "", drawn(image, e.residual_after)});
  }
  return result;
}

}  // namespace

std::optional<Testimony> traced_objection(const Problem& problem, const Explanation& e, std::size_t candidate) {
  constexpr double least_share = 0.5;
  const Candidate& c = problem.candidates()[candidate];
  if (c.mechanism != &mechanism::surface_directional_subsurface()) return {};
  Testimony t{.by = "the model, which is there as a whole or not at all,", .quantity = "its share", .unit = "1"};
  t.before = 1, t.after = e.values[c.parameters[0]];
  t.refuted = t.after < least_share;
  return t;
}

std::unique_ptr<Problem> traced_problem(const manifest::Document& document, const Options& options) {
  return std::make_unique<TracedProblem>(document, options);
}

}  // namespace gonio::explain::traced
