// The terms that a law may be made of. Private to the law.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "inference/explanation.h"
#include "inference/system.h"

namespace gonio::inference {

using Mask = std::vector<char>;  // one per row; empty: all

struct Term {
  static constexpr std::size_t absolute = static_cast<std::size_t>(-1);
  std::vector<std::pair<std::size_t, double>> powers;  // condition -> power
  std::string shape;                                   // "", "exp", "sin", "cos" of `shape_of` / scale
  std::size_t shape_of = 0;
  double scale = 1;
  bool fitted_scale = false;
  std::size_t along = 0;  // condition whose direction it has, or `absolute`: none
  double price = 0;       // in units of the fall of chi-square that it has to bring beside its coefficient
  bool operator==(const Term&) const = default;
};

// The sine beside a cosine of the same fitted scale: one wave.
bool shares_scale(const Term& cosine, const Term& sine);

// What a condition admits. Azimuths repeat themselves: no powers of them.
struct ConditionKind {
  bool usable = false, crosses_zero = false, periodic = false, angle = false;
  double lower = 0, upper = 0;
};
ConditionKind kind_of(const System& system, std::size_t condition);

// Does an exponential stay within a thousandfold of its coefficient wherever it was seen?
bool is_readable(const System& system, const Term& term);

// Terms over the conditions `leaders`, alone and with one other condition, in an order that depends on nothing else.
// Where a condition's direction makes its curve a relative error, terms of both kinds, relative and absolute.
std::vector<Term> possible_terms(const System& system, const std::vector<std::size_t>& leaders);

// The term with coefficient one on every row, direction included; zero where a condition does not apply and
// outside the mask.
std::vector<double> column_of(const System& system, const Term& term, const Mask& mask = {});

// c cos(x / s) + d sin(x / s), the term `k` and the next: A cos(2 pi x / P - phase).
bool is_wave(const std::vector<LawTerm>& terms, std::size_t k);
// The term as it is told, with its coefficient's unit.
LawTerm told(const System& system, const Term& term, double coefficient, double sigma, double scale_sigma);
std::string in_words(const Problem& problem, const std::vector<LawTerm>& terms);

}  // namespace gonio::inference
