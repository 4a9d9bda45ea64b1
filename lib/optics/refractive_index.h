// Complex refractive indices n + i k from files of the refractiveindex.info database (Polyanskiy 2024, Scientific Data
// 11:94): the entries below `DATA:` of its YAML, each either one of nine dispersion formulas or a table.
//
//   1  Sellmeier    n^2 - 1 = C1 + sum C(2i) w^2 / (w^2 - C(2i+1)^2)
//   2  Sellmeier-2  n^2 - 1 = C1 + sum C(2i) w^2 / (w^2 - C(2i+1))
//   3  polynomial   n^2 = C1 + sum C(2i) w^C(2i+1)
//   4  database's   n^2 = C1 + C2 w^C3 / (w^2 - C4^C5) + C6 w^C7 / (w^2 - C8^C9) + sum from C10 on as in 3
//   5  Cauchy       n = C1 + sum C(2i) w^C(2i+1)
//   6  gases        n - 1 = C1 + sum C(2i) / (C(2i+1) - w^-2)
//   7  Herzberger   n = C1 + C2 / (w^2 - 0.028) + C3 / (w^2 - 0.028)^2 + C4 w^2 + C5 w^4 + C6 w^6
//   8  retro        (n^2 - 1) / (n^2 + 2) = C1 + C2 w^2 / (w^2 - C3) + C4 w^2
//   9  exotic       n^2 = C1 + C2 / (w^2 - C3) + C4 (w - C5) / ((w - C5)^2 + C6)
// with the wavelength w in micrometres, as in the files; all functions here take metres. Tables are linear in between.
// Where several entries state the same part, the first one that covers a wavelength counts.
#pragma once
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "optics/spectrum.h"

namespace gonio::optics {

struct DispersionFormula {
  int number = 1;                    // 1 ... 9
  std::vector<double> coefficients;  // C1, C2, ...
  double first_m = 0, last_m = 0;
  bool covers(double wavelength_m) const { return wavelength_m >= first_m && wavelength_m <= last_m; }
  // The index; NaN where the formula has a pole or n^2 < 0.
  double at(double wavelength_m) const;
};

class RefractiveIndex {
 public:
  // Error(data) outside of what the file states, and for k where it states none.
  double n(double wavelength_m) const;
  double k(double wavelength_m) const;
  bool states_n() const { return !n_.empty(); }
  bool states_k() const { return !k_.empty(); }
  bool covers_n(double wavelength_m) const;
  bool covers_k(double wavelength_m) const;
  Range range_n() const;  // from the first to the last wavelength that is stated; of a file that states_n()
  Range range_k() const;
  const std::string& place() const { return place_; }

 private:
  friend RefractiveIndex parse_refractive_index(const std::string& text, const std::string& place);
  std::vector<std::variant<DispersionFormula, Spectrum>> n_;
  std::vector<Spectrum> k_;
  std::string place_;
};

RefractiveIndex read_refractive_index(const std::filesystem::path& path);  // Error(no_input | data)
RefractiveIndex parse_refractive_index(const std::string& text, const std::string& place);

}  // namespace gonio::optics
