// See projector_tone.h.
#include "scan/projector_tone.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "geom/vector.h"
#include "linear/positive.h"
#include "optim/descent.h"
#include "scan/mechanisms/projector_gamma.h"
#include "scan/shift_fit.h"

namespace gonio::scan {
namespace {

constexpr double least_gamma_off = 0.02, least_level = 0.015, level_sigmas = 5;
constexpr double own_error = 0.001;  // of any level: light that is spread over projector's pixels
constexpr std::size_t fewest_shifts = 5, fewest_tone_pixels = 300, of_grid = 300, of_valleys = 1000, tone_tiles = 64,
                      tone_places = 1440;
constexpr int pixel_steps = 6, tone_steps = 12;
constexpr double cauchy_tone = 2.385, most_turn = 0.3, least_between = 0.3;
constexpr std::size_t begun = 3;
constexpr std::pair<bool, bool> levels_to_look_for[] = {{false, false}, {false, true}, {true, false}, {true, true}};
constexpr double least_better = 25, least_less = 0.01;  // chi-square: for a level more; of a step

// gamma, dark, bright.
using Tone = std::array<double, 3>;
constexpr Tone least_tone{0.3, 0, 0.4}, most_tone{4, 0.6, 1};
constexpr Tone tone_step{0.004, 0.002, -0.002};

double light_of_tone(const Tone& t, double sent) {
  return equation::projector_gamma(std::clamp(sent, t[1], t[2]), std::array{t[0]});
}

// By phase of the cosine that is sent.
class ToneTable {
 public:
  explicit ToneTable(const Tone& tone) : light_(tone_places + 2) {
    for (std::size_t k = 0; k < light_.size(); ++k)
      light_[k] = light_of_tone(tone, 0.5 + 0.5 * std::cos(2 * pi * static_cast<double>(k) / tone_places));
  }
  struct At {
    double light = 0, slope = 0;  // per radian
  };
  At operator()(double x) const {
    const double turns = x * (0.5 / pi), place = (turns - std::floor(turns)) * tone_places;
    const auto k = static_cast<std::size_t>(place);
    const double step = light_[k + 1] - light_[k];
    return {light_[k] + (place - static_cast<double>(k)) * step, step * (tone_places * 0.5 / pi)};
  }

 private:
  std::vector<double> light_;
};

// By tile of the picture the gradients that lead down; what is not free has none.
struct Model {
  std::array<double, 9> normal{};
  std::array<Tone, tone_tiles> downhill{};
};

struct Step {
  Tone step{}, sigma{};
  double promised = 0;
};
// The step downhill; and standard deviations, H^-1 (sum over tiles of their gradients' squares) H^-1.
Step solved(const Model& m, std::array<bool, 3> free, double damping) {
  std::array<double, 9> h = m.normal, inverted{};
  for (std::size_t p = 0; p < 3; ++p) h[4 * p] = free[p] ? (1 + damping) * h[4 * p] + 1e-12 : 1;
  Step s;
  if (!linear::positive_inverse<3>(h, inverted)) return s;
  for (std::size_t p = 0; p < 3; ++p) {
    double square = 0, along = 0;
    for (const Tone& g : m.downhill) {
      double own = 0;
      for (std::size_t q = 0; q < 3; ++q) own += inverted[3 * p + q] * g[q];
      s.step[p] += own, square += own * own, along += g[p];
    }
    s.sigma[p] = free[p] ? std::sqrt(square * tone_tiles / (tone_tiles - 1)) : 0;
    s.promised += s.step[p] * (along + damping * m.normal[4 * p] * s.step[p]);
  }
  return s;
}

class ToneFit {
 public:
  explicit ToneFit(const ToneReadings& seen)
      : seen_(seen), shifts_(seen.shifts_rad.size()), pixels_(seen.sigmas.size()), phases_(pixels_) {
    const Mat3 solve = shift_fit(seen.shifts_rad);
    for (std::size_t i = 0; i < pixels_; ++i) {
      Vec3 sums;
      for (std::size_t k = 0; k < shifts_; ++k)
        sums += Vec3{1, std::cos(seen.shifts_rad[k]), std::sin(seen.shifts_rad[k])} * reading(i, k);
      const Vec3 fit = solve * sums;
      phases_[i] = std::atan2(fit.z, fit.y);
    }
  }

  std::size_t pixels() const { return pixels_; }

  // What is left of each pixel's readings over their sigma.
  void leave(const Tone& tone, std::size_t stride, std::vector<double>& left) const {
    const ToneTable table(tone);
    left.resize(pixels_ * shifts_);
    parallel_for(
        0, (pixels_ + stride - 1) / stride,
        [&](std::size_t n) { leave_pixel(table, n * stride, &left[n * stride * shifts_]); }, 64);
  }

  static double weight(double chi_square, double freedom) {
    return 1 / (1 + chi_square / (freedom * cauchy_tone * cauchy_tone));
  }
  // Chi-square where there are no outliers.
  double loss(const Tone& tone, std::size_t stride) const {
    std::vector<double> left;
    leave(tone, stride, left);
    double sum = 0;
    for (std::size_t i = 0; i < pixels_; i += stride) sum -= std::log(weight(chi_square(left, i), freedom()));
    return freedom() * cauchy_tone * cauchy_tone * sum;
  }

  // A level that lies beyond all that is sent has no slope, and wrong ones may lie in valleys of their own: where to
  // begin is looked for. The best of each number of levels, the best exponents first.
  std::vector<Tone> begin(std::optional<double> gamma, bool dark, bool bright) const {
    const std::size_t stride = std::max<std::size_t>(1, pixels_ / of_grid);
    std::vector<std::pair<double, Tone>> all;
    for (const double g : gamma ? std::vector{*gamma} : std::vector{0.5, 0.7, 1.0, 1.4, 2.0, 2.8}) {
      std::pair<double, Tone> best{-1, {}};
      for (const double d : dark ? std::vector{0.03, 0.08, 0.15, 0.25, 0.4} : std::vector{0.0})
        for (const double b : bright ? std::vector{0.97, 0.92, 0.85, 0.75, 0.6} : std::vector{1.0}) {
          if (b - d < least_between) continue;
          const double own = loss({g, d, b}, stride);
          if (best.first < 0 || own < best.first) best = {own, {g, d, b}};
        }
      all.push_back(best);
    }
    std::ranges::sort(all, {}, &std::pair<double, Tone>::first);
    std::vector<Tone> tones;
    for (std::size_t k = 0; k < std::min(all.size(), begun); ++k) tones.push_back(all[k].second);
    return tones;
  }

  struct Found {
    Tone tone{}, sigma{};
    double chi_square = 0;
  };
  // Of `free` numbers, from there on.
  Found fit(const Tone& at, std::array<bool, 3> free, std::size_t stride) const {
    Down down(*this, at, free, stride);
    optim::Limits limits;
    limits.most_steps = tone_steps, limits.most_trials = 2 * tone_steps, limits.small_fall = {0, least_less};
    const double least = optim::descend(down, loss(at, stride), limits).cost;
    Tone sigma = solved(model(down.at(), free, stride), free, 0).sigma;
    for (double& own : sigma) own = std::hypot(own, own_error);
    return {down.at(), sigma, least};
  }

 private:
  class Down final : public optim::Descent {
   public:
    Down(const ToneFit& fit, const Tone& at, std::array<bool, 3> free, std::size_t stride)
        : fit_(fit), at_(at), next_(at), free_(free), stride_(stride) {}
    const Tone& at() const { return at_; }
    void linearise() override { model_ = fit_.model(at_, free_, stride_); }
    optim::Proposal propose(double damping) override {
      const Step s = solved(model_, free_, damping);
      next_ = at_;
      for (std::size_t p = 0; p < 3; ++p)
        if (free_[p]) next_[p] = std::clamp(at_[p] + s.step[p], least_tone[p], most_tone[p]);
      return {.promised = s.promised};
    }
    double evaluate() override { return fit_.loss(next_, stride_); }
    void accept() override { at_ = next_; }

   private:
    const ToneFit& fit_;
    Tone at_, next_;
    std::array<bool, 3> free_;
    std::size_t stride_;
    Model model_;
  };

  double reading(std::size_t i, std::size_t k) const { return seen_.readings[i * shifts_ + k]; }
  double freedom() const { return static_cast<double>(shifts_ - 3); }
  double chi_square(const std::vector<double>& left, std::size_t i) const {
    double sum = 0;
    for (std::size_t k = i * shifts_; k < (i + 1) * shifts_; ++k) sum += left[k] * left[k];
    return sum;
  }

  struct Lit {
    double theta = 0, light = 0;  // light: what white adds
  };
  Lit leave_pixel(const ToneTable& table, std::size_t i, double* left) const {
    double theta = phases_[i];
    for (int step = 0; step < pixel_steps; ++step) {
      std::array<double, 9> normal{}, inverted{};
      Vec3 right;
      for (std::size_t k = 0; k < shifts_; ++k) {
        const ToneTable::At at = table(theta - seen_.shifts_rad[k]);
        const double v = reading(i, k), row[3] = {1, at.light, at.slope};
        right += Vec3{row[0], row[1], row[2]} * v;
        for (std::size_t a = 0; a < 3; ++a)
          for (std::size_t b = 0; b <= a; ++b) normal[3 * a + b] += row[a] * row[b];
      }
      if (!linear::positive_inverse<3>(normal, inverted)) break;
      const Vec3 fit = Mat3{inverted} * right;
      if (fit.y > 0) theta += std::clamp(fit.z / fit.y, -most_turn, most_turn);
    }
    // Of light and mean alone, at that phase.
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t k = 0; k < shifts_; ++k) {
      const double x = table(theta - seen_.shifts_rad[k]).light, y = reading(i, k);
      left[k] = x, ++n, sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    const double spread = sxx - sx * sx / n, slope = spread > 0 ? (sxy - sx * sy / n) / spread : 0;
    for (std::size_t k = 0; k < shifts_; ++k)
      left[k] = (reading(i, k) - sy / n - slope * (left[k] - sx / n)) / seen_.sigmas[i];
    return {theta, slope};
  }

  // What a pixel's residuals change by with the tone, by `tables` beside `table`: that of light, without what the
  // pixel's own numbers make up for (Kaufman 1975).
  void slope_pixel(const ToneTable& table, const std::array<std::optional<ToneTable>, 3>& tables, std::size_t i,
                   const Lit& lit, std::array<std::vector<double>, 3>& moved) const {
    std::array<double, 9> normal{}, inverted{};
    std::array<Vec3, 3> with{};
    for (std::size_t k = 0; k < shifts_; ++k) {
      const double x = lit.theta - seen_.shifts_rad[k];
      const ToneTable::At at = table(x);
      const double row[3] = {1, at.light, at.slope};
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b <= a; ++b) normal[3 * a + b] += row[a] * row[b];
      for (std::size_t p = 0; p < 3; ++p) {
        if (!tables[p]) continue;
        moved[p][i * shifts_ + k] = ((*tables[p])(x).light - at.light) / tone_step[p];
        with[p] += Vec3{row[0], row[1], row[2]} * moved[p][i * shifts_ + k];
      }
    }
    const bool whole = linear::positive_inverse<3>(normal, inverted);
    for (std::size_t p = 0; p < 3; ++p) {
      const Vec3 own = whole ? Mat3{inverted} * with[p] : Vec3{};
      for (std::size_t k = 0; tables[p] && k < shifts_; ++k) {
        const ToneTable::At at = table(lit.theta - seen_.shifts_rad[k]);
        double& slope = moved[p][i * shifts_ + k];
        slope = whole ? -lit.light / seen_.sigmas[i] * (slope - dot(own, {1, at.light, at.slope})) : 0;
      }
    }
  }

  Model model(const Tone& at, std::array<bool, 3> free, std::size_t stride) const {
    std::vector<double> left(pixels_ * shifts_);
    std::array<std::vector<double>, 3> moved;
    const ToneTable table(at);
    std::array<std::optional<ToneTable>, 3> tables;
    for (std::size_t p = 0; p < 3; ++p) {
      Tone beside = at;
      beside[p] += tone_step[p];
      if (free[p]) tables[p].emplace(beside), moved[p].resize(left.size());
    }
    parallel_for(
        0, (pixels_ + stride - 1) / stride,
        [&](std::size_t n) {
          slope_pixel(table, tables, n * stride, leave_pixel(table, n * stride, &left[n * stride * shifts_]), moved);
        },
        64);
    Model m;
    for (std::size_t i = 0; i < pixels_; i += stride) {
      const double w = weight(chi_square(left, i), freedom());
      for (std::size_t k = i * shifts_; k < (i + 1) * shifts_; ++k) {
        std::array<double, 3> slope{};
        for (std::size_t p = 0; p < 3; ++p)
          if (free[p]) slope[p] = moved[p][k];
        for (std::size_t a = 0; a < 3; ++a) {
          m.downhill[seen_.tiles[i]][a] -= w * slope[a] * left[k];
          for (std::size_t b = 0; b <= a; ++b) m.normal[3 * a + b] += w * slope[a] * slope[b];
        }
      }
    }
    return m;
  }

  const ToneReadings& seen_;
  std::size_t shifts_, pixels_;
  std::vector<double> phases_;
};

}  // namespace

bool ProjectorTone::bends() const {
  return below || above || std::abs(gamma - 1) > std::max(3 * gamma_sigma, least_gamma_off);
}

double ProjectorTone::light(double sent) const {
  return light_of_tone({gamma, below ? below->level : 0, above ? above->level : 1}, sent);
}

std::vector<ProjectorTone> ProjectorTone::varied() const {
  std::vector<ProjectorTone> all{*this};
  if (gamma_sigma > 0) all.push_back(*this), all.back().gamma += gamma_sigma;
  if (below) all.push_back(*this), all.back().below->level += below->sigma;
  if (above) all.push_back(*this), all.back().above->level += above->sigma;
  return all;
}

std::optional<ProjectorTone> flat_tone(const ToneReadings& seen, std::optional<FlatLevel> gamma) {
  if (seen.shifts_rad.size() < fewest_shifts || seen.sigmas.size() < fewest_tone_pixels) return std::nullopt;
  const ToneFit fit(seen);
  const std::size_t some = std::max<std::size_t>(1, fit.pixels() / of_valleys);
  std::optional<ToneFit::Found> found;
  for (const auto& [dark, bright] : levels_to_look_for) {
    const std::array<bool, 3> free{!gamma, dark, bright};
    std::optional<ToneFit::Found> own;
    for (const Tone& at : fit.begin(gamma ? std::optional(gamma->level) : std::nullopt, dark, bright)) {
      const ToneFit::Found next = fit.fit(at, free, some);
      if (!own || next.chi_square < own->chi_square) own = next;
    }
    own = fit.fit(own->tone, free, 1);
    const auto told = [&](bool looked_for, double depth, double sigma) {
      return !looked_for || depth > std::max(least_level, level_sigmas * sigma);
    };
    if (!told(dark, own->tone[1], own->sigma[1]) || !told(bright, 1 - own->tone[2], own->sigma[2])) continue;
    if (!found || own->chi_square < found->chi_square - least_better) found = own;
  }
  const auto level = [&](std::size_t p, double none) {
    return found->tone[p] != none ? std::optional(FlatLevel{found->tone[p], found->sigma[p]}) : std::nullopt;
  };
  ProjectorTone tone{found->tone[0], gamma ? gamma->sigma : found->sigma[0], level(1, 0), level(2, 1)};
  if (!tone.below && !tone.above) return std::nullopt;
  return tone;
}

}  // namespace gonio::scan
