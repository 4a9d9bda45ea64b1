// See overflow.h.
#include "explain/stacks/overflow.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "explain/stacks/pixel_radiance.h"
#include "inference/apart.h"
#include "inference/wording.h"
#include "linear/solve.h"
#include "render/mechanisms/sensor_blooming.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::explain::stacks {
namespace {

constexpr double clear = 0.8;  // of full scale: above, a response may bend and wells end
constexpr std::size_t most_of_a_picture = 20000, fewest = 200, levels = 24, fewest_of_a_level = 100;
constexpr int tile_px = 16;
constexpr double most_by_chance = 1e-4, each_side = 2;  // standard errors
constexpr double least_repaired = 0.3;

struct Look {
  double expected = 0, residual = 0, sigma = 1;  // linear readings
  std::array<double, 4> over{};                  // of the neighbours up, down, left, right
  std::size_t part = 0;                          // tile of all pictures: a radiance serves several
  std::size_t level = 0;                         // whose median was taken off
  double level_sigma = 0;                        // of that median
  double reading() const { return expected + residual; }
};
constexpr std::array<std::pair<int, int>, 4> around{{{0, -1}, {0, 1}, {-1, 0}, {1, 0}}};

class Looks {
 public:
  Looks(const Stack& stack, const ReadingNoise& noise)
      : stack_(stack), radiances_(stack, noise, clear), full_(stack.linear(0, stack.full_scale)) {}

  // Readings beside clipped pixels, of all pictures, less what others of their brightness depart by.
  std::vector<Look> all() {
    std::vector<Look> looks;
    for (std::size_t g = 0; g < stack_.images.size(); ++g)
      for (int c = 0; c < static_cast<int>(stack_.channels.size()); ++c) {
        std::vector<Look> beside, away;
        collect(g, c, beside, away);
        level(away, beside);
        looks.insert(looks.end(), beside.begin(), beside.end());
      }
    return looks;
  }
  double full() const { return full_; }

 private:
  bool is_clipped(std::size_t g, int x, int y) const {
    if (x < 0 || y < 0 || x >= stack_.width() || y >= stack_.height()) return false;
    return stack_.images[g].at_least[static_cast<std::size_t>(y * stack_.width() + x)] != 0;
  }
  // What the neighbours gathered beyond full scale; false where nobody knows.
  bool overflow(std::size_t g, int x, int y, int c, std::array<double, 4>& over) {
    const double t = stack_.images[g].exposure_s * stack_.images[g].gain;
    for (std::size_t k = 0; k < around.size(); ++k) {
      const int u = x + around[k].first, v = y + around[k].second;
      if (u < 0 || v < 0 || u >= stack_.width() || v >= stack_.height()) return false;
      const PixelRadiance& r = radiances_.at(u, v, c);
      if (!r.known()) return false;
      over[k] = equation::overflow(r.value * t, full_);
    }
    return true;
  }
  void collect(std::size_t g, int c, std::vector<Look>& beside, std::vector<Look>& away) {
    const StackImage& image = stack_.images[g];
    const int width = stack_.width();
    std::vector<std::size_t> near, far;
    for (int y = 0; y < stack_.height(); ++y)
      for (int x = 0; x < width; ++x) {
        const double v = image.picture.at(x, y, c);
        if (is_clipped(g, x, y) || !std::isfinite(v) || !(v > stack_.lowest) || !(v < clear * stack_.full_scale))
          continue;
        const bool touches = std::ranges::any_of(
            around, [&](const auto& step) { return is_clipped(g, x + step.first, y + step.second); });
        if (touches)
          near.push_back(static_cast<std::size_t>(y * width + x));
        else if (image.counts[image.picture.index(x, y, c)])
          far.push_back(static_cast<std::size_t>(y * width + x));
      }
    if (near.empty()) return;
    for (auto* pixels : {&near, &far}) {
      std::vector<Look>& into = pixels == &near ? beside : away;
      const std::size_t stride = pixels->size() / most_of_a_picture + 1;
      for (std::size_t k = 0; k < pixels->size(); k += stride) {
        const int x = static_cast<int>((*pixels)[k]) % width, y = static_cast<int>((*pixels)[k]) / width;
        Look look;
        if (pixels == &near && !overflow(g, x, y, c, look.over)) continue;
        if (see(g, x, y, c, look)) into.push_back(look);
      }
    }
  }
  bool see(std::size_t g, int x, int y, int c, Look& look) {
    const StackImage& image = stack_.images[g];
    const PixelRadiance r = radiances_.without(g, x, y, c);
    if (!r.known()) return false;
    const double t = image.exposure_s * image.gain;
    look.expected = r.value * t;
    look.residual = stack_.linear(c, image.picture.at(x, y, c)) - look.expected;
    look.part = static_cast<std::size_t>(y / tile_px) * 1000 + static_cast<std::size_t>(x / tile_px);
    return true;
  }
  // Levels of the reading with equal numbers of readings away from clipped ones: their median is what the camera does
  // to all of them, their spread the noise. Not levels of what is expected, which short exposures know badly: to leave
  // out what is expected to be too bright would keep what was expected too dark. What is brighter or darker than all
  // of them tells nothing.
  void level(std::vector<Look>& away, std::vector<Look>& beside) {
    std::ranges::sort(away, {}, &Look::reading);
    const std::size_t bins = std::min(levels, away.size() / fewest_of_a_level);
    if (bins == 0) return beside.clear();
    std::vector<double> upper, median, spread, error;
    for (std::size_t b = 0; b < bins; ++b) {
      std::vector<double> residuals;
      for (std::size_t k = b * away.size() / bins; k < (b + 1) * away.size() / bins; ++k)
        residuals.push_back(away[k].residual);
      upper.push_back(away[(b + 1) * away.size() / bins - 1].reading());
      median.push_back(stats::median(residuals));
      for (double& r : residuals) r = std::abs(r - median.back());
      spread.push_back(std::max(stats::sigma_of_median * stats::median(residuals), stack_.quantum / std::sqrt(12.0)));
      error.push_back(spread.back() * std::sqrt(0.5 * pi / static_cast<double>(residuals.size())));
    }
    std::erase_if(beside,
                  [&](const Look& l) { return l.reading() < away.front().reading() || l.reading() > upper.back(); });
    for (Look& l : beside) {
      const auto bin = static_cast<std::size_t>(std::ranges::lower_bound(upper, l.reading()) - upper.begin());
      l.residual -= median[bin], l.sigma = std::max(spread[bin], 1e-12);
      l.level = levels_ + bin, l.level_sigma = error[bin];
    }
    levels_ += bins;
  }

  const Stack& stack_;
  PixelRadiances radiances_;
  double full_;
  std::size_t levels_ = 0;  // so far
};

// Shares by weighted least squares of residual = sum over columns of share * (overflow of its neighbours).
struct Shares {
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;
};
using Columns = std::vector<std::vector<std::size_t>>;  // neighbours that have one share

double over_of(const Look& look, const std::vector<std::size_t>& neighbours) {
  double sum = 0;
  for (const std::size_t k : neighbours) sum += look.over[k];
  return sum;
}

template <class Takes>
Shares fitted(const std::vector<Look>& looks, const Columns& columns, const Takes& takes) {
  const auto n = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  const auto row_of = [&](const Look& l) {
    Eigen::VectorXd row(n);
    for (Eigen::Index k = 0; k < n; ++k) row[k] = over_of(l, columns[static_cast<std::size_t>(k)]) / l.sigma;
    return row;
  };
  for (const Look& l : looks) {
    if (!takes(l)) continue;
    const Eigen::VectorXd row = row_of(l);
    a += row * row.transpose(), b += row * (l.residual / l.sigma);
  }
  Shares s;
  s.value = linear::solve_ldlt(a, b);
  std::map<std::size_t, Eigen::VectorXd> scores, of_levels;
  for (const Look& l : looks) {
    if (!takes(l)) continue;
    const Eigen::VectorXd row = row_of(l);
    auto& score = scores.try_emplace(l.part, Eigen::VectorXd::Zero(n)).first->second;
    score += row * (l.residual / l.sigma - row.dot(s.value));
    auto& of_level = of_levels.try_emplace(l.level, Eigen::VectorXd::Zero(n)).first->second;
    of_level += row * (l.level_sigma / l.sigma);  // an error that all of a level share
  }
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(n, n);
  for (const auto& [part, score] : scores) meat += score * score.transpose();
  const double parts = static_cast<double>(scores.size());
  meat *= parts / std::max(1.0, parts - 1);
  for (const auto& [level, shared] : of_levels) meat += shared * shared.transpose();
  const Eigen::MatrixXd half = linear::solve_ldlt(a, meat);
  s.covariance = linear::solve_ldlt(a, Eigen::MatrixXd(half.transpose()));
  return s;
}

// Relative RMSE of one half of the parts with the shares of the other.
void score_unseen(const std::vector<Look>& looks, const Columns& columns, Overflow& found) {
  double before = 0, after = 0, norm = 0, noise = 0;
  for (const std::size_t half : {std::size_t{0}, std::size_t{1}}) {
    const auto is_in = [half](const Look& l) { return (l.part / 1000 + l.part) % 2 == half; };
    const Shares s = fitted(looks, columns, [&](const Look& l) { return !is_in(l); });
    for (const Look& l : looks) {
      if (!is_in(l)) continue;
      double flowed = 0;
      for (std::size_t k = 0; k < columns.size(); ++k)
        flowed += std::max(0.0, s.value[static_cast<Eigen::Index>(k)]) * over_of(l, columns[k]);
      before += l.residual * l.residual, after += std::pow(l.residual - flowed, 2);
      norm += l.reading() * l.reading(), noise += l.sigma * l.sigma;
    }
  }
  found.with = std::sqrt(before / norm), found.without = std::sqrt(after / norm);
  found.repaired = before > noise ? std::min(1.0, (before - after) / (before - noise)) : 0;
}

}  // namespace

Overflow find_overflow(const Stack& stack, const ReadingNoise& noise) {
  Overflow found;
  Looks looking(stack, noise);
  const std::vector<Look> looks = looking.all();
  found.readings = looks.size(), found.full_scale = looking.full();
  if (looks.size() < fewest) return found;
  const auto all = [](const Look&) { return true; };
  const Shares sides = fitted(looks, {{0}, {1}, {2}, {3}}, all);
  const Columns columns = {{0, 1}, {2, 3}};
  const Shares shares = fitted(looks, columns, all);
  double least_p = 1;
  std::array<double, 2> value{}, sigma{};
  for (Eigen::Index d = 0; d < 2; ++d) {
    const auto z_of = [](const Shares& s, Eigen::Index k) { return s.value[k] / std::sqrt(s.covariance(k, k)); };
    value[static_cast<std::size_t>(d)] = std::max(0.0, shares.value[d]);
    sigma[static_cast<std::size_t>(d)] = std::sqrt(shares.covariance(d, d));
    if (!(z_of(sides, 2 * d) > each_side && z_of(sides, 2 * d + 1) > each_side)) continue;
    least_p = std::min(least_p, 2 * stats::normal_upper(z_of(shares, d)));  // two directions are looked at
  }
  if (!(least_p <= most_by_chance)) return found;
  found.p = std::max(least_p, std::numeric_limits<double>::min());
  found.along = value[0], found.across = value[1], found.sigma_along = sigma[0], found.sigma_across = sigma[1];
  score_unseen(looks, columns, found);
  double flowed = 0, readings = sum_of_squared_readings(stack);
  for (const Look& l : looks) {
    flowed += std::pow(found.along * over_of(l, columns[0]) + found.across * over_of(l, columns[1]), 2);
    readings += l.reading() * l.reading();
  }
  found.effect = std::sqrt(flowed / readings);
  return found;
}

void conclude_overflow(const Problem& problem, const Overflow& found, std::size_t candidate, Explanation& e) {
  const std::vector<std::size_t>& numbers = problem.candidates()[candidate].parameters;
  inference::Apart apart{.candidate = candidate, .estimates = {}, .p = found.p, .effect = found.effect};
  apart.with = found.with, apart.without = found.without;
  if (!(found.repaired >= least_repaired))
    apart.refused = "little of what readings beside clipped pixels depart by, where it was not fitted to them";
  const double values[] = {found.along, found.across, found.full_scale};
  const double sigmas[] = {found.sigma_along, found.sigma_across, 0};
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    e.values[numbers[k]] = values[k], e.sigma[numbers[k]] = sigmas[k];
    const double reach = 1.96 * sigmas[k];
    if (k < 2)
      apart.estimates.push_back(
          {numbers[k], values[k], sigmas[k], std::max(0.0, values[k] - reach), values[k] + reach, values[k] == 0});
  }
  inference::join(problem, apart, e);
}

std::string overflow_remark(const Overflow& found) {
  return "What flows over from clipped pixels was seen in " + std::to_string(found.readings) +
         " readings beside them, which are left out of everything else; it takes those that were not fitted from " +
         inference::share_in_words(found.with) + " to " + inference::share_in_words(found.without) +
         " (relative RMSE).";
}

}  // namespace gonio::explain::stacks
