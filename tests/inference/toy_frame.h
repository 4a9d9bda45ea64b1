// What problems of known truth have in common: y = offset_g + 0.7 x + effect(x, z) + noise, x and z uniform in (-1, 1),
// an offset per group as nuisance and a slope that all share.
#pragma once
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "base/random.h"
#include "explain/engine.h"
#include "inference/explanation.h"
#include "inference/problem.h"

namespace gonio::explain::tests {

class ToyFrame : public Problem {
 public:
  struct Design {
    std::size_t groups = 10, blocks = 20, rows_of_a_block = 2;
    double noise = 0.1, block_noise = 0;  // white, and common to the rows of a block
    double stated = 1;                    // stated sigma over the true one
    double odd_block = 0;                 // one block is off by so many noise widths
  };

  std::string domain() const override { return "toy"; }
  std::string unit() const override { return "m"; }
  std::string score_name() const override { return "RMS"; }
  std::string group_noun() const override { return "group"; }
  Importance importance() const override { return Importance::share_of_residual; }
  void apply(const Explanation&, manifest::Document&) const override {}
  Illustration illustrate(const Explanation&, const std::filesystem::path&, manifest::Document&) const override {
    return {};
  }

 protected:
  void declare_base(std::size_t groups) {
    parameters_.push_back({"slope", "1", 0, 0, -10, 10, 1, {}, {}});
    base_.push_back(0);
    for (std::size_t g = 0; g < groups; ++g) {
      parameters_.push_back({"group-" + std::to_string(g) + "/offset", "m", 0, 0, -10, 10, 1, {}, {g}});
      base_.push_back(1 + g);
    }
  }

  void record(Random& random, const Design& d, const std::function<double(double x, double z)>& effect) {
    observations_.first.push_back(0);
    Condition cx{"x", "m", "toy", {}, {}}, cz{"z", "m", "toy", {}, {}};
    const double sigma = std::hypot(d.noise, d.block_noise);
    for (std::size_t g = 0; g < d.groups; ++g) {
      observations_.group.push_back("group-" + std::to_string(g));
      const double offset = random.normal();
      for (std::size_t b = 0; b < d.blocks; ++b) {
        double common = d.block_noise * random.normal();
        if (g == 1 && b == 3) common += d.odd_block * sigma;
        for (std::size_t i = 0; i < d.rows_of_a_block; ++i) {
          const double x = random.uniform(-1, 1), z = random.uniform(-1, 1);
          const double noise = d.noise * random.normal();
          observations_.value.push_back(offset + 0.7 * x + common + noise + effect(x, z));
          observations_.sigma.push_back(sigma * d.stated);
          observations_.norm.push_back(1);
          observations_.block.push_back(static_cast<std::uint32_t>(g * d.blocks + b));
          cx.values.push_back(x);
          cz.values.push_back(z);
        }
      }
      observations_.first.push_back(observations_.value.size());
    }
    observations_.conditions = {cx, cz};
  }

  double at(std::size_t condition, std::size_t row) const { return observations_.conditions[condition].values[row]; }
  // Of the base model.
  double plain(std::span<const double> values, std::size_t group, std::size_t row) const {
    return values[0] * at(0, row) + values[1 + group];
  }
};

}  // namespace gonio::explain::tests
