// The most informative directions: candidates, rank-one updates, exchange.
//   taking a pair in:  S <- S - (S q)(S q)' / (r + q' S q),   taking it out:  S <- S + (S q)(S q)' / (r - q' S q)
// with r = 1 / W the pair's noise variance. The mean predicted variance falls by q' S M S q / (r + q' S q), ln det S by
// ln (1 + q' S q / r).
#include "goniometry/plan.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "geom/angle.h"
#include "goniometry/reconstruct/reconstruction_parts.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"

namespace gonio::goniometry {
namespace {

using Criterion = PlanOptions::Criterion;
constexpr double azimuth_step = 15 * degree;
constexpr double least_apart = 5 * degree;  // the lamp hides what is nearer to it
constexpr int most_sweeps = 6;

Vec3 direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

std::vector<PlannedPair> candidates(const PlanOptions& options) {
  std::vector<PlannedPair> pairs;
  const auto add = [&](double theta_i, double theta_o, double phi_o) {
    if (theta_o < -1e-12 || theta_o > options.most_theta_rad + 1e-9 || theta_i > options.most_theta_rad + 1e-9) return;
    const PlannedPair pair{theta_i, 0, std::max(theta_o, 0.0), phi_o};
    if (std::acos(std::clamp(dot(pair.wi(), pair.wo()), -1.0, 1.0)) >= least_apart - 1e-9) pairs.push_back(pair);
  };
  const int zeniths = static_cast<int>(std::floor(options.most_theta_rad / options.step_rad + 1e-9));
  for (int i = 0; i <= zeniths; ++i) {
    const double theta_i = i * options.step_rad;
    for (int o = 0; o <= i; ++o)
      for (double phi = pi; phi > -1e-9; phi -= azimuth_step) {
        add(theta_i, o * options.step_rad, std::max(phi, 0.0));
        if (o == 0) break;
      }
    for (const double offset : {0.25, 0.5, 1.0, 2.0, 3.0, 4.0})
      if (theta_i > offset * degree) add(theta_i, theta_i - offset * degree, pi);
  }
  return pairs;
}

struct Candidates {
  std::vector<PlannedPair> pairs;
  Eigen::MatrixXd q;      // K x candidates
  Eigen::VectorXd noise;  // r
};

Candidates rows_of(const Basis& basis, std::vector<PlannedPair> pairs, const PlanOptions& options) {
  Candidates c{std::move(pairs), {}, {}};
  c.q.setZero(static_cast<Eigen::Index>(basis.components()), static_cast<Eigen::Index>(c.pairs.size()));
  c.noise.resize(c.q.cols());
  parallel_for(
      0, c.pairs.size(),
      [&](std::size_t i) {
        const auto column = static_cast<Eigen::Index>(i);
        const Vec3 wo = c.pairs[i].wo(), wi = c.pairs[i].wi();
        const Cells::Blend blend = basis.cells().blend(wo, wi);
        double level = 0, rest = 0;
        for (std::size_t k = 0; k < blend.cell.size(); ++k) {
          const auto cell = blend.cell[k];
          level += blend.share[k] * static_cast<double>(basis.log_reference()[cell] + basis.mean()[cell]);
          rest += blend.share[k] * static_cast<double>(basis.rest()[cell]);
          const auto q = basis.q(cell);
          for (std::size_t j = 0; j < q.size(); ++j)
            c.q(static_cast<Eigen::Index>(j), column) += blend.share[k] * static_cast<double>(q[j]);
        }
        const double w = cosine_weight(wi, wo), f = of_level(level, w);
        const double noise = options.relative_noise * f * level_slope(f, w);
        c.noise[column] = noise * noise + rest * rest + 1e-12;
      },
      64);
  return c;
}

// Rows that are measured already, and 1 + the information that they hold: the inverse of the S to begin with.
struct Known {
  Eigen::MatrixXd q;  // K x rows
  Eigen::MatrixXd information;
};
Known known_of(const Basis& basis, const PlanOptions& options) {
  const auto k = static_cast<Eigen::Index>(basis.components());
  Known known{Eigen::MatrixXd(k, 0), Eigen::MatrixXd::Identity(k, k)};
  if (options.given == nullptr) return known;
  std::vector<std::string> notes;
  std::vector<Dropped> dropped;
  const Samples samples = rgb_of_bands(*options.given, notes);
  const Observed o = observe(basis, samples, samples.bands() / 2, {.relative_noise = options.relative_noise}, dropped);
  if (o.y.size() == 0)
    throw Error(Exit::data, samples.name, "leaves no usable sample to plan from",
                "directions above the horizon with finite reflectances are needed");
  known.q = o.q.transpose();
  known.information += known.q * o.noise.cwiseInverse().asDiagonal() * known.q.transpose();
  return known;
}
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& information) {
  return linear::Llt(information).solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
}

// M, and the mean of rest^2, which no measurement lowers.
struct Whole {
  Eigen::MatrixXd m;
  double rest = 0;
};
Whole whole_of(const Basis& basis) {
  const auto k = static_cast<Eigen::Index>(basis.components()), n = static_cast<Eigen::Index>(basis.cells().count());
  const Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> q(basis.all_q().data(),
                                                                                                  n, k);
  Whole whole{Eigen::MatrixXd::Zero(k, k), 0};
  for (Eigen::Index i = 0; i < n; i += 4096) {
    const auto part = q.middleRows(i, std::min<Eigen::Index>(4096, n - i));
    whole.m += (part.transpose() * part).cast<double>();
  }
  for (const float rest : basis.rest()) whole.rest += static_cast<double>(rest) * static_cast<double>(rest);
  whole.m /= static_cast<double>(n);
  whole.rest /= static_cast<double>(n);
  return whole;
}

// Ratio of the largest to the smallest singular value of rows of Q', at most K of them.
double condition_of(const Eigen::MatrixXd& columns) {
  const Eigen::MatrixXd gram = columns.cols() <= columns.rows() ? Eigen::MatrixXd(columns.transpose() * columns)
                                                                : Eigen::MatrixXd(columns * columns.transpose());
  const linear::SymmetricEigen<Eigen::MatrixXd> eigen(gram, Eigen::EigenvaluesOnly);
  const double least = eigen.eigenvalues().minCoeff(), most = eigen.eigenvalues().maxCoeff();
  return least > 1e-14 * most ? std::sqrt(most / least) : 1e7;
}

class Search {
 public:
  Search(const Candidates& c, const Known& known, const Whole& whole, Criterion criterion)
      : c_(c), known_(known), whole_(whole), criterion_(criterion), s_(inverse_of(known.information)) {}

  std::vector<std::size_t> best(std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) take(next());
    for (int sweep = 0, changed = 1; changed && sweep < most_sweeps; ++sweep) {
      changed = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t old = taken_.front();
        drop_first();
        const std::size_t candidate = next();
        const bool better = candidate != old && gain(candidate) > gain(old) + 1e-9 * std::abs(gain(old));
        take(better ? candidate : old);
        changed += better;
      }
    }
    return taken_;
  }

 private:
  bool is_taken(std::size_t i) const { return std::ranges::find(taken_, i) != taken_.end(); }

  double gain(std::size_t i) const {
    const auto q = c_.q.col(static_cast<Eigen::Index>(i));
    const double r = c_.noise[static_cast<Eigen::Index>(i)];
    if (criterion_ == Criterion::condition) {
      const Eigen::Index before = known_.q.cols();
      Eigen::MatrixXd columns(c_.q.rows(), before + static_cast<Eigen::Index>(taken_.size()) + 1);
      columns.leftCols(before) = known_.q;
      for (std::size_t k = 0; k < taken_.size(); ++k)
        columns.col(before + static_cast<Eigen::Index>(k)) = c_.q.col(static_cast<Eigen::Index>(taken_[k]));
      columns.col(columns.cols() - 1) = q;
      return columns.cols() == 1 ? q.norm() : -condition_of(columns);
    }
    const Eigen::VectorXd sq = s_ * q;
    const double seen = q.dot(sq);
    return criterion_ == Criterion::determinant ? std::log1p(seen / r) : sq.dot(whole_.m * sq) / (r + seen);
  }

  std::size_t next() const {
    std::vector<double> gains(c_.pairs.size(), -std::numeric_limits<double>::infinity());
    parallel_for(
        0, gains.size(), [&](std::size_t i) { gains[i] = is_taken(i) ? gains[i] : gain(i); }, 64);
    return static_cast<std::size_t>(std::ranges::max_element(gains) - gains.begin());
  }

  void take(std::size_t i) {
    const auto q = c_.q.col(static_cast<Eigen::Index>(i));
    const Eigen::VectorXd sq = s_ * q;
    s_ -= sq * sq.transpose() / (c_.noise[static_cast<Eigen::Index>(i)] + q.dot(sq));
    taken_.push_back(i);
  }
  // Built anew: taking out by the rank-one formula loses digits where a pair says nearly all.
  void drop_first() {
    taken_.erase(taken_.begin());
    Eigen::MatrixXd information = known_.information;
    for (const std::size_t i : taken_) {
      const auto q = c_.q.col(static_cast<Eigen::Index>(i));
      information += q * q.transpose() / c_.noise[static_cast<Eigen::Index>(i)];
    }
    s_ = inverse_of(information);
  }

  const Candidates& c_;
  const Known& known_;
  const Whole& whole_;
  Criterion criterion_;
  Eigen::MatrixXd s_;
  std::vector<std::size_t> taken_;
};

// The order in which the mean variance falls fastest, and what remains after each.
void order(const Candidates& c, const Known& known, const Whole& whole, std::vector<std::size_t> chosen, Plan& plan) {
  Eigen::MatrixXd s = inverse_of(known.information);
  const auto left = [&] { return std::sqrt(std::max(0.0, s.cwiseProduct(whole.m).sum()) + whole.rest); };
  plan.before = left();
  while (!chosen.empty()) {
    double most = -1;
    std::size_t best = 0;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const auto q = c.q.col(static_cast<Eigen::Index>(chosen[k]));
      const Eigen::VectorXd sq = s * q;
      const double falls = sq.dot(whole.m * sq) / (c.noise[static_cast<Eigen::Index>(chosen[k])] + q.dot(sq));
      if (falls > most) best = k, most = falls;
    }
    const std::size_t i = chosen[best];
    const auto q = c.q.col(static_cast<Eigen::Index>(i));
    const Eigen::VectorXd sq = s * q;
    s -= sq * sq.transpose() / (c.noise[static_cast<Eigen::Index>(i)] + q.dot(sq));
    plan.pairs.push_back(c.pairs[i]);
    plan.sigma_ln.push_back(left());
    chosen.erase(chosen.begin() + static_cast<std::ptrdiff_t>(best));
  }
}

}  // namespace

Vec3 PlannedPair::wi() const {
  return direction(theta_i, phi_i);
}
Vec3 PlannedPair::wo() const {
  return direction(theta_o, phi_o);
}

Plan plan(const Basis& basis, std::size_t n, const PlanOptions& options) {
  const Candidates c = rows_of(basis, candidates(options), options);
  if (n == 0 || n > c.pairs.size())
    throw Error(Exit::usage, "--plan", "asks for " + std::to_string(n) + " directions",
                "between 1 and " + std::to_string(c.pairs.size()) + " are possible");
  const Known known = known_of(basis, options);
  const Whole whole = whole_of(basis);
  Plan result;
  result.candidates = c.pairs.size();
  order(c, known, whole, Search(c, known, whole, options.criterion).best(n), result);
  result.condition = plan_quality(basis, result.pairs, options).condition;
  return result;
}

PlanQuality plan_quality(const Basis& basis, const std::vector<PlannedPair>& pairs, const PlanOptions& options) {
  const Candidates c = rows_of(basis, pairs, options);
  const Whole whole = whole_of(basis);
  const Known known = known_of(basis, options);
  const Eigen::Index k = c.q.rows();
  const linear::Llt factor(known.information + c.q * c.noise.cwiseInverse().asDiagonal() * c.q.transpose());
  const Eigen::MatrixXd s = factor.solve(Eigen::MatrixXd::Identity(k, k));
  Eigen::MatrixXd rows(k, known.q.cols() + c.q.cols());
  rows << known.q, c.q;
  return {std::sqrt((s * whole.m).trace() + whole.rest), -2 * factor.diagonal().array().log().sum(),
          condition_of(rows)};
}

std::string plan_csv(const Plan& plan) {
  std::string text = "theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad,sigma_ln\n";
  for (std::size_t i = 0; i < plan.pairs.size(); ++i) {
    const PlannedPair& p = plan.pairs[i];
    text += format("%.6f,%.6f,%.6f,%.6f,%.4f\n", p.theta_i, p.phi_i, p.theta_o, p.phi_o, plan.sigma_ln[i]);
  }
  return text;
}

std::string plan_json(const Plan& plan) {
  std::string text = "{\"directions\": [";
  for (std::size_t i = 0; i < plan.pairs.size(); ++i) {
    const PlannedPair& p = plan.pairs[i];
    text += format("%s\n  {\"theta_i_rad\": %.6f, \"phi_i_rad\": %.6f, \"theta_o_rad\": %.6f, \"phi_o_rad\": %.6f}",
                   i ? "," : "", p.theta_i, p.phi_i, p.theta_o, p.phi_o);
  }
  return text + "\n]}\n";
}

}  // namespace gonio::goniometry
