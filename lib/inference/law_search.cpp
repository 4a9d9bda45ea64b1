// See law_search.h.
#include "inference/law_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "linear/solve.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::inference {
namespace {

constexpr double least_survivor = 0.02;          // of a term's length, after projection
constexpr double fewest_blocks = 4;              // on which a term lives: what is large on one is that one's own number
constexpr std::size_t most_values = 15'000'000;  // of all terms on the rows on which they are ranked
constexpr std::size_t ranked_on_all = 12;        // the best of those, ranked again on all rows
constexpr std::size_t columns_at_once = 48;      // bounds the memory
constexpr double nearly_as_good = 0.85;          // of the best fall
constexpr std::size_t most_singles = 6;
constexpr double splits[] = {0.35, 0.5, 0.65};  // quantiles of the condition

struct Ranked {
  std::size_t place = 0;
  double fall = 0, worth = 0;  // worth: the fall less the price
};

// How much more the sum over blocks scatters than independent rows would.
double inflation(const LawData& data, const Term& term, const RawColumns& chosen) {
  RawColumns columns = chosen;
  columns.push_back(column_of(data.system(), term));
  const Eigen::VectorXd c = data.coefficients(columns, {});
  const double variance = data.covariance(columns, c)(c.size() - 1, c.size() - 1);
  const double fall = data.scores({columns.back()}, chosen)[0].fall, last = c[c.size() - 1];
  // fall = c^2 / naive variance
  return fall > 0 ? std::max(1.0, variance * fall / (last * last)) : 1;
}

// Every n-th block, so that ranking all terms stays affordable; empty: all rows.
Mask thinned(const LawData& data, std::size_t terms) {
  const Observations& o = data.system().observations();
  const std::size_t step = 1 + o.rows() * terms / most_values;
  if (step == 1) return {};
  Mask mask(o.rows());
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = o.block[i] % step == 0;
  return mask;
}

void rank(const LawData& data, const std::vector<Term>& possible, const std::vector<std::size_t>& places,
          const RawColumns& chosen, double price, const Mask& mask, std::vector<Ranked>& list) {
  list.clear();
  for (std::size_t first = 0; first < places.size(); first += columns_at_once) {
    const std::size_t last = std::min(places.size(), first + columns_at_once);
    RawColumns columns;
    for (std::size_t k = first; k < last; ++k) columns.push_back(column_of(data.system(), possible[places[k]], mask));
    const std::vector<Score> scores = data.scores(columns, chosen, mask);
    for (std::size_t k = first; k < last; ++k) {
      const Score& s = scores[k - first];
      if (s.survives > least_survivor && s.blocks >= fewest_blocks)
        list.push_back({places[k], s.fall, s.fall - price * possible[places[k]].price});
    }
  }
  std::stable_sort(list.begin(), list.end(), [](const Ranked& a, const Ranked& b) { return a.worth > b.worth; });
}

std::vector<Ranked> ranked(const LawData& data, const std::vector<Term>& possible, const RawColumns& chosen,
                           double price) {
  std::vector<std::size_t> places(possible.size());
  for (std::size_t k = 0; k < places.size(); ++k) places[k] = k;
  std::vector<Ranked> list;
  const Mask mask = thinned(data, possible.size());
  rank(data, possible, places, chosen, price, mask, list);
  if (mask.empty()) return list;
  places.clear();
  for (std::size_t k = 0; k < std::min(ranked_on_all, list.size()); ++k) places.push_back(list[k].place);
  rank(data, possible, places, chosen, price, {}, list);
  return list;
}

bool significant(const Ranked& best, double inflation, std::size_t looks, double level) {
  return stats::sidak(stats::chi2_upper(best.fall / inflation, 1), static_cast<double>(looks)) <= level;
}

// The scale that serves best on the rows of `mask`, by three rounds of ever finer steps about the present one.
Term refined(const LawData& data, Term term, const RawColumns& chosen, const Mask& mask, double reach) {
  if (!term.fitted_scale) return term;
  for (int round = 0; round < 4; ++round, reach = std::pow(reach, 0.35)) {
    std::vector<Term> around;
    RawColumns columns;
    for (int k = -3; k <= 3; ++k) {
      around.push_back(term);
      around.back().scale *= std::pow(reach, k / 3.0);
      columns.push_back(column_of(data.system(), around.back()));
    }
    const std::vector<Score> scores = data.scores(columns, chosen, mask);
    std::size_t best = 3;
    for (std::size_t k = 0; k < scores.size(); ++k)
      if (scores[k].survives > 1e-3 && scores[k].fall > scores[best].fall && is_readable(data.system(), around[k]))
        best = k;
    term = around[best];
  }
  return term;
}

RawColumns without(const LawData& data, const std::vector<Term>& terms, std::size_t place) {
  std::vector<Term> rest = terms;
  rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(place));
  return columns_of(data, rest);
}

// Hats over the fitted side's quantiles; beyond, the outermost ones go on.
RawColumns curve_columns(const System& system, std::size_t condition, const std::vector<double>& value,
                         const Mask& fitted) {
  constexpr std::size_t knots = 5;
  const Condition& c = system.observations().conditions[condition];
  std::vector<double> inside, at;
  for (std::size_t i = 0; i < value.size(); ++i)
    if (fitted[i]) inside.push_back(value[i]);
  for (std::size_t k = 0; k < knots; ++k) {
    const double q = stats::quantile(inside, static_cast<double>(k) / (knots - 1));
    if (at.empty() || q > at.back()) at.push_back(q);
  }
  RawColumns columns(at.size(), std::vector<double>(value.size(), 0.0));
  for (std::size_t i = 0; i < value.size() && at.size() > 1; ++i) {
    if (!std::isfinite(value[i])) continue;
    const auto above = std::clamp(std::upper_bound(at.begin(), at.end(), value[i]), at.begin() + 1, at.end() - 1);
    const auto k = static_cast<std::size_t>(above - at.begin());
    const double t = std::clamp((value[i] - at[k - 1]) / (at[k] - at[k - 1]), 0.0, 1.0);
    const double direction = c.direction.empty() ? 1 : c.direction[i];
    columns[k - 1][i] = (1 - t) * direction;
    columns[k][i] = t * direction;
  }
  return columns;
}

// The law's columns and coefficients of all rows, and what one way across a split needs beside them.
struct Law {
  RawColumns columns;
  Eigen::MatrixXd projected;  // [columns, residual]
  Eigen::VectorXd coefficients;
};

// Rows of `m` where the mask is set.
Eigen::MatrixXd rows_of(const Eigen::MatrixXd& m, const Mask& mask) {
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask[i]) rows.push_back(static_cast<Eigen::Index>(i));
  return m(rows, Eigen::all);
}

double fall_of(const Eigen::MatrixXd& part, const Eigen::VectorXd& c) {
  const Eigen::VectorXd r = part.rightCols(1), p = part.leftCols(part.cols() - 1) * c;
  return 2 * r.dot(p) - p.squaredNorm();
}

// How much there is to tell, without a look at how well the law does.
Way expectation(const LawData& data, const Law& law, const Mask& fitted, const Mask& judged, double spread,
                Eigen::VectorXd& c) {
  Eigen::MatrixXd variance;
  c = data.coefficients(law.columns, fitted, &variance);
  const Eigen::MatrixXd part = rows_of(law.projected, judged);
  const Eigen::MatrixXd p = part.leftCols(part.cols() - 1), gram = p.transpose() * p;
  Way way;
  way.expected = law.coefficients.dot(gram * law.coefficients) / spread;
  way.unsure = (gram * variance).trace();
  return way;
}

void judge(const LawData& data, const Law& law, const Eigen::VectorXd& c, const RawColumns& hats, const Mask& fitted,
           const Mask& judged, Way& way) {
  const Observations& o = data.system().observations();
  const Eigen::MatrixXd part = rows_of(law.projected, judged);
  const Eigen::MatrixXd p = part.leftCols(part.cols() - 1), r = part.rightCols(1);
  way.law = fall_of(part, c);
  way.own = fall_of(part, linear::solve_ldlt(p.transpose() * p, p.transpose() * r).col(0));
  way.curve = fall_of(rows_of(data.projected(hats), judged), data.coefficients(hats, fitted));
  way.block.assign(data.blocks(), 0.0);
  double norm = 0;
  for (std::size_t i = 0; i < o.rows(); ++i) {
    const double w = data.system().weight(i);
    if (!judged[i] || !(w > 0)) continue;
    const auto row = static_cast<Eigen::Index>(i);
    const double before = law.projected(row, law.projected.cols() - 1);
    const double after = before - law.projected.row(row).head(c.size()).dot(c);
    way.block[o.block[i]] += before * before - after * after;
    way.before += before * before / (w * w);
    way.after += after * after / (w * w);
    norm += o.norm[i];
  }
  way.before = norm > 0 ? std::sqrt(way.before / norm) : 0;
  way.after = norm > 0 ? std::sqrt(way.after / norm) : 0;
}

// Values of the condition by which rows are split; by size where it takes both signs.
std::vector<double> split_values(const System& system, Extrapolation& x) {
  std::vector<double> value = system.observations().conditions[x.condition].values;
  std::size_t below = 0, above = 0;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (!(system.weight(i) > 0)) value[i] = std::numeric_limits<double>::quiet_NaN();
    if (std::isfinite(value[i])) ++(value[i] < 0 ? below : above);
  }
  x.by_size = !kind_of(system, x.condition).periodic && 10 * std::min(below, above) > below + above;
  for (double& v : value) v = x.by_size ? std::abs(v) : v;
  return value;
}

// Every way that tells must repair half of what a fit in its place would, all together beyond two standard errors and
// more than the curve.
void sum_up(std::size_t blocks, Extrapolation& x) {
  std::vector<double> fall(blocks, 0.0);
  double curve = 0;
  bool each = true, any = false;
  for (const Way* way : {&x.outwards, &x.inwards}) {
    if (!way->tells()) continue;
    any = true;
    each = each && way->law >= 0.5 * way->own;
    x.law += way->law;
    curve += way->curve;
    for (std::size_t b = 0; b < blocks; ++b) fall[b] += way->block[b];
  }
  const double mean = x.law / std::max<double>(1, static_cast<double>(blocks));
  for (const double f : fall) x.sigma += (f - mean) * (f - mean);
  x.sigma = std::sqrt(x.sigma);
  x.passes = any && each && x.law > 2 * x.sigma && x.law > curve;
}

}  // namespace

RawColumns free_curve(const System& system, std::size_t condition) {
  const std::vector<double>& value = system.observations().conditions[condition].values;
  Mask used(value.size());
  for (std::size_t i = 0; i < value.size(); ++i) used[i] = system.weight(i) > 0 && std::isfinite(value[i]);
  return curve_columns(system, condition, value, used);
}

RawColumns columns_of(const LawData& data, const std::vector<Term>& terms) {
  RawColumns columns;
  for (const Term& t : terms) columns.push_back(column_of(data.system(), t));
  return columns;
}

std::vector<double> combined(const RawColumns& columns, const Eigen::VectorXd& coefficients) {
  std::vector<double> sum(columns.empty() ? 0 : columns[0].size(), 0.0);
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += coefficients[static_cast<Eigen::Index>(c)] * columns[c][i];
  return sum;
}

std::vector<Term> good_singles(const LawData& data, const std::vector<Term>& possible, double level) {
  std::vector<Ranked> list = ranked(data, possible, {}, 1);
  if (list.empty()) return {};
  const double spread = inflation(data, possible[list[0].place], {});
  if (!significant(list[0], spread, possible.size(), level)) return {};
  list = ranked(data, possible, {}, spread);
  std::vector<Term> result;
  for (const Ranked& r : list) {
    if (r.worth < nearly_as_good * list[0].worth || result.size() == most_singles) break;
    Term term = refined(data, possible[r.place], {}, {}, 1.63);
    const auto alike = [&](const Term& t) {
      return t.fitted_scale && term.fitted_scale && t.shape_of == term.shape_of;
    };
    if (std::none_of(result.begin(), result.end(), alike)) result.push_back(std::move(term));
  }
  return result;
}

std::vector<Term> with_one_more(const LawData& data, const std::vector<Term>& possible, std::vector<Term> terms,
                                double level) {
  const RawColumns chosen = columns_of(data, terms);
  const std::vector<Ranked> list = ranked(data, possible, chosen, 1);
  if (list.empty()) return {};
  const double spread = inflation(data, possible[list[0].place], chosen);
  if (!significant(list[0], spread, possible.size(), level)) return {};
  terms.push_back(refined(data, possible[list[0].place], chosen, {}, 1.63));
  for (std::size_t place = 0; place + 1 < terms.size(); ++place) {
    const RawColumns rest = without(data, terms, place);
    const std::vector<Ranked> others = ranked(data, possible, rest, spread);
    const double present = data.scores({column_of(data.system(), terms[place])}, rest)[0].fall;
    if (others.empty() || others[0].worth <= present - spread * terms[place].price) continue;
    terms[place] = refined(data, possible[others[0].place], rest, {}, 1.63);
  }
  return terms;
}

namespace {

Law law_of(const LawData& data, const std::vector<Term>& terms) {
  Law law{columns_of(data, terms), {}, {}};
  law.projected = data.projected(law.columns);
  law.coefficients = data.coefficients(law.columns, {});
  return law;
}

struct Split {
  double at = 0, told = -1;
  Mask inner, outer;
  std::shared_ptr<const Law> of_inner, of_outer;  // as either side would have it
  Way outwards, inwards;
  Eigen::VectorXd inner_c, outer_c;
};

}  // namespace

Extrapolation extrapolate(const LawData& data, const std::vector<Term>& terms, std::size_t condition,
                          const Tuned& tuned) {
  const System& system = data.system();
  Extrapolation x{.condition = condition};
  const std::vector<double> value = split_values(system, x);
  std::vector<double> used;
  for (const double v : value)
    if (std::isfinite(v)) used.push_back(v);
  const auto law = std::make_shared<const Law>(law_of(data, terms));
  const auto law_on = [&](const Mask& mask) {
    return tuned ? std::make_shared<const Law>(law_of(data, tuned(mask))) : law;
  };
  const double spread = inflation(data, terms.back(), {law->columns.begin(), law->columns.end() - 1});
  Split best;
  for (const double q : splits) {
    Split s{stats::quantile(used, q), 0, Mask(value.size(), 0), Mask(value.size(), 0), {}, {}, {}, {}, {}, {}};
    for (std::size_t i = 0; i < value.size(); ++i)
      if (std::isfinite(value[i])) (value[i] <= s.at ? s.inner : s.outer)[i] = 1;
    s.of_inner = law_on(s.inner), s.of_outer = law_on(s.outer);
    s.outwards = expectation(data, *s.of_inner, s.inner, s.outer, spread, s.inner_c);
    s.inwards = expectation(data, *s.of_outer, s.outer, s.inner, spread, s.outer_c);
    for (const Way* way : {&s.outwards, &s.inwards})
      if (way->tells()) s.told += way->expected / (way->expected + way->unsure);
    if (s.told > best.told) best = std::move(s);
  }
  const RawColumns hats = curve_columns(system, condition, value, best.inner);
  judge(data, *best.of_inner, best.inner_c, hats, best.inner, best.outer, best.outwards);
  judge(data, *best.of_outer, best.outer_c, curve_columns(system, condition, value, best.outer), best.outer, best.inner,
        best.inwards);
  x.split = best.at;
  x.outwards = std::move(best.outwards);
  x.inwards = std::move(best.inwards);
  sum_up(data.blocks(), x);
  return x;
}

}  // namespace gonio::inference
