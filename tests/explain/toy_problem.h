// A small linear problem whose truth is known: y = offset_g + slope x + sum_k p_k s_k(x, z) + noise, with an offset per
// group as nuisance. Mechanisms are written here so that the engine is tested without any simulator.
#pragma once
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "base/random.h"
#include "explain/explanation.h"
#include "explain/problem.h"

namespace gonio::explain::tests {

struct ToyEffect {
  std::string id;
  std::function<double(double x, double z)> shape;
};

class ToyProblem : public Problem {
 public:
  struct Truth {
    std::vector<double> amplitudes;                     // one per effect
    std::function<double(double x, double z)> outside;  // physics that no effect describes
    double noise = 0.1, block_noise = 0;                // white, and common to the rows of a block
  };
  ToyProblem(std::vector<ToyEffect> effects, const Truth& truth, std::uint64_t seed, std::size_t groups = 10,
             std::size_t blocks = 20, std::size_t rows_of_a_block = 2)
      : effects_(std::move(effects)) {
    Random random(seed, 7);
    declare(groups);
    observations_.first.push_back(0);
    Condition cx{"x", "m", "toy", {}, {}}, cz{"z", "m", "toy", {}, {}};
    for (std::size_t g = 0; g < groups; ++g) {
      observations_.group.push_back("group-" + std::to_string(g));
      const double offset = random.normal();
      for (std::size_t b = 0; b < blocks; ++b) {
        const double common = truth.block_noise * random.normal();
        for (std::size_t i = 0; i < rows_of_a_block; ++i) {
          const double x = random.uniform(-1, 1), z = random.uniform(-1, 1);
          double y = offset + 0.7 * x + common + truth.noise * random.normal();
          for (std::size_t k = 0; k < truth.amplitudes.size(); ++k) y += truth.amplitudes[k] * effects_[k].shape(x, z);
          if (truth.outside) y += truth.outside(x, z);
          observations_.value.push_back(y);
          observations_.sigma.push_back(std::hypot(truth.noise, truth.block_noise));
          observations_.norm.push_back(1);
          observations_.block.push_back(static_cast<std::uint32_t>(g * blocks + b));
          cx.values.push_back(x);
          cz.values.push_back(z);
        }
      }
      observations_.first.push_back(observations_.value.size());
    }
    observations_.conditions = {cx, cz};
  }
  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    const std::vector<double>&x = observations_.conditions[0].values, &z = observations_.conditions[1].values;
    for (std::size_t i = 0; i < prediction.size(); ++i) {
      const std::size_t row = observations_.first[group] + i;
      double f = values[0] * x[row] + values[1 + group];
      for (std::size_t k = 0; k < effects_.size(); ++k)
        f += values[first_effect_ + k] * effects_[k].shape(x[row], z[row]);
      prediction[i] = f;
    }
  }
  std::string domain() const override { return "toy"; }
  std::string unit() const override { return "m"; }
  std::string score_name() const override { return "RMS"; }
  std::string group_noun() const override { return "group"; }
  Importance importance() const override { return Importance::share_of_residual; }
  void apply(const Explanation&, manifest::Document&) const override {}
  Illustration illustrate(const Explanation&, const std::filesystem::path&, manifest::Document&) const override {
    return {};
  }

 private:
  void declare(std::size_t groups) {
    parameters_.push_back({"slope", "1", 0, 0, -10, 10, 1, {}, {}});
    base_.push_back(0);
    for (std::size_t g = 0; g < groups; ++g) {
      parameters_.push_back({"group-" + std::to_string(g) + "/offset", "m", 0, 0, -10, 10, 1, {}, {g}});
      base_.push_back(1 + g);
    }
    first_effect_ = parameters_.size();
    mechanisms_.resize(effects_.size());
    for (std::size_t k = 0; k < effects_.size(); ++k) {
      mechanisms_[k].id = effects_[k].id;
      mechanisms_[k].stage = "toy";
      mechanisms_[k].conditions = {"x"};
      parameters_.push_back({effects_[k].id + ".p", "m", 0, 0, -5, 5, 0.1, {}, {}});
      candidates_.push_back({&mechanisms_[k], {}, {first_effect_ + k}, {}});
    }
  }
  std::vector<ToyEffect> effects_;
  std::vector<mechanism::Mechanism> mechanisms_;
  std::size_t first_effect_ = 0;
};

inline std::vector<ToyEffect> three_effects() {
  return {{"toy.square", [](double x, double) { return x * x; }},
          {"toy.cube", [](double x, double) { return x * x * x; }},
          {"toy.wave", [](double, double z) { return std::sin(3 * z); }}};
}

}  // namespace gonio::explain::tests
