// See ground_noise.h.
#include "relief/ground_noise.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "linear/solve.h"
#include "optim/damped.h"
#include "optim/descent.h"
#include "relief/areal.h"
#include "relief/fft.h"

namespace gonio::relief {
namespace {

constexpr double fewest_cycles = 3;
constexpr double neighbours = 3.78, overlaps = 1.11;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The tiles of one map.
struct Periodograms {
  std::size_t n = 0;
  double step_x = 0, step_y = 0;
  std::vector<std::size_t> ordinate;  // ky n + kx of one half plane
  std::vector<double> per_m;          // |f|
  std::vector<VectorXd> tiles;        // P
  VectorXd mean;
};

std::size_t tiles_along(std::size_t points, std::size_t n) {
  return points < n ? 0 : 2 * points / n - 1;
}

std::optional<VectorXd> periodogram(const io::HeightMap& map, std::size_t left, std::size_t top,
                                    const Periodograms& p) {
  const std::size_t n = p.n;
  io::HeightMap tile{n, n, map.step_x_m, map.step_y_m, {}};
  std::size_t missing = 0;
  for (std::size_t i = 0; i < n * n; ++i) {
    tile.z_m.push_back(map.at(left + i % n, top + i / n));
    missing += !std::isfinite(tile.z_m.back());
  }
  if (50 * missing > n * n) return {};
  const std::vector<double> z = treated(tile, {.levelling = Levelling::plane}, "tile").map.z_m;
  std::vector<Complex> data(n * n);
  double squares = 0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double w = hann(i % n, n) * hann(i / n, n);
    squares += w * w;
    data[i] = std::isfinite(z[i]) ? w * z[i] : 0;
  }
  transform_square(data, n);
  VectorXd power(static_cast<Eigen::Index>(p.ordinate.size()));
  for (std::size_t k = 0; k < p.ordinate.size(); ++k)
    power[static_cast<Eigen::Index>(k)] = std::norm(data[p.ordinate[k]]) * map.step_x_m * map.step_y_m / squares;
  return power;
}

Periodograms periodograms_of(const io::HeightMap& map, const std::string& place) {
  Periodograms p;
  for (const std::size_t n : {128u, 64u, 32u}) {
    p.n = n;
    if (tiles_along(map.width, n) * tiles_along(map.height, n) >= 36) break;
  }
  const std::size_t n = p.n, columns = tiles_along(map.width, n), rows = tiles_along(map.height, n);
  p.step_x = map.step_x_m, p.step_y = map.step_y_m;
  for (std::size_t ky = 0; ky < n; ++ky)
    for (std::size_t kx = 0; kx <= n / 2; ++kx) {
      const double y = ky < n / 2 ? static_cast<double>(ky) : static_cast<double>(ky) - static_cast<double>(n),
                   x = static_cast<double>(kx);
      const bool own_mirror = kx == 0 || kx == n / 2;
      if ((own_mirror && (y <= 0 || ky == n / 2)) || std::hypot(x, y) < fewest_cycles) continue;
      p.ordinate.push_back(ky * n + kx);
      p.per_m.push_back(std::hypot(x / (static_cast<double>(n) * p.step_x), y / (static_cast<double>(n) * p.step_y)));
    }
  std::vector<std::optional<VectorXd>> all(columns * rows);
  parallel_for(0, all.size(),
               [&](std::size_t t) { all[t] = periodogram(map, t % columns * n / 2, t / columns * n / 2, p); });
  for (auto& tile : all)
    if (tile) p.tiles.push_back(std::move(*tile));
  if (p.tiles.size() < 8)
    throw Error(Exit::data, place, "has " + std::to_string(p.tiles.size()) + " tiles of 32 x 32 points without gaps",
                "the spectrum needs eight: measure a larger field");
  p.mean = VectorXd::Zero(p.tiles[0].size());
  for (const VectorXd& tile : p.tiles) p.mean += tile / static_cast<double>(p.tiles.size());
  return p;
}

// E P of a field of variance 1 whose correlation is that of noise with cells of cell_m; cell_m = 0: white.
VectorXd expected(const Periodograms& p, double cell_m) {
  const auto n = static_cast<std::ptrdiff_t>(p.n);
  std::vector<double> window(p.n), overlap(p.n);
  for (std::size_t i = 0; i < p.n; ++i) window[i] = hann(i, p.n);
  for (std::size_t d = 0; d < p.n; ++d)
    for (std::size_t i = 0; i + d < p.n; ++i) overlap[d] += window[i] * window[i + d];
  std::vector<Complex> data(p.n * p.n);
  const auto reach = [&](double step) {
    return cell_m > 0 ? std::min(n - 1, static_cast<std::ptrdiff_t>(std::ceil(cell_m / step))) : 0;
  };
  const std::ptrdiff_t most_x = reach(p.step_x), most_y = reach(p.step_y);
  for (std::ptrdiff_t y = -most_y; y <= most_y; ++y)
    for (std::ptrdiff_t x = -most_x; x <= most_x; ++x) {
      const double c =
          cell_m > 0 ? noise_correlation(
                           std::hypot(static_cast<double>(x) * p.step_x, static_cast<double>(y) * p.step_y) / cell_m)
                     : 1;
      data[static_cast<std::size_t>((y + n) % n * n + (x + n) % n)] +=
          c * overlap[static_cast<std::size_t>(std::abs(x))] * overlap[static_cast<std::size_t>(std::abs(y))];
    }
  transform_square(data, p.n);
  VectorXd power(static_cast<Eigen::Index>(p.ordinate.size()));
  const double scale = p.step_x * p.step_y / (overlap[0] * overlap[0]);
  for (std::size_t k = 0; k < p.ordinate.size(); ++k)
    power[static_cast<Eigen::Index>(k)] = std::max(0.0, data[p.ordinate[k]].real()) * scale;
  return power;
}

// theta: ln Sq^2 and ln cell of every part, then ln white^2.
struct Model {
  VectorXd power;   // E P
  MatrixXd slopes;  // of ln E P by theta
};
Model model_of(const Periodograms& p, const VectorXd& theta) {
  const Eigen::Index parts = theta.size() / 2, size = static_cast<Eigen::Index>(p.ordinate.size());
  Model m{VectorXd::Zero(size), MatrixXd::Zero(size, theta.size())};
  constexpr double step = 0.01;
  for (Eigen::Index i = 0; i < parts; ++i) {
    const double variance = std::exp(theta[2 * i]), cell = std::exp(theta[2 * i + 1]);
    const VectorXd own = variance * expected(p, cell);
    m.power += own;
    m.slopes.col(2 * i) = own;
    m.slopes.col(2 * i + 1) =
        variance * (expected(p, cell * std::exp(step)) - expected(p, cell * std::exp(-step))) / (2 * step);
  }
  m.slopes.col(2 * parts) = std::exp(theta[2 * parts]) * expected(p, 0);
  m.power += m.slopes.col(2 * parts);
  m.power = m.power.cwiseMax(std::numeric_limits<double>::min());
  for (Eigen::Index k = 0; k < theta.size(); ++k) m.slopes.col(k) = m.slopes.col(k).cwiseQuotient(m.power);
  return m;
}

double whittle(const std::vector<Periodograms>& all, const std::vector<Model>& models) {
  double sum = 0;
  for (std::size_t a = 0; a < all.size(); ++a)
    sum += static_cast<double>(all[a].tiles.size()) *
           (models[a].power.array().log() + all[a].mean.array() / models[a].power.array()).sum();
  return sum;
}

std::vector<Model> models_of(const std::vector<Periodograms>& all, const VectorXd& theta) {
  std::vector<Model> models(all.size());
  for (std::size_t a = 0; a < all.size(); ++a) models[a] = model_of(all[a], theta);
  return models;
}

struct Fitted {
  VectorXd theta;
  std::vector<Model> models;
  double objective = 0;
};

// Fisher scoring.
struct Scoring final : optim::Descent {
  const std::vector<Periodograms>& all;
  Fitted at, there;
  MatrixXd information;
  VectorXd score;

  Scoring(const std::vector<Periodograms>& of, VectorXd theta) : all(of) {
    at.theta = std::move(theta);
    at.objective = objective_of(at);
  }
  double objective_of(Fitted& fit) const {
    fit.models = models_of(all, fit.theta);
    return whittle(all, fit.models);
  }
  void linearise() override {
    information = MatrixXd::Zero(at.theta.size(), at.theta.size());
    score = VectorXd::Zero(at.theta.size());
    for (std::size_t a = 0; a < all.size(); ++a) {
      const Model& m = at.models[a];
      const auto tiles = static_cast<double>(all[a].tiles.size());
      information += tiles * m.slopes.transpose() * m.slopes;
      score += tiles * m.slopes.transpose() * (all[a].mean.cwiseQuotient(m.power).array() - 1).matrix();
    }
    information.diagonal().array() += 1e-6;
  }
  optim::Proposal propose(double damping) override {
    VectorXd step = optim::damped_step(information, score, damping).change;
    const double largest = step.cwiseAbs().maxCoeff();
    if (largest > 1) step *= 1 / largest;
    there.theta = at.theta + step;
    return {score.dot(step) - 0.5 * step.dot(information * step), largest};
  }
  double evaluate() override { return there.objective = objective_of(there); }
  void accept() override { std::swap(at, there); }
};

Fitted scored(const std::vector<Periodograms>& all, VectorXd theta) {
  Scoring scoring(all, std::move(theta));
  optim::Limits limits;
  limits.most_trials = 60;
  limits.least_damping = 1e-9;
  limits.most_damping = 1e8;
  limits.small_fall = {0, 1e-4};  // of minus a logarithm of a likelihood: what is left changes no criterion
  limits.rounding = {0, 1e-6};
  optim::descend(scoring, scoring.at.objective, limits);
  return std::move(scoring.at);
}

// One part more where it helps most, of cells from two points to half a tile.
Fitted with_one_more(const std::vector<Periodograms>& all, const Fitted* before) {
  const Periodograms& p = all.front();
  const double step = std::min(p.step_x, p.step_y),
               longest = 0.6 * static_cast<double>(p.n) * std::max(p.step_x, p.step_y);
  double middle = 0;
  for (const Periodograms& a : all) middle += a.mean.mean() / (a.step_x * a.step_y) / static_cast<double>(all.size());
  Fitted best;
  best.objective = std::numeric_limits<double>::infinity();
  for (double cell = 2 * step; cell < longest; cell *= 1.6) {
    VectorXd theta(before == nullptr ? 3 : before->theta.size() + 2);
    const Eigen::Index last = theta.size() - 1;
    if (before != nullptr) theta.head(last - 2) = before->theta.head(last - 2);
    theta[last] = before == nullptr ? std::log(1e-3 * middle) : before->theta[before->theta.size() - 1];
    theta[last - 2] = std::log((before == nullptr ? 1 : 0.1) * middle), theta[last - 1] = std::log(cell);
    Fitted fit{theta, models_of(all, theta), 0};
    fit.objective = whittle(all, fit.models);
    if (fit.objective < best.objective) best = std::move(fit);
  }
  return scored(all, best.theta);
}

MatrixXd covariance_of(const std::vector<Periodograms>& all, const Fitted& fit) {
  const Eigen::Index size = fit.theta.size();
  MatrixXd information = MatrixXd::Zero(size, size), scatter = information;
  for (std::size_t a = 0; a < all.size(); ++a) {
    const Model& m = fit.models[a];
    information += static_cast<double>(all[a].tiles.size()) * m.slopes.transpose() * m.slopes;
    for (const VectorXd& tile : all[a].tiles) {
      const VectorXd g = m.slopes.transpose() * (tile.cwiseQuotient(m.power).array() - 1).matrix();
      scatter += g * g.transpose();
    }
  }
  // a part without power leaves its cell undetermined: a large sigma, not a division by zero
  information.diagonal().array() += 1e-6;
  const MatrixXd inverse = linear::inverse(information), model = neighbours * overlaps * inverse,
                 sandwich = overlaps * inverse * scatter * inverse;
  MatrixXd larger = model;
  for (Eigen::Index k = 0; k < size; ++k) {
    const double factor = std::sqrt(std::max(1.0, sandwich(k, k) / model(k, k)));
    larger.row(k) *= factor, larger.col(k) *= factor;
  }
  return larger;
}

void add_bands(const std::vector<Periodograms>& all, const Fitted& fit, GroundNoise& result) {
  const Periodograms& p = all.front();
  const auto [low, high] = std::minmax_element(p.per_m.begin(), p.per_m.end());
  constexpr std::size_t bands = 24;
  std::vector<double> count(bands), f(bands), measured(bands), modelled(bands);
  for (std::size_t k = 0; k < p.per_m.size(); ++k) {
    const double at = std::log(p.per_m[k] / *low) / std::log(*high / *low) * bands;
    const std::size_t b = std::min(bands - 1, static_cast<std::size_t>(at));
    const auto i = static_cast<Eigen::Index>(k);
    count[b] += 1, f[b] += p.per_m[k], measured[b] += p.mean[i], modelled[b] += fit.models[0].power[i];
  }
  double squares = 0;
  for (std::size_t b = 0; b < bands; ++b) {
    if (count[b] <= 0) continue;
    result.band_per_m.push_back(f[b] / count[b]);
    result.measured_m4.push_back(measured[b] / count[b]), result.modelled_m4.push_back(modelled[b] / count[b]);
    squares += std::pow(std::log(measured[b] / modelled[b]), 2);
  }
  result.log_rms = std::sqrt(squares / static_cast<double>(result.band_per_m.size()));
}

GroundNoise result_of(const std::vector<Periodograms>& all, const Fitted& fit) {
  GroundNoise result;
  const MatrixXd c = covariance_of(all, fit);
  const Eigen::Index parts = fit.theta.size() / 2;
  for (Eigen::Index i = 0; i < parts; ++i) {
    GroundPart part;
    part.sq_m = std::exp(0.5 * fit.theta[2 * i]), part.cell_m = std::exp(fit.theta[2 * i + 1]);
    part.sigma_sq_m = 0.5 * part.sq_m * std::sqrt(c(2 * i, 2 * i));
    part.sigma_cell_m = part.cell_m * std::sqrt(c(2 * i + 1, 2 * i + 1));
    result.parts.push_back(part);
  }
  std::sort(result.parts.begin(), result.parts.end(), [](const auto& a, const auto& b) { return a.cell_m > b.cell_m; });
  result.white_m = std::exp(0.5 * fit.theta[2 * parts]);
  result.sigma_white_m = 0.5 * result.white_m * std::sqrt(c(2 * parts, 2 * parts));
  double sum = 0, count = 0;
  for (std::size_t a = 0; a < all.size(); ++a) {
    const double tiles = static_cast<double>(all[a].tiles.size());
    sum += tiles / overlaps * (all[a].mean.cwiseQuotient(fit.models[a].power).array() - 1).square().sum();
    count += static_cast<double>(all[a].mean.size());
    result.tiles += all[a].tiles.size();
  }
  result.misfit = sum / count;
  add_bands(all, fit, result);
  return result;
}

}  // namespace

GroundNoise fit_ground_noise(const std::vector<io::HeightMap>& maps, const std::vector<std::string>& places,
                             const GroundOptions& options) {
  std::vector<Periodograms> all;
  double ordinates = 0;
  for (std::size_t a = 0; a < maps.size(); ++a) {
    all.push_back(periodograms_of(maps[a], places[a]));
    ordinates += static_cast<double>(all.back().tiles.size() * all.back().ordinate.size());
  }
  const double shared = neighbours * overlaps;
  std::vector<Fitted> fits;
  std::vector<double> criterion;
  const int most = options.parts > 0 ? options.parts : options.most_parts;
  for (int parts = 1; parts <= most; ++parts) {
    fits.push_back(with_one_more(all, fits.empty() ? nullptr : &fits.back()));
    criterion.push_back(2 * fits.back().objective / shared + (2 * parts + 1) * std::log(ordinates / shared));
  }
  const auto least = std::min_element(criterion.begin(), criterion.end());
  const std::size_t chosen = options.parts > 0 ? fits.size() - 1 : static_cast<std::size_t>(least - criterion.begin());
  GroundNoise result = result_of(all, fits[chosen]);
  for (const double c : criterion) result.criterion.push_back(c - *least);
  return result;
}

}  // namespace gonio::relief
