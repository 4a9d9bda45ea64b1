// See sensor_linearity.h.
#include "photograph/sensor_linearity.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"
#include "linear/solve.h"
#include "stats/anova.h"

namespace gonio::photograph {
namespace {

constexpr std::size_t fewest_levels = 5, most_knots = 6, table_pieces = 64;
constexpr double least_span = 3;                                                     // brightest over darkest code
constexpr double clear_of_full = 0.98;                                               // of saturation
constexpr double few_full = 1e-3;                                                    // share of full samples
constexpr double least_flicker = 1e-5;                                               // relative: no lamp is steadier
constexpr std::array mean_square_range{2.0, 3.654, 5.013, 6.156, 7.14, 8.00, 8.77};  // of 2, 3, ... standard normals

// Mean of a tile, and the variance of that.
struct Code {
  double mean = 0, variance = 0;
};
Code code_of(const SeriesLevel& level, std::size_t tile) {
  const TileSums& t = level.tiles[tile];
  return {t.sum / t.samples, t.temporal / t.temporal_freedom / t.samples / static_cast<double>(level.frames)};
}

// Of the dark frames of that exposure; else by a line over dark exposures, or of the only one.
Code dark_of(const std::vector<SeriesLevel>& dark, std::size_t tile, double t) {
  double n = 0, nt = 0, ntt = 0, nx = 0, ntx = 0, noise = 0;
  for (const SeriesLevel& level : dark) {
    const Code c = code_of(level, tile);
    if (std::abs(level.exposure_s - t) <= 1e-4 * t) return c;
    const auto w = static_cast<double>(level.frames);
    n += w, nt += w * level.exposure_s, ntt += w * level.exposure_s * level.exposure_s;
    nx += w * c.mean, ntx += w * level.exposure_s * c.mean, noise = std::max(noise, c.variance);
  }
  const double spread = n * ntt - nt * nt;
  const double slope = spread > 1e-9 * n * ntt ? (n * ntx - nt * nx) / spread : 0;
  return {(nx - slope * nt) / n + slope * t, noise};
}

class Finding {
 public:
  Finding(const SeriesSums& sums, const SensorFigures& figures) : sums_(sums), figures_(figures) {}

  SensorLinearity run() {
    gather();
    if (!tell()) return std::move(out_);
    // What exposures differ by beyond the lamp's flicker counts as its own change.
    for (int round = 0; round < 4; ++round) {
      solve();
      const double levels = static_cast<double>(flicker_.size()), free = levels - static_cast<double>(terms());
      double squares = 0;
      for (Eigen::Index k = 0; k < index(flicker_.size()); ++k)
        squares += solution_[index(terms() + tiles_) + k] * solution_[index(terms() + tiles_) + k] /
                   flicker_[static_cast<std::size_t>(k)];
      if (!(squares > free)) break;
      for (double& f : flicker_) f *= squares / free;
    }
    write();
    return std::move(out_);
  }

 private:
  struct Seen {
    std::size_t tile, level;
    double code, log_t, weight;
  };
  static Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }
  std::size_t terms() const { return knots_.size() - 1; }

  void gather() {
    const std::size_t per_plane = sums_.planes[0].lit[0].tiles.size();
    std::vector<bool> used(sums_.planes[0].lit.size());
    double flicker = 0, count = 0;
    for (std::size_t p = 0; p < sums_.planes.size(); ++p)
      for (std::size_t k = 0; k < used.size(); ++k) {
        const SeriesLevel& level = sums_.planes[p].lit[k];
        if (level.share_full > few_full) continue;
        double sum = 0;
        for (std::size_t tile = 0; tile < per_plane; ++tile) {
          const Code lit = code_of(level, tile), dark = dark_of(sums_.planes[p].dark, tile, level.exposure_s);
          const double x = lit.mean - dark.mean;
          sum += x / static_cast<double>(per_plane);
          if (!(x > 0) || x > clear_of_full * figures_.planes[p].saturation) continue;
          seen_.push_back({p * per_plane + tile, k, x, std::log(level.exposure_s),
                           x * x / std::max(1e-12, lit.variance + dark.variance)});
          used[k] = true;
        }
        const std::size_t n = std::min(level.frames, mean_square_range.size() + 1);
        flicker += level.drift * level.drift / (sum * sum) / mean_square_range[n - 2], ++count;
      }
    std::vector<std::size_t> place(used.size());
    for (std::size_t k = 0; k < used.size(); ++k) {
      place[k] = flicker_.size();
      if (used[k])
        flicker_.push_back((flicker / count + least_flicker * least_flicker) /
                           static_cast<double>(sums_.planes[0].lit[k].frames));
    }
    for (Seen& s : seen_) s.level = place[s.level];
    tiles_ = per_plane * sums_.planes.size();
  }

  // False, and why, where there is too little to tell.
  bool tell() {
    if (flicker_.size() < fewest_levels) {
      out_.left_out = format("%zu exposures below saturation, %zu are the fewest", flicker_.size(), fewest_levels);
      return false;
    }
    std::vector<double> codes;
    for (const Seen& s : seen_) codes.push_back(s.code);
    std::ranges::sort(codes);
    least_ = codes.front(), most_ = codes.back();
    if (most_ < least_span * least_) {
      out_.left_out = format("exposures span codes from %.3g to %.3g alone", least_, most_);
      return false;
    }
    const std::size_t knots = std::min(most_knots, 2 + flicker_.size() / 3);
    for (std::size_t j = 0; j < knots; ++j) {
      const double share = static_cast<double>(j) / static_cast<double>(knots - 1);
      knots_.push_back((least_ + share * (most_ - least_)) / most_);
    }
    out_.reference = figures_.planes[0].half;
    return true;
  }

  // Natural cubic splines without the constant (Hastie, Tibshirani & Friedman 2009, equations 5.4 and 5.5).
  Eigen::VectorXd basis(double code) const {
    const double u = code / most_;
    const std::size_t last = knots_.size() - 1;
    const auto bend = [&](std::size_t j) {
      const auto cube = [](double v) { return v > 0 ? v * v * v : 0; };
      return (cube(u - knots_[j]) - cube(u - knots_[last])) / (knots_[last] - knots_[j]);
    };
    Eigen::VectorXd b(index(terms()));
    b[0] = u;
    for (std::size_t j = 0; j + 1 < last; ++j) b[index(j) + 1] = bend(j) - bend(last - 1);
    return b;
  }

  void solve() {
    const std::size_t n = terms() + tiles_ + flicker_.size();
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(index(n), index(n));
    Eigen::VectorXd right = Eigen::VectorXd::Zero(index(n));
    for (std::size_t k = 0; k < flicker_.size(); ++k)
      normal(index(terms() + tiles_ + k), index(terms() + tiles_ + k)) = 1 / flicker_[k];
    // h - a - e = log t - log x
    for (const Seen& s : seen_) {
      const Eigen::VectorXd b = basis(s.code);
      const double y = s.log_t - std::log(s.code);
      const std::array<Eigen::Index, 2> own{index(terms() + s.tile), index(terms() + tiles_ + s.level)};
      normal.topLeftCorner(b.size(), b.size()) += s.weight * b * b.transpose();
      right.head(b.size()) += s.weight * y * b;
      for (const Eigen::Index i : own) {
        normal.row(i).head(b.size()) -= s.weight * b.transpose();
        right[i] -= s.weight * y;
        for (const Eigen::Index j : own) normal(i, j) += s.weight;
      }
    }
    // Tiles that were always full.
    for (Eigen::Index i = 0; i < index(n); ++i)
      if (normal(i, i) == 0) normal(i, i) = 1;
    normal = Eigen::MatrixXd(normal.selfadjointView<Eigen::Lower>());
    const linear::Ldlt factors(normal);
    solution_ = factors.solve(right);
    Eigen::MatrixXd some = Eigen::MatrixXd::Zero(index(n), index(terms()));
    some.topRows(index(terms())).setIdentity();
    const Eigen::MatrixXd inverse = factors.solve(some);
    covariance_ = inverse.topRows(index(terms()));
  }

  void write() {
    const Eigen::VectorXd h = solution_.head(index(terms())), at = basis(out_.reference);
    const double free = static_cast<double>(flicker_.size() - terms()), count = static_cast<double>(terms());
    const double f = h.dot(linear::Ldlt(covariance_).solve(h)) / count;
    out_.p = stats::f_upper(f, count, free);
    out_.rows.push_back({0, 0, 0});
    for (std::size_t i = 1; i <= table_pieces; ++i) {
      const double code = most_ * static_cast<double>(i) / table_pieces;
      const Eigen::VectorXd off = basis(code) - at;
      const double factor = std::exp(off.dot(h)), sigma = factor * std::sqrt(off.dot(covariance_ * off));
      out_.rows.push_back({code, code * factor, code * sigma});
      if (code >= least_ && std::abs(factor - 1) > out_.worst)
        out_.worst = std::abs(factor - 1), out_.worst_at = code, out_.worst_sigma = sigma;
      if (!(out_.rows[i].linear > out_.rows[i - 1].linear))
        out_.left_out = format("linear codes would not rise at code %.4g", code);
    }
  }

  const SeriesSums& sums_;
  const SensorFigures& figures_;
  std::vector<Seen> seen_;
  std::vector<double> flicker_;  // variance of e, of each exposure
  std::vector<double> knots_;
  std::size_t tiles_ = 0;
  double least_ = 0, most_ = 0;
  Eigen::VectorXd solution_;
  Eigen::MatrixXd covariance_;
  SensorLinearity out_;
};

}  // namespace

SensorLinearity sensor_linearity(const SeriesSums& sums, const SensorFigures& figures) {
  return Finding(sums, figures).run();
}

}  // namespace gonio::photograph
