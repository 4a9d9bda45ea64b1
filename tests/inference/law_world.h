// A problem whose residual follows a law that no library has: y = offset_g + slope x + law(x, z) + noise, with an
// offset per group as nuisance; x in metres, z in seconds, both in (0, 1] or (-1, 1).
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/random.h"
#include "explain/engine.h"
#include "inference/explanation.h"
#include "inference/problem.h"

namespace gonio::explain::tests {

class LawProblem : public Problem {
 public:
  struct World {
    std::function<double(double x, double z)> law;
    double noise = 0.05, block_noise = 0;
    double lower = -1, upper = 1;  // of x and z
    std::size_t groups = 10, blocks = 40, rows_of_a_block = 2;
    bool slope = true;  // free in the base model
  };
  LawProblem(const World& world, std::uint64_t seed) : slope_(world.slope) {
    Random random(seed, 11);
    if (slope_) base_.push_back(parameters_.size()), parameters_.push_back({.name = "slope", .unit = "1"});
    Condition x{"plate.height", "m", "plate", {}, {}, "px"}, z{"clock.time", "s", "clock", {}, {}, "px"};
    observations_.first.push_back(0);
    std::uint32_t block = 0;
    for (std::size_t g = 0; g < world.groups; ++g) {
      observations_.group.push_back("take-" + std::to_string(g));
      base_.push_back(parameters_.size());
      parameters_.push_back({.name = observations_.group[g] + "/offset", .unit = "px", .groups = {g}});
      const double offset = random.normal();
      for (std::size_t b = 0; b < world.blocks; ++b, ++block) {
        const double common = world.block_noise * random.normal();
        for (std::size_t i = 0; i < world.rows_of_a_block; ++i) {
          const double at = random.uniform(world.lower, world.upper), then = random.uniform(world.lower, world.upper);
          x.values.push_back(at);
          z.values.push_back(then);
          observations_.value.push_back(offset + 0.7 * at * slope_ + common + world.noise * random.normal() +
                                        (world.law ? world.law(at, then) : 0));
          observations_.sigma.push_back(std::hypot(world.noise, world.block_noise));
          observations_.norm.push_back(1);
          observations_.block.push_back(block);
        }
      }
      observations_.first.push_back(observations_.value.size());
    }
    observations_.conditions = {x, z};
  }
  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    for (std::size_t i = 0; i < prediction.size(); ++i) {
      const double x = observations_.conditions[0].values[observations_.first[group] + i];
      prediction[i] = (slope_ ? values[0] * x : 0) + values[(slope_ ? 1 : 0) + group];
    }
  }
  std::string domain() const override { return "plates"; }
  std::string unit() const override { return "px"; }
  std::string score_name() const override { return "RMS"; }
  std::string group_noun() const override { return "take"; }
  Importance importance() const override { return Importance::share_of_residual; }
  void apply(const Explanation&, manifest::Document&) const override {}
  Illustration illustrate(const Explanation&, const std::filesystem::path&, manifest::Document&) const override {
    return {};
  }

 private:
  bool slope_ = true;
};

}  // namespace gonio::explain::tests
