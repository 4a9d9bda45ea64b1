// Analysis of variance of linear models of categorical factors: main effects and chosen interactions, balanced or not.
//
//   y = mu + sum of main effects + sum of interactions + error,     y in any unit
//
// Coding: sum to zero (the last level's coefficient is minus the sum of the others), so that type III tests are the
// hypotheses about unweighted marginal means (Searle 1987). Sums of squares:
//   type I    sequential, in the order of the terms (R's aov / anova)
//   type II   each term after all others that do not contain it (car::Anova type 2; Fox 2016, section 8.2)
//   type III  each term after all others (car::Anova type 3 with contr.sum)
// Robust: Wald tests of the same hypotheses with a heteroscedasticity-consistent covariance (HC0 to HC3; Long & Ervin
// 2000; White 1980), as car::Anova(white.adjust=) has it.
// Least squares by rank-revealing QR of the model matrix (columns that the design cannot tell apart are dropped and
// reported as aliased); a sum of squares is a difference of squared projections, never of residual sums of two fits.
// With empty cells a hypothesis is what the columns that remain can tell; type III then depends on which cells are
// empty (Searle 1987, section 9.2), and notes say so.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gonio::stats {

struct Factor {
  std::string name;
  std::vector<std::string> levels;  // in order
};
struct Design {
  std::vector<Factor> factors;
  std::vector<std::vector<int>> level;  // [factor][observation]
  std::vector<double> y;
};
// A term is a set of factors by index: {0} a main effect, {0, 2} an interaction.
using Term = std::vector<int>;
std::vector<Term> main_effects_and_pairs(const Design& design);
std::string term_name(const Design& design, const Term& term);  // "algorithm:path"

enum class SumsOfSquares { type1, type2, type3 };
enum class Covariance { classical, hc0, hc1, hc2, hc3 };

struct TermRow {
  Term term;
  double sum_of_squares = 0;  // of the classical test also where f and p are robust
  int degrees = 0;
  double mean_square = 0, f = 0, p = 1;  // p to 1e-10 relative down to 1e-300; NaN where degrees are 0
  double log10_p = 0;
  int aliased = 0;  // columns that the design could not tell from those that the test comes after
};
// A coefficient, sum to zero; every level has one, the last ones follow from the others.
struct Coefficient {
  Term term;
  std::vector<int> levels;  // of the term's factors
  double value = 0, sigma = 0;
  bool estimable = true;
};
struct Projections;  // what marginal means and ranks need of the fit: anova_projections.h
struct Anova {
  std::vector<TermRow> rows;
  double mean = 0, sigma_mean = 0;  // mu: the mean of cell means
  double residual_sum_of_squares = 0, total_sum_of_squares = 0;
  int residual_degrees = 0, total_degrees = 0;
  std::vector<Coefficient> coefficients;
  bool balanced = false;
  int empty_cells = 0;  // combinations of the interactions' levels without an observation
  std::vector<double> residuals, leverage;
  std::vector<std::string> notes;
  std::shared_ptr<Projections> projections;
};
// Error(data) at the factor's name or "results" for a factor with fewer than two levels that occur, no more
// observations than coefficients, y that is not finite, a y that is the same everywhere; for HC2 and HC3 where an
// observation is fitted exactly (leverage 1).
Anova anova(const Design& design, const std::vector<Term>& terms, SumsOfSquares type,
            Covariance covariance = Covariance::classical);

// mu + every coefficient of the terms made of these factors: the expected y at their levels, all else averaged with
// equal weight (estimated marginal means; "mu + a_i + s_k + as_ik"). sigma from the chosen covariance.
struct MarginalMean {
  std::vector<int> levels;
  double value = 0, sigma = 0;
  int observations = 0;
  bool estimable = true;
};
std::vector<MarginalMean> marginal_means(const Anova& fit, const Design& design, const Term& factors);

double f_upper(double f, double degrees1, double degrees2);        // P(F > f)
double f_upper_log10(double f, double degrees1, double degrees2);  // for tails below 1e-300

// Ranks of one factor's levels by their marginal mean. Ascending: rank 1 has the least mean.
//
// Differences of means are drawn by a wild bootstrap in which observations of one block (those that share a sequence)
// turn their residuals' signs together (Wu 1986; Cameron, Gelbach & Miller 2008), the residuals of a block being those
// of a fit without it (CR3: Bell & McCaffrey 2002; MacKinnon, Nielsen & Webb 2023). A percentile of drawn ranks does
// not cover where means are close; the interval here is that of Mogstad, Romano, Shaikh & Wilhelm 2024: of level i, all
// ranks that its simultaneous intervals of differences to the others allow. It covers with at least `confidence` for
// each level, ties included (any rank among the tied is right).
struct Rank {
  int level = 0;
  double mean = 0;
  double rank = 0, lower = 0, upper = 0;  // 1 to number of levels; tied means share the mean of their ranks
  double best_share = 0;                  // of the draws in which it was first
};
// `blocks`: a number for each observation; empty: each is its own. Error(data) for fewer than 3 blocks, and where the
// design cannot compare two levels.
std::vector<Rank> bootstrap_ranks(const Design& design, const std::vector<Term>& terms, int factor,
                                  std::span<const int> blocks, int draws, double confidence, unsigned long long seed);

}  // namespace gonio::stats
