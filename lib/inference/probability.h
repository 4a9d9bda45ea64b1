// How sure: the probability that a set of mechanisms is what was left out, beside "nothing that matters" and "something
// outside the library", from a few numbers that a person can read.
//
// A multinomial logistic model (McFadden, Frontiers in Econometrics, 1974): every member of the comparison has a score,
// the sum of weight times term, and P = exp(score) / sum of exp(score). The weights stand in one table (logit_terms()).
// They come from cases whose truth is known (probability.cpp says which, and how): prove-probability estimates them by
// penalised maximum likelihood, and says what the stated probabilities are worth on cases of other seeds.
#pragma once
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace gonio::inference {

// What is known of one member. All are dimensionless; zero where a member has none.
struct Statistics {
  double behind = 0;  // standard errors of the paired difference by which the best rival's unseen groups are better
  double missed = 0;  // share of what can be repaired that it does not repair
  double own = 0;     // what a free curve over a condition of its own still repairs, over that and what it repairs
  double clean = 0;   // of what it leaves above the noise, the share that this curve takes: it is no noise that is left
  double any = 0;     // the same over any condition, fine structure and products of conditions included;
                      // of what is outside: beside the set that repairs most
  double curve = 0;   // by how much more the best curve over one condition repairs than it does, as a share
  double numbers = 0;   // that are fitted with it
  double size = 0;      // mean over its numbers of ln(1 + (distance from neutral / typical size)^2): half-Cauchy
  double controls = 0;  // share of the negative controls that do better
  double weakest = 0;   // standard errors by which unseen groups miss the least of its mechanisms
  double times =
      0;            // ln of its weakest mechanism's effect over the smallest of interest; below zero: none that matters
  double more = 0;  // mechanisms beyond the first
  double finer = 0;  // of them, finer forms of a plainer mechanism
  // Of "nothing" alone: -log10 of the chance of such residuals without a mismatch, and ln of the largest effect that
  // anything fitted has over the smallest of interest.
  double mismatch = 0, largest = 0;
  // Of "outside" alone: ln of the effect of readings that stand out over the smallest of interest; zero: there are none
  // that matter (outliers.h).
  double outlying = 0;
};
struct Statistic {
  std::string_view name, meaning;
  double Statistics::*value;
};
std::span<const Statistic> statistics();  // as they are written and read

struct Member {
  enum class Kind { nothing, outside, set };
  Kind kind = Kind::set;
  Statistics statistics;
};

// Does the domain's simulator err by itself, beyond noise and beside all that a mechanism could repair (pictures of
// sampled light)? What a set leaves says less then.
enum class Simulator { exact, errs };

struct LogitTerm {
  std::string_view name;
  double (*of)(const Member&);
  double weight, where_it_errs;  // of simulators that are exact, and of those that are not
  int sign;                      // that a sane weight has
};
std::span<const LogitTerm> logit_terms();
std::vector<double> weights_of(Simulator simulator);  // in the order of logit_terms()

// Of every member; they add up to one.
std::vector<double> probabilities(const std::vector<Member>& members, Simulator simulator = Simulator::exact);
// The same with other weights, in the order of logit_terms(): to estimate them.
std::vector<double> probabilities(const std::vector<Member>& members, std::span<const double> weights);

// What falls to "nothing that matters" and to "something outside": a set that is too small to matter is nothing, unless
// readings stand out, which it does not repair; what is outside, where nothing that matters is left, is nothing, too.
struct Rest {
  double nothing = 0, outside = 0;
};
Rest rest_of(const std::vector<Member>& members, const std::vector<double>& probability);

// The answer that the probabilities give. Where all sets together are likelier than not: one set if it is `sure`, else
// the likeliest, at most three, until they are so together. Else what is likeliest of nothing and outside. A set less
// than a hundredth as likely as the first is not listed beside it: what speaks against the first is then no other set.
inline constexpr std::size_t most_listed = 3;
inline constexpr double likelier_than_not = 0.5;
struct Answer {
  enum class Kind { nothing, outside, sets };
  Kind kind = Kind::nothing;
  std::vector<std::size_t> sets;  // places in `members`, the likeliest first; of nothing and outside: none
  double probability = 0;         // of the answer
};
Answer answer(const std::vector<Member>& members, const std::vector<double>& probability, double sure);

}  // namespace gonio::inference
