// See anova.h. With y = Q theta + error, theta = R beta, a test of term T puts R's columns in the order
//   A   what the test comes after,   T,   B   what may explain T again (later terms; terms that contain T; none)
// and turns it into G U, G orthonormal: SS(T) = |G_T' Q'y|^2. Robust: the hypothesis is that neither B nor T is there,
// less that of B alone: with the Cholesky factor L of cov(G_[B T]' Q'y), the squares of L^-1 G_[B T]' Q'y that belong
// to T (car::Anova's conjugate complement; for type III nothing is in B).
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "linear/solve.h"
#include "stats/anova_projections.h"
#include "stats/incomplete_beta.h"
#include "stats/model_columns.h"

namespace gonio::stats {
namespace {

using Eigen::Index;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

void check(const Design& design, const std::vector<Term>& terms) {
  const std::size_t n = design.y.size();
  for (std::size_t i = 0; i < n; ++i)
    if (!std::isfinite(design.y[i]))
      throw Error(Exit::data, "results", format("observation %zu of %zu is not a finite number", i + 1, n),
                  "leave it out");
  if (design.level.size() != design.factors.size())
    throw Error(Exit::internal, "results", "levels are not given for every factor");
  for (std::size_t f = 0; f < design.factors.size(); ++f) {
    const int count = static_cast<int>(design.factors[f].levels.size());
    if (design.level[f].size() != n)
      throw Error(Exit::internal, design.factors[f].name, "levels are not given for every observation");
    std::set<int> seen(design.level[f].begin(), design.level[f].end());
    if (!seen.empty() && (*seen.begin() < 0 || *seen.rbegin() >= count))
      throw Error(Exit::internal, design.factors[f].name, "an observation has a level that the factor lacks");
    const bool used = std::any_of(terms.begin(), terms.end(), [&](const Term& t) {
      return std::find(t.begin(), t.end(), static_cast<int>(f)) != t.end();
    });
    if (used && (count < 2 || static_cast<int>(seen.size()) < count))
      throw Error(Exit::data, design.factors[f].name,
                  count < 2 ? format("the factor has %d level, at least 2 are needed", count)
                            : format("%zu of the factor's %d levels have observations", seen.size(), count),
                  "leave the factor out of the model, or the level out of the factor");
  }
  std::set<Term> once;
  for (const Term& t : terms) {
    for (const int f : t)
      if (f < 0 || at(f) >= design.factors.size())
        throw Error(Exit::internal, "terms", "a term names a factor that is not there");
    Term sorted = t;
    std::sort(sorted.begin(), sorted.end());
    if (t.empty() || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end() || !once.insert(sorted).second)
      throw Error(Exit::internal, "terms", "a term is empty or there twice");
  }
}

bool contains(Term large, Term small) {
  std::sort(large.begin(), large.end());
  std::sort(small.begin(), small.end());
  return large.size() > small.size() && std::includes(large.begin(), large.end(), small.begin(), small.end());
}

// Whether `other` stands before `term` in its test, or behind it.
bool before(const std::vector<Term>& terms, std::size_t other, std::size_t term, SumsOfSquares type) {
  switch (type) {
    case SumsOfSquares::type1: return other < term;
    case SumsOfSquares::type2: return !contains(terms[other], terms[term]);
    case SumsOfSquares::type3: return true;
  }
  return true;
}

struct Tested {
  double squares = 0, wald = 0;
  int degrees = 0;
};

Tested test(const Projections& fit, const ModelColumns& columns, std::size_t term, SumsOfSquares type, bool robust) {
  const Block own = columns.block(term);
  Eigen::MatrixXd ordered(fit.r.rows(), fit.r.cols());
  Index width = 0;
  const auto append = [&](Index first, Index count) {
    ordered.middleCols(width, count) = fit.r.middleCols(first, count);
    width += count;
  };
  append(0, 1);
  for (const bool behind : {false, true}) {
    for (std::size_t t = 0; t < fit.terms.size(); ++t)
      if (t != term && before(fit.terms, t, term, type) != behind)
        append(columns.block(t).first, columns.block(t).count);
    if (!behind) append(own.first, own.count);
  }
  Index first = 1;
  for (std::size_t t = 0; t < fit.terms.size(); ++t)
    if (t != term && before(fit.terms, t, term, type)) first += columns.block(t).count;
  const Triangle turned = triangle(std::move(ordered));
  const auto rank_before = [&](Index column) {
    return std::lower_bound(turned.kept.begin(), turned.kept.end(), static_cast<int>(column)) - turned.kept.begin();
  };
  const Index a = rank_before(first), b = rank_before(first + own.count), r = turned.q.cols();
  Tested result;
  result.degrees = static_cast<int>(b - a);
  result.squares = (turned.q.middleCols(a, b - a).transpose() * fit.z).squaredNorm();
  if (!robust || b == a) return result;
  Eigen::MatrixXd g(turned.q.rows(), r - a);
  g << turned.q.rightCols(r - b), turned.q.middleCols(a, b - a);
  const linear::Llt cholesky(g.transpose() * fit.covariance * g);
  const Eigen::VectorXd w = cholesky.solve_lower(g.transpose() * fit.z);
  result.wald = cholesky.info() == Eigen::Success ? w.tail(b - a).squaredNorm() : nan;
  return result;
}

// Covariance of Q'y: s^2, or Q' diag(w e^2) Q.
Eigen::MatrixXd covariance_of(const Anova& fit, Covariance covariance) {
  const Eigen::MatrixXd& q = fit.projections->q;
  const double n = static_cast<double>(q.rows()), left = fit.residual_degrees;
  if (covariance == Covariance::classical)
    return fit.residual_sum_of_squares / left * Eigen::MatrixXd::Identity(q.cols(), q.cols());
  Eigen::VectorXd weight(q.rows());
  for (Index i = 0; i < q.rows(); ++i) {
    const double e = fit.residuals[static_cast<std::size_t>(i)];
    const double rest = 1 - fit.leverage[static_cast<std::size_t>(i)];
    const bool divides = covariance == Covariance::hc2 || covariance == Covariance::hc3;
    if (divides && rest < 1e-9)
      throw Error(Exit::data, "results",
                  format("observation %d is fitted exactly (leverage 1), HC2 and HC3 have no variance for it",
                         static_cast<int>(i) + 1),
                  "take HC0 or HC1, or leave out the interaction that has it alone in a cell");
    switch (covariance) {
      case Covariance::classical:
      case Covariance::hc0: weight(i) = e * e; break;
      case Covariance::hc1: weight(i) = e * e * n / left; break;
      case Covariance::hc2: weight(i) = e * e / rest; break;
      case Covariance::hc3: weight(i) = e * e / (rest * rest); break;
    }
  }
  return q.transpose() * weight.asDiagonal() * q;
}

void fit_projections(const Design& design, const ModelColumns& columns, Anova& fit) {
  const auto n = static_cast<Index>(design.y.size());
  const Eigen::Map<const Eigen::VectorXd> y(design.y.data(), n);
  Triangle t = triangle(columns.matrix(design));
  Projections& p = *fit.projections;
  const auto rank = static_cast<int>(t.kept.size());
  if (n <= rank)
    throw Error(
        Exit::data, "results",
        format("%d observations for %d coefficients: nothing is left to test against", static_cast<int>(n), rank),
        "leave interactions out of the model, or add results");
  p.z = t.q.transpose() * y;
  const Eigen::VectorXd residual = y - t.q * p.z;
  fit.residuals.assign(residual.begin(), residual.end());
  const Eigen::VectorXd leverage = t.q.rowwise().squaredNorm();
  fit.leverage.assign(leverage.begin(), leverage.end());
  fit.residual_sum_of_squares = residual.squaredNorm();
  fit.total_sum_of_squares = (y.array() - y.mean()).matrix().squaredNorm();
  fit.total_degrees = static_cast<int>(n) - 1;
  fit.residual_degrees = static_cast<int>(n) - rank;
  if (!(fit.total_sum_of_squares > 1e-28 * y.squaredNorm()))
    throw Error(Exit::data, "results", "all observations are the same: there is nothing to explain");
  p.r = std::move(t.r);
  p.q = std::move(t.q);
  p.kept = std::move(t.kept);
}

std::size_t cells(const Design& design, const Term& term, std::map<std::vector<int>, int>& counts) {
  std::size_t all = 1;
  for (const int f : term) all *= design.factors[at(f)].levels.size();
  for (std::size_t i = 0; i < design.y.size(); ++i) {
    std::vector<int> cell;
    for (const int f : term) cell.push_back(design.level[at(f)][i]);
    ++counts[cell];
  }
  return all;
}

void describe_cells(const Design& design, const std::vector<Term>& terms, Anova& fit) {
  std::set<int> used;
  for (const Term& t : terms) {
    used.insert(t.begin(), t.end());
    std::map<std::vector<int>, int> counts;
    const std::size_t all = cells(design, t, counts);
    if (counts.size() == all) continue;
    fit.empty_cells += static_cast<int>(all - counts.size());
    fit.notes.push_back(
        format("%s: %zu of %zu cells are empty; its test, and type III tests of its factors, are about "
               "the cells that are there",
               term_name(design, t).c_str(), all - counts.size(), all));
  }
  std::map<std::vector<int>, int> counts;
  const std::size_t all = cells(design, Term(used.begin(), used.end()), counts);
  fit.balanced = counts.size() == all && std::all_of(counts.begin(), counts.end(), [&](const auto& cell) {
                   return cell.second == counts.begin()->second;
                 });
}

TermRow row_of(const Tested& tested, const Anova& fit, const Term& term, int columns, bool robust) {
  TermRow row;
  row.term = term;
  row.sum_of_squares = tested.squares;
  row.degrees = tested.degrees;
  row.aliased = columns - tested.degrees;
  if (row.degrees == 0) {
    row.mean_square = row.f = row.p = row.log10_p = nan;
    return row;
  }
  row.mean_square = tested.squares / tested.degrees;
  const double error = fit.residual_sum_of_squares / fit.residual_degrees;
  row.f = robust ? tested.wald / tested.degrees : row.mean_square / error;
  row.p = f_upper(row.f, row.degrees, fit.residual_degrees);
  row.log10_p = f_upper_log10(row.f, row.degrees, fit.residual_degrees);
  return row;
}

}  // namespace

std::vector<Term> main_effects_and_pairs(const Design& design) {
  std::vector<Term> terms;
  const int count = static_cast<int>(design.factors.size());
  for (int a = 0; a < count; ++a) terms.push_back({a});
  for (int a = 0; a < count; ++a)
    for (int b = a + 1; b < count; ++b) terms.push_back({a, b});
  return terms;
}

std::string term_name(const Design& design, const Term& term) {
  std::string name;
  for (const int f : term) name += (name.empty() ? "" : ":") + design.factors[at(f)].name;
  return name;
}

Anova anova(const Design& design, const std::vector<Term>& terms, SumsOfSquares type, Covariance covariance) {
  check(design, terms);
  const ModelColumns columns(design, terms);
  const bool robust = covariance != Covariance::classical;
  Anova fit;
  fit.projections = std::make_shared<Projections>();
  fit.projections->terms = terms;
  fit_projections(design, columns, fit);
  describe_cells(design, terms, fit);
  fit.projections->covariance = covariance_of(fit, covariance);
  for (std::size_t t = 0; t < terms.size(); ++t) {
    const Tested tested = test(*fit.projections, columns, t, type, robust);
    fit.rows.push_back(row_of(tested, fit, terms[t], columns.block(t).count, robust));
    if (fit.rows.back().aliased > 0)
      fit.notes.push_back(format("%s: %d of %d columns cannot be told from other terms",
                                 term_name(design, terms[t]).c_str(), fit.rows.back().aliased, columns.block(t).count));
  }
  add_coefficients(design, fit);
  return fit;
}

double f_upper_log10(double f, double degrees1, double degrees2) {
  if (std::isnan(f)) return nan;
  if (!(f > 0)) return 0;
  if (std::isinf(f)) return -std::numeric_limits<double>::infinity();
  const double all = degrees2 + degrees1 * f;
  return log_beta_regularised(degrees2 / all, degrees1 * f / all, degrees2 / 2, degrees1 / 2) / std::log(10.0);
}

double f_upper(double f, double degrees1, double degrees2) {
  return std::exp(std::log(10.0) * f_upper_log10(f, degrees1, degrees2));
}

}  // namespace gonio::stats
