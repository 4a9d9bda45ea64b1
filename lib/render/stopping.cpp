#include "render/stopping.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <vector>

namespace gonio::render {
namespace {

constexpr double dark = 0.01;                 // of the median
constexpr double round_s = 0.5;               // a round of passes lasts about as long
constexpr std::uint32_t first_judgement = 4;  // passes

double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// How many passes to add before looking at clocks and errors again. It changes no result.
class Rounds {
 public:
  explicit Rounds(const Goal& goal) : goal_(goal) {}
  std::uint32_t next(const PassSums& sums, double spent_s) const {
    const std::uint32_t left = goal_.end_pass - sums.end_pass();
    if (goal_.relative_error) return 1;
    double passes = pass_s_ > 0 ? round_s / pass_s_ : 1;
    if (goal_.time_s) passes = std::min(passes, pass_s_ > 0 ? (*goal_.time_s - spent_s) / pass_s_ : 1);
    return std::clamp(static_cast<std::uint32_t>(std::clamp(passes, 1.0, 1e6)), 1u, left);
  }
  void took(std::uint32_t passes, double seconds) { pass_s_ = std::max(seconds, 1e-9) / passes; }

 private:
  const Goal& goal_;
  double pass_s_ = 0;
};

// A bar for people: of passes, or of the time or the error where those will decide.
class Bar {
 public:
  Bar(const PassSums& sums, const Goal& goal)
      : goal_(goal), pixels_(sums.pixels()), by_passes_(!goal.time_s && !goal.relative_error) {
    const std::uint64_t passes = goal.end_pass - std::min(goal.end_pass, sums.end_pass());
    bar_ = std::make_unique<Progress>(sums.identity().image, by_passes_ ? passes * pixels_ : steps);
  }
  Progress* passes() { return by_passes_ ? bar_.get() : nullptr; }
  void show(const PassSums& sums, double spent_s, double error) {
    if (by_passes_) return;
    double share = static_cast<double>(sums.end_pass()) / goal_.end_pass;
    if (goal_.time_s) share = std::max(share, spent_s / *goal_.time_s);
    if (goal_.relative_error && error > 0) share = std::max(share, std::pow(*goal_.relative_error / error, 2));
    const auto now = static_cast<std::uint64_t>(std::clamp(share, 0.0, 1.0) * steps);
    bar_->advance(std::max(now, shown_) - shown_);
    shown_ = std::max(now, shown_);
  }

 private:
  static constexpr std::uint64_t steps = 1000;
  const Goal& goal_;
  std::uint64_t pixels_, shown_ = 0;
  bool by_passes_;
  std::unique_ptr<Progress> bar_;
};

}  // namespace

double relative_error(const PassSums& sums) {
  if (sums.passes() < 2) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> values, variances;
  for (std::size_t pixel = 0; pixel < sums.pixels(); ++pixel) {
    const Rgb mean = sums.mean(pixel, 0), variance = sums.variance(pixel, 0);
    const std::array<std::pair<double, double>, 3> channels = {
        {{mean.x, variance.x}, {mean.y, variance.y}, {mean.z, variance.z}}};
    for (const auto& [y, v] : channels)
      if (y != 0 && std::isfinite(y) && std::isfinite(v)) values.push_back(y), variances.push_back(v);
  }
  if (values.empty()) return 0;
  std::vector<double> sizes = values;
  for (double& size : sizes) size = std::abs(size);
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  const double floor = dark * *middle;
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) sum += variances[i] / (values[i] * values[i] + floor * floor);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

Reached render_until(const Integrator& integrator, PassSums& sums, const Goal& goal, Watch watch) {
  if (!watch.clock) watch.clock = steady_s;
  const double start_s = watch.clock() - watch.spent_s;
  Rounds rounds(goal);
  Bar bar(sums, goal);
  double spent_s = watch.spent_s;
  while (true) {
    const bool judged = goal.relative_error && sums.passes() >= first_judgement;
    const double error = judged ? relative_error(sums) : 0;
    if (judged && error <= *goal.relative_error) return Reached::noise;
    if (goal.time_s && sums.passes() >= 2 && spent_s >= *goal.time_s) return Reached::time;
    if (sums.end_pass() >= goal.end_pass) return Reached::samples;
    bar.show(sums, spent_s, error);
    const std::uint32_t passes = rounds.next(sums, spent_s);
    add_passes(integrator, sums, passes, bar.passes());
    const double now_s = watch.clock() - start_s;
    rounds.took(passes, now_s - spent_s);
    spent_s = now_s;
    if (watch.on_round) watch.on_round(sums, spent_s);
  }
}

}  // namespace gonio::render
