#include "base/unit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace gonio {
namespace {

constexpr std::array<std::string_view, 7> numbers = {"1", "rad", "sr", "deg", "mrad", "%", ""};
constexpr std::array<std::string_view, 21> known = {"m",  "mm", "um", "nm", "cm", "s",  "ms", "us", "min", "h", "K",
                                                    "kg", "W",  "J",  "Hz", "px", "DN", "A",  "V",  "N",   "C"};
constexpr double least_exponent = 1e-9;

bool is_one_of(std::string_view word, const auto& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool joins(char c) {
  return c == ' ' || c == '*' || c == '/' || c == '(' || c == ')';
}

// "half board": words without operators, of which none is a unit, name a ratio.
bool names_a_ratio(std::string_view text) {
  if (text.find(' ') == std::string_view::npos || text.find_first_of("/*^()") != std::string_view::npos) return false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    if (is_one_of(text.substr(at, end - at), known)) return false;
    at = end + 1;
  }
  return true;
}

}  // namespace

Unit::Unit(std::string_view text) {
  if (names_a_ratio(text)) return;
  double sign = 1;      // of the factor to come
  bool inside = false;  // of "( )": the sign stands
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (joins(c)) {
      if (c == '/') sign = -1;
      if (c == '(') inside = true;
      if (c == ')') inside = false, sign = 1;
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < text.size() && !joins(text[end])) ++end;
    const std::string token(text.substr(at, end - at));
    const std::size_t caret = token.find('^');
    const double exponent = caret == std::string::npos ? 1 : std::strtod(token.c_str() + caret + 1, nullptr);
    multiply(token.substr(0, caret), sign * exponent);
    if (!inside) sign = 1;
    at = end;
  }
}

void Unit::multiply(const std::string& symbol, double exponent) {
  if (is_one_of(symbol, numbers)) return;
  const auto found =
      std::find_if(factors_.begin(), factors_.end(), [&](const auto& factor) { return factor.first == symbol; });
  if (found == factors_.end()) {
    if (std::abs(exponent) > least_exponent) factors_.emplace_back(symbol, exponent);
    return;
  }
  found->second += exponent;
  if (std::abs(found->second) <= least_exponent) factors_.erase(found);
}

Unit Unit::power(double exponent) const {
  Unit result;
  for (const auto& [symbol, own] : factors_) result.multiply(symbol, own * exponent);
  return result;
}

Unit operator*(const Unit& a, const Unit& b) {
  Unit result = a;
  for (const auto& [symbol, exponent] : b.factors_) result.multiply(symbol, exponent);
  return result;
}

bool Unit::operator==(const Unit& other) const {
  return (*this / other).factors_.empty();
}

std::string Unit::text() const {
  std::string result;
  for (const auto& [symbol, exponent] : factors_) {
    char power[32] = "";
    if (std::abs(exponent - 1) > least_exponent) std::snprintf(power, sizeof power, "^%.4g", exponent);
    result += (result.empty() ? "" : " ") + symbol + power;
  }
  return result.empty() ? "1" : result;
}

}  // namespace gonio
