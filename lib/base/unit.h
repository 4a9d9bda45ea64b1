// Units as products of powers of named ones, "W/m^2", "px m^-0.5": enough to give the coefficient of a law the unit
// that makes its term a quantity of the right kind.
//
// Angles, solid angles and ratios count as numbers (rad = sr = % = 1, SI brochure 9, section 2.3.3), and so do ratios
// named in words ("half diagonal"). Nothing is converted: values stay in the units they are in.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gonio {

class Unit {
 public:
  Unit() = default;                      // a number
  explicit Unit(std::string_view text);  // factors joined by blanks or '*', the next one divided after '/', '^' a power
  Unit power(double exponent) const;
  friend Unit operator*(const Unit& a, const Unit& b);
  friend Unit operator/(const Unit& a, const Unit& b) { return a * b.power(-1); }
  bool is_number() const { return factors_.empty(); }
  std::string text() const;  // "px m^-0.5"; "1" for a number
  bool operator==(const Unit& other) const;

 private:
  void multiply(const std::string& symbol, double exponent);
  std::vector<std::pair<std::string, double>> factors_;  // none with the exponent zero
};

}  // namespace gonio
