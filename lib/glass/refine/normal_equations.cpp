// See normal_equations.h.
#include "glass/refine/normal_equations.h"

#include <cmath>

#include "base/parallel.h"

namespace gonio::glass {
namespace {

constexpr int most_iterations = 120;
constexpr double enough = 2e-3;    // of the residual's first length
constexpr std::size_t chunks = 4;  // of rows that are summed up apart; not the number of threads

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

NormalEquations::NormalEquations(const SplineField& field, const SmoothPrior& prior, std::vector<double> anchor)
    : field_(field), prior_(prior), anchor_(std::move(anchor)) {}

// visit(places of the coefficients, their weights): second differences along the axes and across, those twice.
template <class Visit>
void NormalEquations::for_bends(const Visit& visit) const {
  const auto [nx, ny, nz] = field_.nodes();
  const std::array<std::size_t, 3> step{1, static_cast<std::size_t>(nx),
                                        static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny)};
  const double w = 1 / prior_.bend_sigma, across = std::sqrt(2.0) * w;
  for (int k = 1; k + 1 < nz; ++k)
    for (int j = 1; j + 1 < ny; ++j)
      for (int i = 1; i + 1 < nx; ++i) {
        const std::size_t c = field_.index(i, j, k);
        for (const std::size_t s : step)
          visit(std::array<std::size_t, 4>{c - s, c, c + s, c}, std::array<double, 4>{w, -2 * w, w, 0});
        for (std::size_t a = 0; a < 3; ++a) {
          const std::size_t s = step[a], t = step[(a + 1) % 3];
          visit(std::array<std::size_t, 4>{c, c + s, c + t, c + s + t},
                std::array<double, 4>{across, -across, -across, across});
        }
      }
}

double NormalEquations::prior_cost(const std::vector<double>& state) const {
  double cost = 0;
  const double width2 = prior_.bend_width * prior_.bend_width;
  for_bends([&](const std::array<std::size_t, 4>& at, const std::array<double, 4>& w) {
    const double r = w[0] * state[at[0]] + w[1] * state[at[1]] + w[2] * state[at[2]] + w[3] * state[at[3]];
    cost += 2 * width2 * (std::sqrt(1 + r * r / width2) - 1);
  });
  for (std::size_t i = 0; i < anchor_.size(); ++i) {
    const double r = (state[i] - anchor_[i]) / prior_.anchor_sigma;
    cost += r * r;
  }
  for (std::size_t g = 0; g < globals; ++g) {
    const double r = (state[anchor_.size() + g] - prior_.mean[g]) / prior_.sigma[g];
    cost += r * r;
  }
  return cost;
}

void NormalEquations::linearise(const std::vector<double>& state, std::vector<Rows> rows) {
  rows_ = std::move(rows);
  const std::size_t n = anchor_.size();
  downhill_.assign(n + globals, 0), diagonal_.assign(n + globals, 0);
  for (const Rows& row : rows_)
    for (std::size_t k = 0; k < row.count; ++k) {
      for (std::size_t p = 0; p < row.places; ++p) {
        std::array<double, 4> weighed{}, slopes{};
        for (std::size_t l = 0; l < 4; ++l)
          slopes[l] = row.slopes[k][4 * p + l], weighed[l] = -row.residual[k] * slopes[l];
        field_.scatter(row.at[p], weighed, downhill_);
        field_.scatter_squares(row.at[p], slopes, diagonal_);
      }
      for (std::size_t g = 0; row.knows_globals && g < globals; ++g) {
        const double slope = row.slopes[k][8 + g];
        downhill_[n + g] -= row.residual[k] * slope, diagonal_[n + g] += slope * slope;
      }
    }
  ease_.clear();
  const double width2 = prior_.bend_width * prior_.bend_width;
  for_bends([&](const std::array<std::size_t, 4>& at, const std::array<double, 4>& w) {
    const double r = w[0] * state[at[0]] + w[1] * state[at[1]] + w[2] * state[at[2]] + w[3] * state[at[3]];
    const double weight = 1 / std::sqrt(1 + r * r / width2);
    ease_.push_back(std::sqrt(weight));
    for (std::size_t k = 0; k < 4; ++k) downhill_[at[k]] -= weight * r * w[k], diagonal_[at[k]] += weight * w[k] * w[k];
  });
  const double anchored = 1 / (prior_.anchor_sigma * prior_.anchor_sigma);
  for (std::size_t i = 0; i < n; ++i) downhill_[i] -= (state[i] - anchor_[i]) * anchored, diagonal_[i] += anchored;
  for (std::size_t g = 0; g < globals; ++g) {
    const double weight = 1 / (prior_.sigma[g] * prior_.sigma[g]);
    downhill_[n + g] -= (state[n + g] - prior_.mean[g]) * weight, diagonal_[n + g] += weight;
  }
}

void NormalEquations::add_rows(const Column& x, Column& to) const {
  const std::size_t n = anchor_.size();
  std::vector<Column> sums(chunks, Column(n + globals, 0));
  parallel_for(0, chunks, [&](std::size_t chunk) {
    Column& sum = sums[chunk];
    for (std::size_t r = chunk * rows_.size() / chunks; r < (chunk + 1) * rows_.size() / chunks; ++r) {
      const Rows& row = rows_[r];
      std::array<std::array<double, 4>, 2> local{};
      for (std::size_t p = 0; p < row.places; ++p) local[p] = field_.gather(row.at[p], x);
      std::array<std::array<double, 4>, 2> back{};
      for (std::size_t k = 0; k < row.count; ++k) {
        double value = 0;
        for (std::size_t p = 0; p < row.places; ++p)
          for (std::size_t l = 0; l < 4; ++l) value += row.slopes[k][4 * p + l] * local[p][l];
        for (std::size_t g = 0; row.knows_globals && g < globals; ++g) value += row.slopes[k][8 + g] * x[n + g];
        for (std::size_t p = 0; p < row.places; ++p)
          for (std::size_t l = 0; l < 4; ++l) back[p][l] += value * row.slopes[k][4 * p + l];
        for (std::size_t g = 0; row.knows_globals && g < globals; ++g) sum[n + g] += value * row.slopes[k][8 + g];
      }
      for (std::size_t p = 0; p < row.places; ++p) field_.scatter(row.at[p], back[p], sum);
    }
  });
  for (const Column& sum : sums)
    for (std::size_t i = 0; i < sum.size(); ++i) to[i] += sum[i];
}

NormalEquations::Column NormalEquations::multiplied(const Column& x) const {
  const std::size_t n = anchor_.size();
  Column y(n + globals, 0);
  std::size_t number = 0;
  for_bends([&](const std::array<std::size_t, 4>& at, const std::array<double, 4>& w) {
    const double weight = ease_[number] * ease_[number];
    const double r = weight * (w[0] * x[at[0]] + w[1] * x[at[1]] + w[2] * x[at[2]] + w[3] * x[at[3]]);
    ++number;
    for (std::size_t k = 0; k < 4; ++k) y[at[k]] += r * w[k];
  });
  const double anchored = 1 / (prior_.anchor_sigma * prior_.anchor_sigma);
  for (std::size_t i = 0; i < n; ++i) y[i] += x[i] * anchored;
  for (std::size_t g = 0; g < globals; ++g) y[n + g] += x[n + g] / (prior_.sigma[g] * prior_.sigma[g]);
  add_rows(x, y);
  return y;
}

// Preconditioned by the diagonal, which the damping raises.
NormalEquations::Column NormalEquations::conjugate_gradients(const Column& right, double damping) const {
  Column x(right.size(), 0), r = right, z(right.size()), p;
  const auto precondition = [&] {
    for (std::size_t i = 0; i < r.size(); ++i) z[i] = r[i] / (diagonal_[i] * (1 + damping));
  };
  precondition();
  p = z;
  double rz = dot(r, z);
  const double first = rz;
  for (int k = 0; k < most_iterations && rz > enough * enough * first; ++k) {
    Column q = multiplied(p);
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += damping * diagonal_[i] * p[i];
    const double step = rz / dot(p, q);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += step * p[i], r[i] -= step * q[i];
    precondition();
    const double before = rz;
    rz = dot(r, z);
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = z[i] + rz / before * p[i];
  }
  return x;
}

std::vector<double> NormalEquations::solve(double damping, double& promised) const {
  Column x = conjugate_gradients(downhill_, damping);
  promised = 2 * dot(x, downhill_) - dot(x, multiplied(x));
  return x;
}

std::vector<double> NormalEquations::draw(Random& random) const {
  const std::size_t n = anchor_.size();
  Column right(n + globals, 0);
  for (const Rows& row : rows_)
    for (std::size_t k = 0; k < row.count; ++k) {
      const double e = random.normal();
      for (std::size_t p = 0; p < row.places; ++p) {
        std::array<double, 4> weighed{};
        for (std::size_t l = 0; l < 4; ++l) weighed[l] = e * row.slopes[k][4 * p + l];
        field_.scatter(row.at[p], weighed, right);
      }
      for (std::size_t g = 0; row.knows_globals && g < globals; ++g) right[n + g] += e * row.slopes[k][8 + g];
    }
  std::size_t number = 0;
  for_bends([&](const std::array<std::size_t, 4>& at, const std::array<double, 4>& w) {
    const double e = random.normal() * ease_[number++];
    for (std::size_t k = 0; k < 4; ++k) right[at[k]] += e * w[k];
  });
  for (std::size_t i = 0; i < n; ++i) right[i] += random.normal() / prior_.anchor_sigma;
  for (std::size_t g = 0; g < globals; ++g) right[n + g] += random.normal() / prior_.sigma[g];
  return conjugate_gradients(right, 0);
}

}  // namespace gonio::glass
