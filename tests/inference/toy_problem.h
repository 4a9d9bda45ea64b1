// A small linear problem whose truth is known: y = offset_g + slope x + sum_k p_k s_k(x, z) + noise, with an offset per
// group as nuisance. Mechanisms are written here so that the engine is tested without any simulator.
#pragma once
#include "inference/toy_frame.h"

namespace gonio::explain::tests {

struct ToyEffect {
  std::string id;
  std::function<double(double x, double z)> shape;
};

class ToyProblem : public ToyFrame {
 public:
  struct Truth {
    std::vector<double> amplitudes;                     // one per effect
    std::function<double(double x, double z)> outside;  // physics that no effect describes
    double noise = 0.1, block_noise = 0;
  };
  ToyProblem(std::vector<ToyEffect> effects, const Truth& truth, std::uint64_t seed, std::size_t groups = 10,
             std::size_t blocks = 20, std::size_t rows_of_a_block = 2)
      : effects_(std::move(effects)) {
    Random random(seed, 7);
    declare_base(groups);
    declare_effects();
    record(random, {groups, blocks, rows_of_a_block, truth.noise, truth.block_noise}, [&](double x, double z) {
      double sum = truth.outside ? truth.outside(x, z) : 0;
      for (std::size_t k = 0; k < truth.amplitudes.size(); ++k) sum += truth.amplitudes[k] * effects_[k].shape(x, z);
      return sum;
    });
  }
  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    for (std::size_t i = 0; i < prediction.size(); ++i) {
      const std::size_t row = observations_.first[group] + i;
      double f = plain(values, group, row);
      for (std::size_t k = 0; k < effects_.size(); ++k)
        f += values[first_effect_ + k] * effects_[k].shape(at(0, row), at(1, row));
      prediction[i] = f;
    }
  }

 private:
  void declare_effects() {
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
