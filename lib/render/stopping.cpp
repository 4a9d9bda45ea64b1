#include "render/stopping.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace gonio::render {
namespace {

constexpr double dark = 0.01;                 // of the median
constexpr double doubt = 1.0 / 3;             // relative error of a value that its neighbours are asked about
constexpr double outlier = 2;                 // times the median of the neighbours
constexpr double round_s = 0.5;               // a round of passes lasts about as long
constexpr std::uint32_t first_judgement = 4;  // passes

struct Estimated {
  float value = 0, variance = 0;
  bool lit() const { return value != 0; }
  bool doubtful() const { return variance > doubt * doubt * value * value; }
  double size() const { return std::abs(value); }
};

// Values of red, green and blue with their variances; black where they are no numbers.
class Values {
 public:
  explicit Values(const PassSums& sums) : width_(sums.identity().width_px), height_(sums.identity().height_px) {
    for (std::size_t pixel = 0; pixel < sums.pixels(); ++pixel) {
      const Rgb y = sums.mean(pixel, 0), v = sums.variance(pixel, 0);
      for (const auto& [value, variance] : {std::pair{y.x, v.x}, std::pair{y.y, v.y}, std::pair{y.z, v.z}}) {
        const Estimated e{static_cast<float>(value), static_cast<float>(variance)};
        values_.push_back(std::isfinite(e.value) && std::isfinite(e.variance) ? e : Estimated{});
      }
    }
    std::vector<float> sizes;
    for (const Estimated& e : values_)
      if (e.lit()) sizes.push_back(std::abs(e.value));
    floor_ = sizes.empty() ? 0 : dark * median(sizes);
  }
  const Estimated& at(int x, int y, int channel) const {
    return values_[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)) +
                   static_cast<std::size_t>(channel)];
  }
  // The term of the picture's error.
  double term(int x, int y, int channel) const {
    const Estimated& e = at(x, y, channel);
    const double size = e.doubtful() ? std::min(e.size(), outlier * around(x, y, channel)) : e.size();
    return e.variance / (size * size + floor_ * floor_);
  }

 private:
  static double median(std::vector<float>& sizes) {
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    return *middle;
  }
  // Median of what is lit among the pixel and its neighbours.
  double around(int x, int y, int channel) const {
    std::vector<float> sizes;
    for (int v = std::max(0, y - 1); v <= std::min(height_ - 1, y + 1); ++v)
      for (int u = std::max(0, x - 1); u <= std::min(width_ - 1, x + 1); ++u)
        if (at(u, v, channel).lit()) sizes.push_back(std::abs(at(u, v, channel).value));
    return median(sizes);
  }

  int width_, height_;
  std::vector<Estimated> values_;
  double floor_ = 0;
};

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

ErrorEstimate estimate_error(const PassSums& sums) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  if (sums.passes() < 2) return {unknown, unknown};
  const Values values(sums);
  double terms = 0, count = 0, terms_squared = 0, mixed = 0, count_squared = 0;
  for (int y = 0; y < sums.identity().height_px; ++y)
    for (int x = 0; x < sums.identity().width_px; ++x) {
      double t = 0, n = 0;
      for (const int channel : {0, 1, 2})
        if (values.at(x, y, channel).lit()) t += values.term(x, y, channel), ++n;
      terms += t, count += n;
      terms_squared += t * t, mixed += t * n, count_squared += n * n;
    }
  if (count == 0) return {};
  const double square = terms / count, pixels = static_cast<double>(sums.pixels());
  const double scatter = terms_squared - 2 * square * mixed + square * square * count_squared;
  const double error = std::sqrt(std::max(0.0, scatter) * pixels / std::max(1.0, pixels - 1)) / count;
  return {std::sqrt(square), std::sqrt(square + 2 * error)};
}

double relative_error(const PassSums& sums) {
  return estimate_error(sums).relative;
}

Reached render_until(const Integrator& integrator, PassSums& sums, const Goal& goal, Watch watch) {
  if (!watch.clock) watch.clock = steady_s;
  const double start_s = watch.clock() - watch.spent_s;
  Rounds rounds(goal);
  Bar bar(sums, goal);
  double spent_s = watch.spent_s;
  while (true) {
    const bool judged = goal.relative_error && sums.passes() >= first_judgement;
    const double error = judged ? estimate_error(sums).bound : 0;
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
