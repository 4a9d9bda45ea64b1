// Problems whose truth is known, with mechanisms of several numbers that enter nonlinearly, noise common to blocks, and
// what spoils real recordings: dust, an odd block, a misstated sigma.
//   y = offset_g + slope x + sum over effects shape(p; x, z) + noise
#pragma once
#include "inference/toy_frame.h"

namespace gonio::explain::tests {

using Numbers = std::span<const double>;

struct Effect {
  std::string id;
  std::vector<mechanism::Parameter> numbers;  // name, unit, neutral, lower, upper, start
  std::vector<std::string> conditions;
  std::function<double(Numbers p, double x, double z)> shape;
};

struct Spoiled {
  std::function<double(double x, double z)> outside;  // physics that no effect describes
  double noise = 0.1, block_noise = 0;                // white, and common to the rows of a block
  double stated = 1;                                  // stated sigma over the true one
  std::size_t dust_rows = 0;                          // rows that are off by eight to twenty noise widths
  double odd_block = 0;                               // one block is off by so many noise widths
};
struct Size {
  std::size_t groups = 10, blocks = 20, rows_of_a_block = 2;
};

class NonlinearToy : public ToyFrame {
 public:
  // `truth`: for every effect its numbers; empty: neutral.
  NonlinearToy(std::vector<Effect> effects, std::vector<std::vector<double>> truth, Spoiled spoiled, std::uint64_t seed,
               Size size = {})
      : effects_(std::move(effects)) {
    Random random(seed, 11);
    declare_base(size.groups);
    declare_effects();
    truth.resize(effects_.size());
    const Design design{size.groups,         size.blocks,    size.rows_of_a_block, spoiled.noise,
                        spoiled.block_noise, spoiled.stated, spoiled.odd_block};
    record(random, design, [&](double x, double z) {
      double sum = spoiled.outside ? spoiled.outside(x, z) : 0;
      for (std::size_t k = 0; k < effects_.size(); ++k)
        if (!truth[k].empty()) sum += effects_[k].shape(truth[k], x, z);
      return sum;
    });
    for (std::size_t d = 0; d < spoiled.dust_rows; ++d) {
      const auto row = random.below(static_cast<std::uint32_t>(observations_.rows()));
      observations_.value[row] +=
          std::hypot(spoiled.noise, spoiled.block_noise) * random.uniform(8, 20) * (random.uniform() < 0.5 ? -1 : 1);
    }
  }
  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    for (std::size_t i = 0; i < prediction.size(); ++i) {
      const std::size_t row = observations_.first[group] + i;
      double f = plain(values, group, row);
      for (std::size_t k = 0; k < effects_.size(); ++k)
        f += effects_[k].shape(values.subspan(candidates_[k].parameters[0], candidates_[k].parameters.size()),
                               at(0, row), at(1, row));
      prediction[i] = f;
    }
  }
  // Says of an effect that it is another form of a plainer one.
  void make_finer(std::size_t effect) { candidates_[effect].finer = true; }

 private:
  void declare_effects() {
    mechanisms_.resize(effects_.size());
    for (std::size_t k = 0; k < effects_.size(); ++k) {
      mechanism::Mechanism& m = mechanisms_[k];
      m.id = effects_[k].id;
      m.stage = "toy";
      m.conditions = effects_[k].conditions;
      m.parameters = effects_[k].numbers;
      Candidate c;
      c.mechanism = &m;
      for (const mechanism::Parameter& p : m.parameters) {
        c.parameters.push_back(parameters_.size());
        const double size = std::max(std::abs(p.start - p.neutral), 0.02 * (p.upper - p.lower));
        parameters_.push_back({m.id + "." + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, size, {}, {}});
      }
      candidates_.push_back(std::move(c));
    }
  }
  std::vector<Effect> effects_;
  std::vector<mechanism::Mechanism> mechanisms_;
};

inline mechanism::Parameter number(std::string name, double neutral, double lower, double upper, double start) {
  return {.name = std::move(name), .unit = "1", .neutral = neutral, .lower = lower, .upper = upper, .start = start};
}
inline mechanism::Parameter amplitude() {
  return number("a", 0, -5, 5, 0.05);
}

// A library with linear terms, a peak of unknown place and width, a ripple of unknown pitch, and a decay.
inline std::vector<Effect> library() {
  return {
      {"toy.square", {amplitude()}, {"x"}, [](Numbers p, double x, double) { return p[0] * x * x; }},
      {"toy.cube", {amplitude()}, {"x"}, [](Numbers p, double x, double) { return p[0] * x * x * x; }},
      {"toy.peak",
       {number("a", 0, -5, 5, 0.1), number("centre", 0.2, -1, 1, 0.2), number("width", 0.3, 0.03, 1, 0.3)},
       {"x"},
       [](Numbers p, double x, double) { return p[0] * std::exp(-0.5 * std::pow((x - p[1]) / p[2], 2)); }},
      {"toy.ripple",
       {number("a", 0, -5, 5, 0.1), number("pitch", 6, 2, 30, 6), number("phase", 0, -4, 4, 0.3)},
       {"z"},
       [](Numbers p, double, double z) { return p[0] * std::sin(p[1] * z + p[2]); }},
      {"toy.decay",
       {number("a", 0, 0, 5, 0.1), number("length", 0.5, 0.02, 3, 0.5)},
       {"z"},
       [](Numbers p, double, double z) { return p[0] * std::exp(-(z + 1) / p[1]); }},
      {"toy.tilt", {amplitude()}, {"z"}, [](Numbers p, double, double z) { return p[0] * z; }},
      {"toy.product", {amplitude()}, {"x", "z"}, [](Numbers p, double x, double z) { return p[0] * x * z; }},
  };
}

}  // namespace gonio::explain::tests
