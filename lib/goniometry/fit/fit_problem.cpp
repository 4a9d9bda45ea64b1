// See fit_problem.h: residuals, and normal equations gathered over rows in a fixed order.
#include "goniometry/fit/fit_problem.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"

namespace gonio::goniometry {
namespace {

constexpr double least = 1e-12;     // 1/sr: below, decades are not told apart
constexpr std::size_t pieces = 32;  // of the sum over rows, whatever the number of threads

// log(1 + x), and its tangent where noise takes x far below zero.
double log_of(double x) {
  return x > -0.5 ? std::log1p(x) : std::log(0.5) + 2 * (x + 0.5);
}

void put(Vec3& v, std::size_t component, double number) {
  (component == 0 ? v.x : component == 1 ? v.y : v.z) = number;
}

}  // namespace

const Slot& slot_of(const Candidate& candidate, std::size_t i) {
  const std::size_t s = candidate.shared.size();
  return i < s ? candidate.shared[i] : candidate.colours[(i - s) % candidate.colours.size()];
}

std::vector<surface::Values> Candidate::triples(const std::vector<double>& x, std::size_t bands) const {
  surface::Values common = held;
  for (std::size_t i = 0; i < shared.size(); ++i) common.v[shared[i].parameter] = {x[i], x[i], x[i]};
  std::vector<surface::Values> all((bands + 2) / 3, common);
  for (std::size_t b = 0; b < 3 * all.size(); ++b) {
    const std::size_t from = std::min(b, bands - 1);  // beyond the last: like it
    for (std::size_t c = 0; c < colours.size(); ++c)
      put(all[b / 3].v[colours[c].parameter], b % 3, x[shared.size() + from * colours.size() + c]);
  }
  return all;
}

Problem::Problem(const Samples& samples, Scale scale) : samples_(&samples), scale_(scale) {
  const std::size_t n = samples.rows(), b = samples.bands();
  weight_.resize(n);
  scaled_.assign(n * b, 0);
  inverse_spread_.assign(n * b, 0);
  for (std::size_t r = 0; r < n; ++r) {
    weight_[r] = 100 * std::max(0.0, samples.wi[r].z) * std::max(0.0, samples.wo[r].z);
    bool any = false;
    for (std::size_t k = r * b; k < (r + 1) * b; ++k) {
      const double f = samples.f[k];
      if (!std::isfinite(f) || !(weight_[r] > 0)) continue;
      if (scale == Scale::log10 && !(f > least)) continue;
      if (scale == Scale::noise && !(samples.sigma[k] > 0)) continue;
      scaled_[k] = scale == Scale::noise ? f : scale == Scale::log10 ? std::log10(f) : log_of(weight_[r] * f);
      inverse_spread_[k] = scale == Scale::noise ? 1 / samples.sigma[k] : 1;
      any = true;
    }
    if (any) rows_.push_back(static_cast<std::uint32_t>(r));
  }
}

void Problem::set_model_error(double share, const std::vector<double>& about) {
  model_error_ = share;
  for (const std::uint32_t r : rows_)
    for (std::size_t k = r * bands(); k < (r + 1) * bands(); ++k)
      if (inverse_spread_[k] > 0)
        inverse_spread_[k] = 1 / std::hypot(samples_->sigma[k], share * tolerance(r, about[k]));
}

std::vector<double> Problem::predictions(const Candidate& candidate, const std::vector<double>& x) const {
  const auto triples = candidate.triples(x, bands());
  std::vector<double> all(samples_->f.size()), m(bands());
  for (const std::uint32_t r : rows_) {
    predict(candidate, triples, r, m);
    std::ranges::copy(m, all.begin() + static_cast<std::ptrdiff_t>(r * bands()));
  }
  return all;
}

double Problem::residual(std::size_t row, std::size_t band, double m) const {
  const std::size_t k = row * bands() + band;
  if (scale_ == Scale::noise) return (scaled_[k] - m) * inverse_spread_[k];
  if (scale_ == Scale::log10) return scaled_[k] - std::log10(std::max(m, least));
  return scaled_[k] - log_of(weight_[row] * m);
}

double Problem::slope(std::size_t row, std::size_t band, double m) const {
  if (scale_ == Scale::noise) return inverse_spread_[row * bands() + band];
  if (scale_ == Scale::log10) return m > least ? 1 / (m * std::log(10.0)) : 0;
  const double x = weight_[row] * m;
  return x > -0.5 ? weight_[row] / (1 + x) : 2 * weight_[row];
}

double Problem::log1p_residual(std::size_t row, std::size_t band, double m) const {
  return log_of(weight_[row] * samples_->f[row * bands() + band]) - log_of(weight_[row] * m);
}

void Problem::predict(const Candidate& candidate, const std::vector<surface::Values>& triples, std::size_t row,
                      std::vector<double>& m) const {
  for (std::size_t t = 0; t < triples.size(); ++t) {
    const Rgb f = candidate.model->evaluate(triples[t], samples_->wo[row], samples_->wi[row]);
    for (std::size_t c = 0; c < 3 && 3 * t + c < m.size(); ++c) m[3 * t + c] = f[static_cast<int>(c)];
  }
}

// Sums over rows: shared block, and per band what it adds.
struct Problem::Gather {
  Gather(std::size_t s, std::size_t c, std::size_t bands, std::size_t parameters)
      : shared(s),
        width(s + c),
        square(bands * width * width, 0.0),
        pull(bands * width, 0.0),
        slopes(parameters),
        one(width) {}
  std::size_t shared, width;
  std::vector<double> square, pull;  // of each band: width x width (upper part), width
  double cost = 0;
  std::size_t observations = 0;
  std::vector<Rgb> slopes;
  std::vector<double> one;
};

void Problem::gather(const Candidate& candidate, const std::vector<surface::Values>& triples, std::size_t row,
                     Gather& sum) const {
  const std::size_t w = sum.width, b = bands();
  for (std::size_t t = 0; t < triples.size(); ++t) {
    const Rgb f = candidate.model->evaluate_with_slopes(triples[t], samples_->wo[row], samples_->wi[row], sum.slopes);
    for (std::size_t c = 0; c < 3 && 3 * t + c < b; ++c) {
      const std::size_t band = 3 * t + c;
      if (!used(row, band)) continue;
      const int i = static_cast<int>(c);
      const double r = residual(row, band, f[i]), by = slope(row, band, f[i]);
      for (std::size_t p = 0; p < sum.shared; ++p) sum.one[p] = by * sum.slopes[candidate.shared[p].parameter][i];
      for (std::size_t p = sum.shared; p < w; ++p)
        sum.one[p] = by * sum.slopes[candidate.colours[p - sum.shared].parameter][i];
      double* square = sum.square.data() + band * w * w;
      double* pull = sum.pull.data() + band * w;
      for (std::size_t p = 0; p < w; ++p) {
        pull[p] += sum.one[p] * r;
        for (std::size_t q = p; q < w; ++q) square[p * w + q] += sum.one[p] * sum.one[q];
      }
      sum.cost += r * r;
      ++sum.observations;
    }
  }
}

Eigen::MatrixXd Problem::slopes(const Candidate& candidate, const std::vector<double>& x) const {
  const std::size_t s = candidate.shared.size(), c = candidate.colours.size(), b = bands();
  const auto triples = candidate.triples(x, b);
  std::vector<Rgb> by_parameter(candidate.model->info().parameters.size());
  const auto unknowns = static_cast<Eigen::Index>(candidate.unknowns(b));
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows_.size() * b), unknowns);
  for (std::size_t k = 0; k < rows_.size(); ++k)
    for (std::size_t band = 0; band < b; ++band) {
      const std::size_t row = rows_[k];
      if (!used(row, band)) continue;
      const Rgb f =
          candidate.model->evaluate_with_slopes(triples[band / 3], samples_->wo[row], samples_->wi[row], by_parameter);
      const int i = static_cast<int>(band % 3);
      const double by = slope(row, band, f[i]);
      const auto at = static_cast<Eigen::Index>(k * b + band);
      for (std::size_t p = 0; p < s; ++p)
        j(at, static_cast<Eigen::Index>(p)) = by * by_parameter[candidate.shared[p].parameter][i];
      for (std::size_t p = 0; p < c; ++p)
        j(at, static_cast<Eigen::Index>(s + band * c + p)) = by * by_parameter[candidate.colours[p].parameter][i];
    }
  return j;
}

Normal Problem::normal(const Candidate& candidate, const std::vector<double>& x, const Rows& rows) const {
  const std::size_t s = candidate.shared.size(), c = candidate.colours.size(), b = bands(), w = s + c;
  const auto triples = candidate.triples(x, b);
  const std::size_t parts = std::min(pieces, rows.size() / 64 + 1);
  std::vector<Gather> sums(parts, Gather(s, c, b, candidate.model->info().parameters.size()));
  parallel_for(0, parts, [&](std::size_t k) {
    for (std::size_t i = k * rows.size() / parts; i < (k + 1) * rows.size() / parts; ++i)
      gather(candidate, triples, rows[i], sums[k]);
  });
  const auto n = static_cast<Eigen::Index>(candidate.unknowns(b));
  Normal out{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (const Gather& sum : sums) {
    out.cost += sum.cost;
    out.observations += sum.observations;
    for (std::size_t band = 0; band < b; ++band) {
      const auto place = [&](std::size_t p) { return static_cast<Eigen::Index>(p < s ? p : p + band * c); };
      for (std::size_t p = 0; p < w; ++p) {
        out.downhill[place(p)] += sum.pull[band * w + p];
        for (std::size_t q = p; q < w; ++q) out.h(place(p), place(q)) += sum.square[(band * w + p) * w + q];
      }
    }
  }
  out.h.triangularView<Eigen::StrictlyLower>() = out.h.transpose();
  if (!std::isfinite(out.cost)) out.cost = std::numeric_limits<double>::infinity();
  return out;
}

}  // namespace gonio::goniometry
