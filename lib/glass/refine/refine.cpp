// See refine.h.
#include "glass/refine/refine.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/parallel.h"

namespace gonio::glass {
namespace {

constexpr double light_blurs_px[] = {16, 8, 4, 2};
constexpr double odd_index = 2.2;  // deviations from what was expected
// What the index errs by because of light that two refractions leave unexplained, per share of it: from the development
// seeds of tests/prove/prove_glass_refine.cpp.
constexpr double index_model = 0.15;

// The descent of one stage: coefficients and globals (index, absorption per cell) as one column.
class Descending final : public optim::Descent {
 public:
  Descending(const Measuring& measuring, std::vector<Measurement> measurements, const SplineField& field,
             const Glassy& glass, double blur_px, const SmoothPrior& prior)
      : measuring_(measuring),
        measurements_(std::move(measurements)),
        field_(field),
        blur_px_(blur_px),
        state_(field.coefficients),
        variance_(measurements_.size(), -1),
        equations_(field_, prior, field.coefficients) {
    state_.push_back(glass.index), state_.push_back(glass.absorption);
  }

  double cost() {
    linearise();
    return cost_at(state_, false);
  }
  void linearise() override { cost_at(state_, true); }
  optim::Proposal propose(double damping) override {
    optim::Proposal proposal;
    trial_ = equations_.solve(damping, proposal.promised);
    for (std::size_t i = 0; i < trial_.size(); ++i) trial_[i] += state_[i];
    return proposal;
  }
  double evaluate() override {
    const double index = trial_[trial_.size() - 2];
    return index > 1.2 && index < 2.2 ? cost_at(trial_, false) : HUGE_VAL;
  }
  void accept() override { state_ = trial_; }

  SplineField field() const {
    SplineField field = field_;
    field.coefficients.assign(state_.begin(), state_.end() - globals);
    return field;
  }
  Glassy glass() const { return {state_[state_.size() - 2], state_.back()}; }
  const NormalEquations& equations() const { return equations_; }

 private:
  double cost_at(const std::vector<double>& state, bool linear) {
    SplineField field = field_;
    field.coefficients.assign(state.begin(), state.end() - globals);
    const Measuring::Asked asked{field, {state[state.size() - 2], state.back()}, blur_px_};
    std::vector<double> costs(measurements_.size());
    std::vector<Rows> rows(linear ? measurements_.size() : 0);
    parallel_for(
        0, measurements_.size(),
        [&](std::size_t i) {
          costs[i] = measuring_.cost(asked, measurements_[i], variance_[i], linear ? &rows[i] : nullptr);
        },
        64);
    if (linear) equations_.linearise(state, std::move(rows));
    double sum = equations_.prior_cost(state);
    for (const double c : costs) sum += c;
    return sum;
  }

  const Measuring& measuring_;
  std::vector<Measurement> measurements_;
  SplineField field_;  // where the stage began; its grid
  double blur_px_;
  std::vector<double> state_, trial_, variance_;
  NormalEquations equations_;
};

class Refinement {
 public:
  Refinement(std::span<const View> views, const RefineWish& wish)
      : views_(views), wish_(wish), measuring_(views, wish.sigmas) {}

  Refined run() {
    std::vector<View> fitted;
    for (std::size_t v = 0; v < views_.size(); ++v)
      if (v != wish_.held_out) fitted.push_back(views_[v]);
    add("hull", hull_of(fitted, wish_.hull), {wish_.index, 0}, {});
    std::vector<Measurement> told = each(&Measuring::outlines), normals = each(&Measuring::normals);
    if (wish_.hull.floor_m) {
      const auto floor = measuring_.floor(refined_.stages.front().field, *wish_.hull.floor_m);
      told.insert(told.end(), floor.begin(), floor.end());
    }
    descend("outline", told, 1, 6);
    const Stage& smooth = refined_.stages.back();
    measuring_.set_outline_sigma(
        std::max(wish_.sigmas.outline_px, measuring_.outline_misfit_px({smooth.field, smooth.glass, 1}, told)));
    if (!normals.empty()) {
      told.insert(told.end(), normals.begin(), normals.end());
      descend("normals", told, 1, 8);
    }
    refined_.answer = refined_.stages.size() - 1;
    std::vector<Measurement> all = told;
    if (wish_.light) {
      const std::vector<Measurement> lights = each(&Measuring::lights);
      all.insert(all.end(), lights.begin(), lights.end());
    }
    const bool by_light = wish_.light && through_light(all);
    draw(by_light ? all : told, by_light);
    return std::move(refined_);
  }

 private:
  std::vector<Measurement> each(std::vector<Measurement> (Measuring::*of)(std::size_t) const) const {
    std::vector<Measurement> all;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      if (v == wish_.held_out) continue;
      const std::vector<Measurement> one = (measuring_.*of)(v);
      all.insert(all.end(), one.begin(), one.end());
    }
    return all;
  }
  SmoothPrior prior(double cell_m) const {
    SmoothPrior prior = wish_.prior;
    prior.mean = {wish_.index, 0};
    prior.sigma = {wish_.index_sigma, wish_.absorption_sigma_per_m * cell_m};
    return prior;
  }
  void add(const std::string& name, SplineField field, const Glassy& glass, std::string how) {
    Stage stage{name, std::move(field), glass, 0, 1, std::move(how)};
    const Measuring::Asked asked{stage.field, glass, 1};
    double count = 0;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const double share = measuring_.unexplained(asked, v);
      if (v == wish_.held_out) stage.unexplained_held_out = share;
      if (v != wish_.held_out) stage.unexplained += share, ++count;
    }
    stage.unexplained /= count;
    refined_.stages.push_back(std::move(stage));
  }
  void descend(const std::string& name, const std::vector<Measurement>& measurements, double blur_px, int steps) {
    const Stage& from = refined_.stages.back();
    Descending descending(measuring_, measurements, from.field, from.glass, blur_px, prior(from.field.cell_m()));
    optim::Limits limits;
    limits.most_steps = steps, limits.most_refusals = 10, limits.first_damping = 1e-3;
    limits.small_fall = {3e-4, 0};
    const optim::Descended ended = optim::descend(descending, descending.cost(), limits);
    add(name, descending.field(), descending.glass(), optim::sentence(ended));
  }
  // The light's stages, and whether the last of them is the answer.
  bool through_light(const std::vector<Measurement>& measurements) {
    for (const double blur_px : light_blurs_px) descend(format_blur(blur_px), measurements, blur_px, 6);
    const Stage &before = refined_.stages[refined_.answer], &after = refined_.stages.back();
    const double was = wish_.held_out ? before.unexplained_held_out : before.unexplained;
    const double is = wish_.held_out ? after.unexplained_held_out : after.unexplained;
    if (!(is < was - wish_.least_gain)) return false;
    // A hollow body bends light as a full one of a lower index would: one that no glass has.
    if (std::abs(after.glass.index - wish_.index) > odd_index * wish_.index_sigma) return false;
    refined_.answer = refined_.stages.size() - 1;
    return true;
  }
  void draw(const std::vector<Measurement>& measurements, bool by_light) {
    if (wish_.draws == 0) return;
    const Stage& best = refined_.best();
    Descending there(measuring_, measurements, best.field, best.glass, std::end(light_blurs_px)[-1],
                     prior(best.field.cell_m()));
    there.linearise();
    Random random(wish_.seed, 17);
    double sum = 0;
    for (int k = 0; k < wish_.draws; ++k) {
      refined_.draws.push_back(there.equations().draw(random));
      const double index = refined_.draws.back()[best.field.size()];
      sum += index * index;
    }
    const double left_out = index_model * best.unexplained;
    if (by_light) refined_.index_sigma = std::sqrt(sum / wish_.draws + left_out * left_out);
  }
  static std::string format_blur(double blur_px) { return "light-" + std::to_string(static_cast<int>(blur_px)); }

  std::span<const View> views_;
  RefineWish wish_;
  Measuring measuring_;
  Refined refined_;
};

}  // namespace

Refined refine(std::span<const View> views, const RefineWish& wish) {
  return Refinement(views, wish).run();
}

}  // namespace gonio::glass
