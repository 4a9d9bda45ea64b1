// A sensor whose codes are not proportional to the light: a table from codes above black to linear codes.
//
// CSV with the columns code and linear, and perhaps sigma (one standard deviation of linear), of rising codes and
// rising linear codes. Between rows it is linear, beyond its ends its outer slopes go on; a code beyond its last row is
// taken for saturated. Scale is free: linear codes are codes where the table crosses the diagonal.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "photograph/noise_variance.h"

namespace gonio::photograph {

struct LinearityRow {
  double code = 0, linear = 0, sigma = 0;
};

class Linearity {
 public:
  // Error(data) at `place`, with the row, for fewer than two rows, codes or linear codes that do not rise, and a table
  // that begins above code 0.
  Linearity(std::vector<LinearityRow> rows, const std::string& place);
  const std::vector<LinearityRow>& rows() const { return rows_; }
  const std::string& place() const { return place_; }
  double last_code() const { return rows_.back().code; }

  double operator()(double code) const;
  double slope(double code) const;      // of the piece that the code lies in; at a row the mean of its two
  double code_of(double linear) const;  // the inverse
  // Noise of codes as they are read, of linear codes: slope^2 (code / gain + read^2). Up to `full` linear codes.
  NoiseModel noise(const manifest::Noise& of_codes, double full) const;

 private:
  std::size_t piece(double code) const;
  std::vector<LinearityRow> rows_;
  std::string place_;
};

Linearity read_linearity(const std::filesystem::path& path);
std::string linearity_csv(const std::vector<LinearityRow>& rows);

}  // namespace gonio::photograph
