// The greatest value of a function over a box, for a handful of dimensions: a low-discrepancy set (Roberts 2018: powers
// of the root of x^(d+1) = x + 1), whose best points start simplexes (Nelder & Mead 1965), kept in the box by
// projection. Deterministic.
#pragma once
#include <functional>
#include <vector>

namespace gonio::contrast {

struct Box {
  std::vector<double> lower, upper;
};
struct Found {
  std::vector<double> at;
  double value = 0;
  int evaluations = 0;
};
Found greatest(const Box& box, int points, const std::function<double(const std::vector<double>&)>& function);

}  // namespace gonio::contrast
