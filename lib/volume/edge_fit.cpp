// One edge, or two that are too near one another for a plateau between them, fitted to the values along a normal:
// threshold.h has the model.
//
// With behind it a wall at q (air behind of its own value) and before it one at g (an object of its own value),
//   v(s) = air + (object - air) B(s - p) - (object - air_behind) B(s - q) + (object_before - air) (1 - B(s - g))
//   B(x) = Phi(-x / w) - w h phi(x / w),   h = H / (1 + H s)
// one width for all. What the profile then says least of, priors say: air behind is like air before, the other object
// like this one, each within 0.15 of the step. Weights are equal; that samples are correlated is counted in the
// covariance, (J'J + P)^-1 (J'CJ + P) (J'J + P)^-1, not in the weights: the correlation of interpolated samples is
// nearly singular, and its inverse would weigh up whatever the model lacks. Samples that are means of so many voxels
// are weighed by how many.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "linear/solve.h"
#include "optim/damped.h"
#include "optim/descent.h"
#include "volume/sampling.h"
#include "volume/threshold.h"

namespace gonio::volume {
namespace {

using Eigen::Index;

struct EdgeAt {
  enum : Index { position, log_width, air, object, behind, air_behind, before, object_before, slope = behind };
};
constexpr double root_two_pi = 2.5066282746310002, plateau_share = 0.15, usual_width = 0.8;

// B at s of a wall at p, and its slopes; `slanted`: what an object whose values slant by one per voxel along s adds, s
// up to p, smeared, and none beyond. The latter is slight: its slopes are left out. All of them share the two functions
// that the fit's time goes into.
struct EdgeStep {
  double b = 0, by_place = 0, by_log_width = 0, slanted = 0;
};
EdgeStep step_at(double s, double p, double w, double mean_curvature) {
  const double u = (s - p) / w, phi = std::exp(-0.5 * u * u) / root_two_pi;
  const double h = mean_curvature / std::max(0.2, 1 + mean_curvature * s);
  const double beyond = 0.5 * std::erfc(u / std::numbers::sqrt2);
  return {beyond - w * h * phi, phi * (1 / w - h * u), phi * (u - w * h * (1 + u * u)), s * beyond - w * phi};
}

struct EdgeProblem {
  std::span<const double> s, values;
  std::span<const double> sample_sd;  // of each sample, as far as it is independent
  double mean_curvature = 0;
  double plateau_sd = 1, log_width_mean = 0, log_width_sd = 0;
  bool has_inner = false, has_outer = false;
  double air_mean = 0, object_mean = 0, air_sd = 0, object_sd = 0;  // sd 0: not known
  double slope = 0;
};

// N = 4: an edge alone. N = 5: one whose object slants. N = 8: with one behind, one before, or both.
template <int N>
class EdgeDescent final : public optim::Descent {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  EdgeDescent(const EdgeProblem& problem, const Vector& start) : problem_(problem), x_(start), there_(start) {}

  // Value and slopes at sample i; w: exp(x[log_width]).
  double value(const Vector& x, double w, std::size_t i, Vector* slopes) const {
    const double s = problem_.s[i], h = problem_.mean_curvature;
    const EdgeStep own = step_at(s, x[EdgeAt::position], w, h);
    const double rise = x[EdgeAt::object] - x[EdgeAt::air];
    double v = x[EdgeAt::air] + rise * own.b + (N == 5 ? x[EdgeAt::slope % N] : problem_.slope) * own.slanted;
    if (slopes) {
      slopes->setZero();
      (*slopes)[EdgeAt::position] = rise * own.by_place;
      (*slopes)[EdgeAt::log_width] = rise * own.by_log_width;
      (*slopes)[EdgeAt::air] = 1 - own.b;
      (*slopes)[EdgeAt::object] = own.b;
      if (N == 5) (*slopes)[EdgeAt::slope % N] = own.slanted;
    }
    if constexpr (N == 8) {
      if (problem_.has_inner) {
        const EdgeStep behind = step_at(s, x[EdgeAt::behind], w, h);
        v += add_behind(x, behind, slopes) - problem_.slope * behind.slanted;
      }
      if (problem_.has_outer) v += add_before(x, step_at(s, x[EdgeAt::before], w, h), slopes);
    }
    return v;
  }

  double cost(const Vector& x) const {
    if (std::abs(x[EdgeAt::log_width]) > 3) return HUGE_VAL;  // narrower than a twentieth of a voxel, wider than twenty
    double sum = 0;
    const double w = std::exp(x[EdgeAt::log_width]);
    for (std::size_t i = 0; i < problem_.s.size(); ++i) {
      const double r = (problem_.values[i] - value(x, w, i, nullptr)) / problem_.sample_sd[i];
      sum += r * r;
    }
    for_priors([&](Index a, Index b, double mean, double sd) {
      const double r = (x[a] - (b < 0 ? mean : x[b])) / sd;
      sum += r * r;
    });
    return std::isfinite(sum) ? sum : HUGE_VAL;
  }

  void linearise() override {
    h_.setZero();
    downhill_.setZero();
    Vector j;
    const double w = std::exp(x_[EdgeAt::log_width]);
    for (std::size_t i = 0; i < problem_.s.size(); ++i) {
      const double r = (problem_.values[i] - value(x_, w, i, &j)) / problem_.sample_sd[i];
      j /= problem_.sample_sd[i];
      h_ += j * j.transpose();
      downhill_ += j * r;
    }
    h_ += prior_matrix();
    for_priors([&](Index a, Index b, double mean, double sd) {
      const double pull = ((b < 0 ? mean : x_[b]) - x_[a]) / (sd * sd);
      downhill_[a] += pull;
      if (b >= 0) downhill_[b] -= pull;
    });
  }
  optim::Proposal propose(double damping) override {
    const auto step = optim::damped_step(h_, downhill_, damping);
    there_ = x_ + step.change;
    return {step.promised, std::sqrt(std::max(0.0, step.change.dot(h_ * step.change)))};
  }
  double evaluate() override { return cost(there_); }
  void accept() override { x_.swap(there_); }
  const Vector& x() const { return x_; }
  const Matrix& matrix() const { return h_; }

  Matrix prior_matrix() const {
    Matrix p = Matrix::Zero();
    for_priors([&](Index a, Index b, double, double sd) {
      p(a, a) += 1 / (sd * sd);
      if (b < 0) return;
      p(b, b) += 1 / (sd * sd);
      p(a, b) -= 1 / (sd * sd);
      p(b, a) -= 1 / (sd * sd);
    });
    return p;
  }

 private:
  // (x_a - mean) / sd, or (x_a - x_b) / sd where b is a parameter.
  template <class Body>
  void for_priors(const Body& body) const {
    if (problem_.air_sd > 0) body(EdgeAt::air, -1, problem_.air_mean, problem_.air_sd);
    if (problem_.object_sd > 0) body(EdgeAt::object, -1, problem_.object_mean, problem_.object_sd);
    if (problem_.log_width_sd > 0) body(EdgeAt::log_width, -1, problem_.log_width_mean, problem_.log_width_sd);
    if constexpr (N == 8) {
      if (problem_.has_inner) body(EdgeAt::air_behind, EdgeAt::air, 0, problem_.plateau_sd);
      if (problem_.has_outer) body(EdgeAt::object_before, EdgeAt::object, 0, problem_.plateau_sd);
    }
  }
  static double add_behind(const Vector& x, const EdgeStep& step, Vector* slopes) {
    const double fall = x[EdgeAt::object] - x[EdgeAt::air_behind];
    if (slopes) {
      (*slopes)[EdgeAt::behind] = -fall * step.by_place;
      (*slopes)[EdgeAt::log_width] -= fall * step.by_log_width;
      (*slopes)[EdgeAt::object] -= step.b;
      (*slopes)[EdgeAt::air_behind] = step.b;
    }
    return -fall * step.b;
  }
  static double add_before(const Vector& x, const EdgeStep& step, Vector* slopes) {
    const double rise = x[EdgeAt::object_before] - x[EdgeAt::air];
    if (slopes) {
      (*slopes)[EdgeAt::before] = -rise * step.by_place;
      (*slopes)[EdgeAt::log_width] -= rise * step.by_log_width;
      (*slopes)[EdgeAt::air] -= 1 - step.b;
      (*slopes)[EdgeAt::object_before] = 1 - step.b;
    }
    return rise * (1 - step.b);
  }

  const EdgeProblem& problem_;
  Vector x_, there_, downhill_;
  Matrix h_;
};

struct EdgeStart {
  double position = 0, width = usual_width, air = 0, object = 0;
};
double mean_of_samples(std::span<const double> v) {
  double sum = 0;
  for (const double x : v) sum += x;
  return sum / static_cast<double>(v.size());
}
// An edge alone, in closed form: plateaus from the ends; the area under the step is where it stands, and the area
// between it and a sharp step, w sqrt(2 / pi), how wide it is.
EdgeStart start_alone(std::span<const double> s, std::span<const double> v, std::optional<double> width) {
  const std::size_t n = s.size(), end = std::max<std::size_t>(1, n / 5);
  EdgeStart start;
  start.object = mean_of_samples(v.first(end));
  start.air = mean_of_samples(v.last(end));
  const double rise = start.object - start.air;
  if (rise == 0) return start;
  const auto share = [&](std::size_t i) { return 0.5 * (s[std::min(i + 1, n - 1)] - s[i > 0 ? i - 1 : 0]); };
  double area = 0, between = 0;
  for (std::size_t i = 0; i < n; ++i) area += std::clamp((v[i] - start.air) / rise, -0.5, 1.5) * share(i);
  start.position = std::clamp(s[0] + area, s[0], s[n - 1]);
  for (std::size_t i = 0; i < n; ++i)
    between += std::abs((v[i] - start.air) / rise - (s[i] < start.position ? 1 : 0)) * share(i);
  start.width = width.value_or(std::clamp(between * std::sqrt(std::numbers::pi / 2), 0.3, 2.5));
  return start;
}

// With a wall behind or before, plateaus are the extremes of the profile between the walls' starts, stretched by what
// the spread function takes from a slab as thick.
EdgeStart start_between(std::span<const double> s, std::span<const double> v, const ProfileWish& wish) {
  const double w = wish.width.value_or(usual_width), inner = wish.inner.value_or(s.front()),
               outer = wish.outer.value_or(s.back());
  EdgeStart start{0, w, HUGE_VAL, -HUGE_VAL};
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (s[i] >= inner && s[i] <= 0.5) start.object = std::max(start.object, v[i]);
    if (s[i] >= -0.5 && s[i] <= outer) start.air = std::min(start.air, v[i]);
  }
  const double rise = start.object - start.air;
  const auto lacking = [&](double thickness) {
    return 1 / std::max(0.5, std::erf(thickness / (2 * w * std::numbers::sqrt2))) - 1;
  };
  if (wish.inner) start.object += rise * lacking(-inner);
  if (wish.outer) start.air -= rise * lacking(outer);
  return start;
}

// How many samples of a profile say as much as one that is independent, and their mean variance.
struct SampleNoise {
  double variance = 1, repeated = 1;
};
SampleNoise sample_noise(std::span<const double> covariance, const std::vector<double>& root_weight) {
  if (covariance.empty()) return {};
  const std::size_t n = root_weight.size();
  double trace = 0, all = 0;
  for (std::size_t a = 0; a < n; ++a) {
    trace += covariance[a * n + a] * root_weight[a] * root_weight[a];
    for (std::size_t b = 0; b < n; ++b) all += covariance[a * n + b] * root_weight[a] * root_weight[b];
  }
  return {trace / static_cast<double>(n), std::clamp(all / trace, 1.0, static_cast<double>(n))};
}

template <int N>
Edge fitted_edge(const EdgeProblem& problem, const ProfileWish& wish, const Eigen::Matrix<double, N, 1>& start,
                 double unit) {
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;
  const std::size_t n = problem.s.size();
  EdgeDescent<N> descent(problem, start);
  optim::Limits limits;
  limits.most_steps = 40;
  limits.most_trials = 120;
  limits.small_fall = {1e-7, 1e-7};
  limits.small_step = 1e-4;
  const optim::Descended end = optim::descend(descent, descent.cost(start), limits);
  descent.linearise();
  const Vector x = descent.x();

  Eigen::Matrix<double, Eigen::Dynamic, N, Eigen::ColMajor, 64, N> j(n, N);
  double squares = 0, misfit = 0;
  const double w = std::exp(x[EdgeAt::log_width]);
  for (std::size_t i = 0; i < n; ++i) {
    Vector row;
    const double r = problem.values[i] - descent.value(x, w, i, &row), sd = problem.sample_sd[i];
    misfit += r * r;
    squares += r * r / (sd * sd);
    j.row(static_cast<Index>(i)) = row.transpose() / sd;
  }
  // S = J'CJ, C the samples' covariance over their sd for a voxel's noise of one.
  Matrix s = Matrix::Zero();
  double trace = 0;
  const auto covariance = [&](std::size_t a, std::size_t b) {
    const double own = wish.weights.empty() ? 1 : 1 / wish.weights[a];
    const double c = wish.covariance.empty() ? (a == b ? own : 0) : wish.covariance[a * n + b];
    return c / (problem.sample_sd[a] * problem.sample_sd[b]);
  };
  for (std::size_t a = 0; a < n; ++a) {
    Vector cj = Vector::Zero();
    for (std::size_t b = 0; b < n; ++b)
      if (const double c = covariance(a, b); c != 0) cj += c * j.row(static_cast<Index>(b)).transpose();
    s += j.row(static_cast<Index>(a)).transpose() * cj.transpose();
    trace += covariance(a, a);
  }
  const auto& h = descent.matrix();
  const Matrix priors = descent.prior_matrix();
  double taken = 0;  // of the noise's squares by the fit
  for (Index k = 0; k < N; ++k)
    if (h(k, k) > 0) taken += linear::solve_ldlt(h, Vector(s.col(k)))[k];
  const double expected = std::max(0.1 * trace, trace - taken);

  Edge edge;
  edge.position = x[EdgeAt::position];
  edge.width = std::exp(x[EdgeAt::log_width]);
  edge.air = x[EdgeAt::air];
  edge.object = x[EdgeAt::object];
  const double rise = edge.object - edge.air;
  edge.misfit = std::sqrt(misfit / static_cast<double>(n)) / std::abs(rise);
  const double variance = wish.noise > 0 ? wish.noise * wish.noise : squares / expected;
  edge.excess = wish.noise > 0 ? squares / expected / variance : variance;
  const double inflated = wish.noise > 0 ? variance * std::max(1.0, edge.excess / 2) : variance;
  const auto sigma_of = [&](Index k) {
    const Vector a = linear::solve_ldlt(h, Vector(Vector::Unit(k)));
    return std::sqrt(a.dot(s * a) * inflated + a.dot(priors * a));
  };
  edge.sigma = sigma_of(EdgeAt::position);
  edge.sigma_air = sigma_of(EdgeAt::air);
  edge.sigma_object = sigma_of(EdgeAt::object);
  edge.sigma_width = edge.width * sigma_of(EdgeAt::log_width);
  if (N == 5) edge.slope = x[EdgeAt::slope % N];
  const double noise = std::sqrt(variance);
  edge.good = end.settled() && std::isfinite(edge.sigma) && std::abs(rise) > 3 * noise &&
              edge.position > problem.s.front() / 2 && edge.position < problem.s.back() / 2 && edge.sigma < unit;
  return edge;
}

}  // namespace

Edge fit_edge(std::span<const double> s, std::span<const double> values, const ProfileWish& wish) {
  constexpr double widest_sigma = 1;  // voxels: an edge known no better is none
  const bool alone = !wish.inner && !wish.outer;
  if (s.size() < (alone ? 6u : 9u) || s.size() > 64 || values.size() != s.size() ||
      (!wish.weights.empty() && wish.weights.size() != s.size()))
    return {};
  for (const double v : values)
    if (!std::isfinite(v)) return {};
  const EdgeStart start = alone ? start_alone(s, values, wish.width) : start_between(s, values, wish);
  const double rise = std::abs(start.object - start.air);
  if (!(rise > 0)) return {};
  std::vector<double> root_weight(s.size(), 1.0), sample_sd(s.size());
  for (std::size_t i = 0; i < wish.weights.size(); ++i) root_weight[i] = std::sqrt(wish.weights[i]);
  const SampleNoise sample = sample_noise(wish.covariance, root_weight);
  const double noise = (wish.noise > 0 ? wish.noise : 0.03 * rise) * std::sqrt(sample.variance * sample.repeated);
  for (std::size_t i = 0; i < s.size(); ++i) sample_sd[i] = noise / root_weight[i];
  EdgeProblem problem{s, values, sample_sd, wish.mean_curvature, plateau_share * rise};
  problem.has_inner = wish.inner.has_value();
  problem.has_outer = wish.outer.has_value();
  problem.slope = wish.slope;
  if (wish.air) problem.air_mean = wish.air->mean, problem.air_sd = wish.air->sd;
  if (wish.object) problem.object_mean = wish.object->mean, problem.object_sd = wish.object->sd;
  if (wish.width) problem.log_width_mean = std::log(*wish.width), problem.log_width_sd = wish.width_share;
  if (alone && wish.slope_is_free) {
    Eigen::Matrix<double, 5, 1> x;
    x << start.position, std::log(start.width), start.air, start.object, 0;
    return fitted_edge<5>(problem, wish, x, widest_sigma);
  }
  if (alone)
    return fitted_edge<4>(
        problem, wish, Eigen::Vector4d(start.position, std::log(start.width), start.air, start.object), widest_sigma);
  Eigen::Matrix<double, 8, 1> x;
  x << start.position, std::log(start.width), start.air, start.object, wish.inner.value_or(0), start.air,
      wish.outer.value_or(0), start.object;
  return fitted_edge<8>(problem, wish, x, widest_sigma);
}

Edge fit_edge(std::span<const double> s, std::span<const double> values, double noise) {
  ProfileWish wish;
  wish.noise = noise;
  return fit_edge(s, values, wish);
}

std::vector<double> trilinear_covariance(Vec3 first, Vec3 step, std::size_t count, double neighbour_correlation) {
  const AxisCovariance axis(neighbour_correlation);
  std::vector<double> c(count * count);
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = 0; b <= a; ++b)
      c[a * count + b] = c[b * count + a] =
          covariance_of(axis, first + step * static_cast<double>(a), first + step * static_cast<double>(b));
  return c;
}

}  // namespace gonio::volume
