// See spectrum_model.h.
#include "explain/heights/spectrum_model.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geom/vector.h"
#include "linear/solve.h"
#include "optim/least_squares.h"
#include "stats/intervals.h"

namespace gonio::explain::heights {
namespace {

constexpr std::size_t knot_count = 10;
constexpr double response_reach = 8;  // bins beyond which the window passes less than 1e-6 of a line
constexpr std::size_t tried_lines = 8;
constexpr double stands_out = 3;   // times the curve: a harmonic that is there
constexpr double a_line_too = 12;  // noise variances by which a line of twice or three times the period must help alone

// Mean over tiles of ln P, freed of its bias.
std::vector<double> mean_log(const std::vector<Tile>& tiles, std::size_t ordinates) {
  std::vector<double> mean(ordinates, euler_gamma);
  for (const Tile& tile : tiles)
    for (std::size_t i = 0; i < ordinates; ++i) mean[i] += tile.log_power[i] / static_cast<double>(tiles.size());
  return mean;
}

// Of every ordinate, the median over the ring of its frequency: lines fill little of a ring.
std::vector<double> ring_medians(const TileSpectra& spectra, const std::vector<double>& mean) {
  std::vector<std::vector<double>> rings;
  std::vector<std::size_t> ring;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    const Ordinate& o = spectra.ordinates[i];
    const double cycles = std::hypot(o.fx * spectra.step_x_m, o.fy * spectra.step_y_m) * static_cast<double>(spectra.n);
    ring.push_back(static_cast<std::size_t>(cycles + 0.5));
    if (ring.back() >= rings.size()) rings.resize(ring.back() + 1);
    rings[ring.back()].push_back(mean[i]);
  }
  std::vector<double> medians, result;
  for (const std::vector<double>& values : rings) medians.push_back(stats::median(values));
  for (std::size_t i = 0; i < mean.size(); ++i) result.push_back(medians[ring[i]]);
  return result;
}

}  // namespace

SpectrumModel::SpectrumModel(const TileSpectra& spectra) : spectra_(spectra) {
  for (const Ordinate& o : spectra.ordinates) {
    const double square = o.fx * o.fx + o.fy * o.fy;
    log_f_.push_back(0.5 * std::log(square));
    cos_2.push_back((o.fx * o.fx - o.fy * o.fy) / square);
    sin_2.push_back(2 * o.fx * o.fy / square);
  }
  const auto [least, most] = std::minmax_element(log_f_.begin(), log_f_.end());
  const double low = std::exp(0.5 * *least), high = std::exp(0.5 * *most);
  for (std::size_t k = 0; k < knot_count; ++k)
    knots_.push_back(low + (high - low) * static_cast<double>(k) / (knot_count - 1));
}

double SpectrumModel::knot_per_m(std::size_t k) const {
  return knots_[k] * knots_[k];
}

// Beyond the knots the last two are continued.
double SpectrumModel::curve(const std::vector<double>& log_density, double log_f) const {
  const double step = knots_[1] - knots_[0];
  const double place = (std::exp(0.5 * log_f) - knots_[0]) / step;
  const auto k = static_cast<std::size_t>(std::clamp(std::floor(place), 0.0, static_cast<double>(knot_count - 2)));
  const double t = place - static_cast<double>(k);
  return (1 - t) * log_density[k] + t * log_density[k + 1];
}

double SpectrumModel::roughness_at(const SpectrumState& s, double log_f, double cosine_2, double sine_2) const {
  return curve(s.log_density, log_f - (s.a0 * cosine_2 + s.a45 * sine_2));
}
double SpectrumModel::roughness_at(const SpectrumState& s, std::size_t i) const {
  return roughness_at(s, log_f_[i], cos_2[i], sin_2[i]);
}

void SpectrumModel::predict(const SpectrumState& s, double level, std::span<double> log_power) const {
  const double nx = static_cast<double>(spectra_.n) * spectra_.step_x_m,
               ny = static_cast<double>(spectra_.n) * spectra_.step_y_m;
  const double gain = spectra_.line_gain(), points = static_cast<double>(spectra_.n);
  const double gx = std::cos(s.grating.azimuth_rad) / s.grating.period_m * nx,
               gy = std::sin(s.grating.azimuth_rad) / s.grating.period_m * ny;  // in bins
  for (std::size_t i = 0; i < spectra_.ordinates.size(); ++i) {
    const Ordinate& o = spectra_.ordinates[i];
    const double log_density = roughness_at(s, i) + level;
    double more = 0;
    if (s.grating.amplitude_m > 0)
      for (int k = 1; k <= static_cast<int>(harmonics); ++k) {
        const double share = k == 1 ? 1 : s.grating.harmonic[static_cast<std::size_t>(k - 2)];
        const double power = gain * s.grating.amplitude_m * s.grating.amplitude_m * share;
        for (const double side : {k, -k}) {
          const double x = o.kx - side * gx, y = o.ky - side * gy;
          if (std::abs(x) > response_reach || std::abs(y) > response_reach) continue;
          const double w = hann_response(x) * hann_response(y);
          more += power * w * w;
        }
      }
    if (s.row_variance_m2 > 0) {
      // |sum_y w_y e_y|^2 = R^2 sum w^2, |sum_x w_x|^2 = (n / 2)^2 W^2, over sum w^2 of both axes: 2 n / 3.
      const double w = hann_response(o.kx);
      more += s.row_variance_m2 * w * w * (2.0 / 3) * points * spectra_.step_x_m * spectra_.step_y_m;
    }
    log_power[i] = (more > 0 ? std::log(std::exp(log_density) + more) : log_density) - euler_gamma;
  }
}

std::vector<double> SpectrumModel::start(const std::vector<Tile>& tiles) const {
  const std::vector<double> mean = ring_medians(spectra_, mean_log(tiles, log_f_.size()));
  Eigen::MatrixXd h = Eigen::MatrixXd::Identity(knot_count, knot_count) * 1e-9;
  Eigen::VectorXd b = Eigen::VectorXd::Zero(knot_count);
  for (std::size_t i = 0; i < mean.size(); ++i) {
    Eigen::VectorXd row(knot_count);
    for (std::size_t k = 0; k < knot_count; ++k) {
      std::vector<double> unit(knot_count, 0.0);
      unit[k] = 1;
      row[static_cast<Eigen::Index>(k)] = curve(unit, log_f_[i]);
    }
    h += row * row.transpose();
    b += row * mean[i];
  }
  const Eigen::VectorXd solution = linear::solve_ldlt(h, b);
  return {solution.data(), solution.data() + solution.size()};
}

SpectrumState SpectrumModel::without_lines(const std::vector<double>& mean) const {
  struct Smooth final : optim::Model {
    const SpectrumModel& model;
    const std::vector<double>& mean;
    double weight;
    Smooth(const SpectrumModel& m, const std::vector<double>& of, double w) : model(m), mean(of), weight(w) {}
    static SpectrumState state_of(const Eigen::VectorXd& x) {
      SpectrumState s;
      s.log_density.assign(x.data(), x.data() + knot_count);
      s.a0 = x[knot_count], s.a45 = x[knot_count + 1];
      return s;
    }
    bool residuals(const Eigen::VectorXd& x, Eigen::VectorXd& r) const override {
      const SpectrumState s = state_of(x);
      r.resize(static_cast<Eigen::Index>(mean.size()));
      for (std::size_t i = 0; i < mean.size(); ++i)
        r[static_cast<Eigen::Index>(i)] = weight * (mean[i] - model.roughness_at(s, i));
      return r.allFinite();
    }
  };
  const std::vector<double> knots = start(spectra_.searched);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(knot_count + 2);
  x.head(knot_count) = Eigen::Map<const Eigen::VectorXd>(knots.data(), knot_count);
  const Smooth smooth(*this, mean, std::sqrt(static_cast<double>(spectra_.searched.size())) / log_sigma);
  return Smooth::state_of(
      optim::fit(smooth, x, {.lower = {}, .upper = {}, .priors = {}, .loss = optim::Loss::cauchy}).x);
}

// Amplitudes by least squares of the power over the roughness about the frequency and its multiples.
Grating SpectrumModel::grating_at(double fx, double fy, const std::vector<double>& mean,
                                  const SpectrumState& beneath) const {
  Grating g;
  g.period_m = 1 / std::hypot(fx, fy);
  g.azimuth_rad = std::atan2(fy, fx);
  std::array<double, harmonics> power{}, weight{};
  const double length_x = static_cast<double>(spectra_.n) * spectra_.step_x_m,
               length_y = static_cast<double>(spectra_.n) * spectra_.step_y_m;
  for (std::size_t i = 0; i < mean.size(); ++i)
    for (std::size_t k = 0; k < harmonics; ++k) {
      const double times = static_cast<double>(k + 1), x = spectra_.ordinates[i].kx - times * fx * length_x,
                   y = spectra_.ordinates[i].ky - times * fy * length_y;
      if (std::abs(x) > 1.5 || std::abs(y) > 1.5) continue;
      const double w = std::pow(hann_response(x) * hann_response(y), 2);
      power[k] += w * (std::exp(mean[i]) - std::exp(roughness_at(beneath, i)));
      weight[k] += w * w;
    }
  for (std::size_t k = 0; k < harmonics; ++k) power[k] = weight[k] > 0 ? std::max(0.0, power[k] / weight[k]) : 0;
  g.amplitude_m = std::sqrt(power[0] / spectra_.line_gain());
  for (std::size_t k = 1; k < harmonics; ++k) {
    const double times = static_cast<double>(k + 1),
                 rough = std::exp(roughness_at(beneath, std::log(times / g.period_m), std::cos(2 * g.azimuth_rad),
                                               std::sin(2 * g.azimuth_rad)));
    g.harmonic[k - 1] = power[k] > stands_out * rough && power[0] > 0 ? std::min(4.0, power[k] / power[0]) : 0;
  }
  return g;
}

double SpectrumModel::misfit(const SpectrumState& state, const std::vector<double>& mean) const {
  std::vector<double> predicted(mean.size());
  predict(state, euler_gamma, predicted);
  double sum = 0;
  for (std::size_t i = 0; i < mean.size(); ++i) sum += (mean[i] - predicted[i]) * (mean[i] - predicted[i]);
  return sum;
}

Grating SpectrumModel::search() const {
  const std::vector<double> mean = mean_log(spectra_.searched, log_f_.size());
  SpectrumState state = without_lines(mean);
  std::vector<std::size_t> strongest(mean.size()), outstanding;
  for (std::size_t i = 0; i < mean.size(); ++i) strongest[i] = i;
  outstanding = strongest;
  const auto excess = [&](std::size_t i) { return mean[i] - roughness_at(state, i); };
  std::sort(strongest.begin(), strongest.end(), [&](std::size_t a, std::size_t b) { return mean[a] > mean[b]; });
  std::sort(outstanding.begin(), outstanding.end(),
            [&](std::size_t a, std::size_t b) { return excess(a) > excess(b); });
  strongest.resize(std::min(tried_lines, strongest.size()));
  strongest.insert(strongest.end(), outstanding.begin(),
                   outstanding.begin() + static_cast<std::ptrdiff_t>(std::min(tried_lines, outstanding.size())));
  Grating best;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t peak : strongest) {
    // The place between ordinates: the middle of the power about the peak.
    double sum = 0, fx = 0, fy = 0;
    for (std::size_t i = 0; i < mean.size(); ++i) {
      const Ordinate &o = spectra_.ordinates[i], &at = spectra_.ordinates[peak];
      if (std::abs(o.kx - at.kx) > 1 || std::abs(o.ky - at.ky) > 1) continue;
      const double power = std::exp(mean[i]);
      sum += power, fx += power * o.fx, fy += power * o.fy;
    }
    state.grating = grating_at(fx / sum, fy / sum, mean, state);
    if (!(state.grating.amplitude_m > 0)) continue;
    const double found = misfit(state, mean);
    if (found < least) least = found, best = state.grating;
  }
  return longest(best, state, mean);
}

// Harmonics may help more than their fundamental, of which fewer multiples are looked at: where two or three times the
// period has a line of its own, and a higher one, it is the period.
Grating SpectrumModel::longest(const Grating& found, SpectrumState state, const std::vector<double>& mean) const {
  state.grating = {};
  const double without = misfit(state, mean),
               variance = log_sigma * log_sigma / static_cast<double>(spectra_.searched.size());
  for (const double times : {3.0, 2.0}) {
    const double f = 1 / (times * found.period_m);
    const Grating longer = grating_at(f * std::cos(found.azimuth_rad), f * std::sin(found.azimuth_rad), mean, state);
    if (!(longer.amplitude_m > found.amplitude_m)) continue;
    state.grating = longer;
    state.grating.harmonic = {};
    if (without - misfit(state, mean) > a_line_too * variance) return longer;
  }
  return found;
}

}  // namespace gonio::explain::heights
