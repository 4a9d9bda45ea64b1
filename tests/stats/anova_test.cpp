// Analysis of variance against R (anova/reference.R made the data and the values), against published degrees of freedom
// and p-values, and for what must hold of any. Statistical claims: fixed seeds, false-alarm rates beside them.
#include "stats/anova.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/error.h"
#include "base/random.h"
#include "io/csv.h"
#include "stats/distributions.h"

namespace gonio::stats {
namespace {

// Columns a to e and y of the rows of `set`; a factor's levels in the order of their names.
Design design_of(const io::Csv& csv, const std::string& set) {
  Design d;
  for (std::size_t c = 1; c <= 5; ++c) {
    std::map<std::string, int> index;
    for (const auto& row : csv.rows)
      if (row[0] == set && !row[c].empty()) index[row[c]] = 0;
    if (index.empty()) continue;
    Factor f{csv.header[c], {}};
    for (auto& [name, i] : index) i = int(f.levels.size()), f.levels.push_back(name);
    d.factors.push_back(f);
    d.level.emplace_back();
    for (const auto& row : csv.rows)
      if (row[0] == set) d.level.back().push_back(index[row[c]]);
  }
  for (std::size_t i = 0; i < csv.rows.size(); ++i)
    if (csv.rows[i][0] == set) d.y.push_back(io::csv_number(csv.rows[i][6], csv.place(i)));
  return d;
}
const io::Csv& data() {
  static const io::Csv csv = io::read_csv(GONIO_SOURCE "/tests/stats/anova/data.csv");
  return csv;
}

const std::map<std::string, Covariance> covariances = {{"classical", Covariance::classical},
                                                       {"hc0", Covariance::hc0},
                                                       {"hc1", Covariance::hc1},
                                                       {"hc2", Covariance::hc2},
                                                       {"hc3", Covariance::hc3}};

TEST(Anova, AgreesWithR) {
  const io::Csv reference = io::read_csv(GONIO_SOURCE "/tests/stats/anova/reference.csv");
  std::map<std::vector<std::string>, Anova> fits;
  int sums = 0, robust = 0;
  for (std::size_t i = 0; i < reference.rows.size(); ++i) {
    const auto& r = reference.rows[i];
    const Design d = design_of(data(), r[0]);
    auto [it, fresh] = fits.try_emplace({r[0], r[1], r[2]});
    if (fresh) {
      const std::vector<Term> main = {{0}, {1}};
      it->second = anova(d, r[0] == "tails" ? main : main_effects_and_pairs(d), SumsOfSquares(std::stoi(r[1]) - 1),
                         covariances.at(r[2]));
    }
    const auto row = std::find_if(it->second.rows.begin(), it->second.rows.end(),
                                  [&](const TermRow& t) { return term_name(d, t.term) == r[3]; });
    ASSERT_NE(row, it->second.rows.end()) << reference.place(i);
    const double f = io::csv_number(r[6], "F"), log_p = io::csv_number(r[7], "p");
    EXPECT_EQ(row->degrees, std::stoi(r[4])) << reference.place(i);
    EXPECT_NEAR(row->f / f, 1, 1e-9) << reference.place(i);
    EXPECT_NEAR(row->log10_p * std::log(10.0), log_p, 1e-8) << reference.place(i);
    EXPECT_NEAR(row->p / std::exp(log_p), 1, 1e-8) << reference.place(i);
    if (!r[5].empty()) {
      EXPECT_NEAR(row->sum_of_squares / io::csv_number(r[5], "SS"), 1, 1e-9) << reference.place(i);
    }
    ++(r[5].empty() ? robust : sums);
  }
  EXPECT_EQ(fits.size(), 46u);
  EXPECT_GT(sums, 80);
  EXPECT_GT(robust, 150);
}

// Values: R 4.2.2, pf(f, d1, d2, lower.tail = FALSE, log.p = TRUE).
TEST(Anova, TailsOfF) {
  const auto log_p = [](double f, double a, double b) { return f_upper_log10(f, a, b) * std::log(10.0); };
  EXPECT_NEAR(log_p(204.8, 15, 689), -555.48657787331103, 1e-9);
  EXPECT_NEAR(log_p(2000, 17, 2000), -2848.5093175210368, 1e-8);
  EXPECT_NEAR(log_p(1e-3, 3, 40), -4.4473368350439932e-05, 1e-15);
  EXPECT_NEAR(log_p(1.02, 500, 2), -0.47141894827176251, 1e-10);
  EXPECT_NEAR(log_p(1e9, 1, 1), -10.813215624095994, 1e-10);
  EXPECT_LT(f_upper_log10(2000, 17, 20000), -1000);
  EXPECT_EQ(f_upper(0, 3, 9), 1);
}

// Jensen et al. 2018, tables 3 and 10: from the printed F (one digit behind the point) and degrees of freedom, p comes
// out as printed, where it is printed at all within what the rounding of F leaves.
TEST(Anova, PublishedValuesOfP) {
  struct Printed {
    double f, degrees, p, p_digit;
  };
  const auto check = [](const std::vector<Printed>& rows, double error) {
    for (const Printed& r : rows) {
      const double most = f_upper(r.f - 0.05, r.degrees, error), least = f_upper(r.f + 0.05, r.degrees, error);
      EXPECT_LE(r.p - r.p_digit / 2, most) << r.f << " " << r.degrees;
      EXPECT_GE(r.p + r.p_digit / 2, least) << r.f << " " << r.degrees;
    }
  };
  check({{204.8, 15, 5.5e-242, 1e-243},
         {90.4, 1, 3.2e-20, 1e-21},
         {219.0, 4, 3.6e-121, 1e-122},
         {25.6, 5, 9.3e-24, 1e-25},
         {5.9, 60, 2.9e-33, 1e-34},
         {4.7, 75, 2.3e-28, 1e-29},
         {2.7, 4, 0.03, 0.01},
         {3.1, 5, 0.0086, 1e-4},
         {4.9, 20, 2.3e-11, 1e-12}},
        689);
  check({{90.9, 8, 7.7e-108, 1e-109},
         {81.6, 1, 1.2e-18, 1e-19},
         {106.5, 4, 3.8e-73, 1e-74},
         {47.0, 5, 8.8e-43, 1e-44},
         {89.8, 1, 2.7e-20, 1e-21},
         {2.9, 32, 3.4e-7, 1e-8},
         {8.0, 40, 6.4e-37, 1e-38},
         {7.5, 8, 1.1e-9, 1e-10},
         {3.7, 4, 0.0052, 1e-4},
         {2.9, 5, 0.013, 1e-3},
         {1.6, 1, 0.2, 0.1},
         {7.8, 20, 6.7e-21, 1e-22},
         {5.1, 4, 0.00048, 1e-5},
         {9.3, 5, 1.4e-8, 1e-9}},
        824);
}

// A crossed design of algorithms x camera x animatronic x path (x missing), less some results, as the paper's were.
Design crossed(const std::vector<int>& counts, std::size_t results, std::uint64_t seed) {
  Design d;
  const char* names[] = {"a", "m", "s", "p", "d"};
  std::size_t all = 1;
  for (std::size_t f = 0; f < counts.size(); ++f) {
    d.factors.push_back({names[f], {}});
    for (int l = 0; l < counts[f]; ++l) d.factors[f].levels.push_back(std::to_string(l));
    all *= std::size_t(counts[f]);
  }
  d.level.resize(counts.size());
  Random random(seed);
  std::vector<std::size_t> order(all);
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t i = all; i > 1; --i) std::swap(order[i - 1], order[random.below(std::uint32_t(i))]);
  for (std::size_t i = 0; i < results; ++i) {
    std::size_t rest = order[i];
    for (std::size_t f = counts.size(); f-- > 0; rest /= std::size_t(counts[f]))
      d.level[f].push_back(int(rest % std::size_t(counts[f])));
    d.y.push_back(50 + 3 * d.level[0].back() + random.normal());
  }
  return d;
}

std::vector<Term> pairs_but(const Design& d, const Term& left_out) {
  std::vector<Term> terms = main_effects_and_pairs(d);
  std::erase(terms, left_out);
  return terms;
}

// Table 3 prints 15 degrees for algorithms (16 of them) and a total of 878, that is 879 results; its sums of degrees
// agree with each other (189 + 689 = 878), but not with table 4 beside it, which has 18 algorithms (17 degrees, 1050
// results with one algorithm under one camera). Table 10: 9 algorithms and 963 results (138 + 824 = 962), of 1080;
// table 13 beside it has 10 algorithms.
TEST(Anova, PublishedDegreesOfFreedom) {
  const auto degrees = [](const Anova& fit) {
    std::vector<int> list;
    for (const TermRow& r : fit.rows) list.push_back(r.degrees);
    list.push_back(fit.residual_degrees);
    list.push_back(fit.total_degrees);
    return list;
  };
  const Design complete = crossed({16, 2, 5, 6}, 879, 4);
  EXPECT_EQ(degrees(anova(complete, pairs_but(complete, {0, 1}), SumsOfSquares::type3)),
            (std::vector<int>{15, 1, 4, 5, 60, 75, 4, 5, 20, 689, 878}));
  const Design missing = crossed({9, 2, 5, 6, 2}, 963, 5);
  const Anova fit = anova(missing, pairs_but(missing, {0, 1}), SumsOfSquares::type3);
  EXPECT_EQ(degrees(fit), (std::vector<int>{8, 1, 4, 5, 1, 32, 40, 8, 4, 5, 1, 20, 4, 5, 824, 962}));
  EXPECT_FALSE(fit.balanced);
  EXPECT_TRUE(fit.notes.empty());
}

TEST(Anova, CoefficientsSumToZero) {
  const Design d = design_of(data(), "unbalanced3");
  const Anova fit = anova(d, main_effects_and_pairs(d), SumsOfSquares::type3);
  std::map<std::tuple<Term, std::size_t, int>, double> sums;  // over the other factor's levels
  for (const Coefficient& c : fit.coefficients)
    for (std::size_t i = 0; i < c.term.size(); ++i)
      sums[{c.term, i, c.term.size() == 1 ? 0 : c.levels[1 - i]}] += c.value;
  EXPECT_GT(sums.size(), 10u);
  for (const auto& [key, sum] : sums) EXPECT_NEAR(sum, 0, 1e-11);
  // Marginal means: emmeans' definition, every other factor averaged with equal weight.
  const auto means = marginal_means(fit, d, {0});
  const auto pairs = marginal_means(fit, d, {0, 1});
  for (std::size_t a = 0; a < 4; ++a) {
    double mean = 0;
    for (std::size_t b = 0; b < 3; ++b) mean += pairs[3 * a + b].value / 3;
    EXPECT_NEAR(mean, means[a].value, 1e-11);
  }
}

TEST(Anova, BalancedTypesAgreeAndMeansAreAverages) {
  const Design d = design_of(data(), "balanced2");
  const auto terms = main_effects_and_pairs(d);
  const Anova one = anova(d, terms, SumsOfSquares::type1), two = anova(d, terms, SumsOfSquares::type2),
              three = anova(d, terms, SumsOfSquares::type3);
  EXPECT_TRUE(three.balanced);
  double explained = 0;
  for (std::size_t t = 0; t < terms.size(); ++t) {
    EXPECT_NEAR(one.rows[t].sum_of_squares / two.rows[t].sum_of_squares, 1, 1e-12);
    EXPECT_NEAR(one.rows[t].sum_of_squares / three.rows[t].sum_of_squares, 1, 1e-12);
    explained += one.rows[t].sum_of_squares;
  }
  EXPECT_NEAR(explained + one.residual_sum_of_squares, one.total_sum_of_squares, 1e-11 * one.total_sum_of_squares);
  for (const MarginalMean& m : marginal_means(three, d, {1})) {
    double sum = 0;
    for (std::size_t i = 0; i < d.y.size(); ++i) sum += d.level[1][i] == m.levels[0] ? d.y[i] : 0;
    EXPECT_EQ(m.observations, 9);
    EXPECT_NEAR(m.value, sum / 9, 1e-12);
    EXPECT_NEAR(m.sigma, std::sqrt(three.residual_sum_of_squares / three.residual_degrees / 9), 1e-12);
  }
}

// Levels, rows and factors named in another order: the same numbers.
TEST(Anova, OrderDoesNotMatter) {
  const Design d = design_of(data(), "unbalanced5");
  Design turned = d;
  const std::size_t n = d.y.size(), f = d.factors.size();
  for (std::size_t i = 0; i < n; ++i) {
    turned.y[i] = d.y[(i * 7 + 3) % n];
    for (std::size_t k = 0; k < f; ++k)
      turned.level[k][i] = int(d.factors[f - 1 - k].levels.size()) - 1 - d.level[f - 1 - k][(i * 7 + 3) % n];
  }
  ASSERT_NE(n % 7, 0u);
  for (std::size_t k = 0; k < f; ++k) turned.factors[k] = d.factors[f - 1 - k];
  for (const SumsOfSquares type : {SumsOfSquares::type2, SumsOfSquares::type3})
    for (const Covariance covariance : {Covariance::classical, Covariance::hc3}) {
      const Anova a = anova(d, main_effects_and_pairs(d), type, covariance);
      const Anova b = anova(turned, main_effects_and_pairs(turned), type, covariance);
      EXPECT_NEAR(a.mean, b.mean, 1e-11 * std::abs(a.mean));
      for (const TermRow& row : a.rows) {
        Term same;
        for (const int k : row.term) same.push_back(int(f) - 1 - k);
        std::sort(same.begin(), same.end());
        const auto other = std::find_if(b.rows.begin(), b.rows.end(), [&](const TermRow& r) { return r.term == same; });
        ASSERT_NE(other, b.rows.end());
        EXPECT_NEAR(other->f / row.f, 1, 1e-9);
        EXPECT_NEAR(other->sum_of_squares / row.sum_of_squares, 1, 1e-9);
      }
    }
}

TEST(Anova, EmptyCellsAreToldAndWhatTheyHideIsNotEstimated) {
  const Design d = design_of(data(), "empty3");
  const Anova fit = anova(d, main_effects_and_pairs(d), SumsOfSquares::type3);
  EXPECT_EQ(fit.empty_cells, 2);
  EXPECT_EQ(fit.rows[3].degrees, 4);
  EXPECT_EQ(fit.rows[3].aliased, 2);
  EXPECT_GE(fit.notes.size(), 2u);
  const auto cells = marginal_means(fit, d, {0, 1});
  for (const MarginalMean& m : cells) EXPECT_EQ(m.estimable, m.observations > 0);
  // Without the interaction every mean can be told.
  for (const MarginalMean& m : marginal_means(anova(d, {{0}, {1}, {2}}, SumsOfSquares::type3), d, {0, 1}))
    EXPECT_TRUE(m.estimable);
}

std::string refusal(const Design& d, const std::vector<Term>& terms, Covariance covariance = Covariance::classical) {
  try {
    anova(d, terms, SumsOfSquares::type3, covariance);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    return e.what();
  }
  return "";
}

TEST(Anova, RefusesWhatCannotBeTested) {
  const Design good = design_of(data(), "unbalanced3");
  Design d = good;
  d.y[4] = NAN;
  EXPECT_NE(refusal(d, {{0}}).find("observation 5 of 51 is not a finite number"), std::string::npos);
  d = good;
  d.factors[2].levels = {"1"};
  std::fill(d.level[2].begin(), d.level[2].end(), 0);
  EXPECT_NE(refusal(d, {{0}, {2}}).find("c: the factor has 1 level"), std::string::npos);
  EXPECT_EQ(refusal(d, {{0}, {1}}), "");
  d = good;
  d.factors[0].levels.push_back("5");
  EXPECT_NE(refusal(d, {{0}}).find("4 of the factor's 5 levels"), std::string::npos);
  d = good;
  std::fill(d.y.begin(), d.y.end(), 2.5);
  EXPECT_NE(refusal(d, {{0}}).find("all observations are the same"), std::string::npos);
  d = good;
  for (auto& level : d.level) level.resize(6);
  d.y.resize(6);
  for (std::size_t i = 0; i < 6; ++i) d.level[0][i] = int(i) % 4, d.level[1][i] = int(i) % 3;
  EXPECT_NE(refusal(d, {{0}, {1}}).find("6 observations for 6 coefficients"), std::string::npos);
  d = good;  // one observation alone at a level
  for (int& l : d.level[0]) l = l == 3 ? 2 : l;
  d.level[0][0] = 3;
  EXPECT_NE(refusal(d, {{0}}, Covariance::hc3).find("observation 1 is fitted exactly"), std::string::npos);
  EXPECT_EQ(refusal(d, {{0}}, Covariance::hc1), "");
}

}  // namespace
}  // namespace gonio::stats
