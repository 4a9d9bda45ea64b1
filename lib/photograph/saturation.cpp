#include "photograph/saturation.h"

#include <cmath>
#include <limits>

namespace gonio::photograph {
namespace {

constexpr double float_of_limit = 1e-6;  // relative: several units in the last place of a float

}  // namespace

double half_code(int code_bits) {
  return 0.5 / (std::pow(2.0, code_bits) - 1);
}

double saturated_from(int code_bits, std::optional<double> stated) {
  if (stated) return *stated;
  return code_bits > 0 ? 1 - half_code(code_bits) : std::numeric_limits<double>::infinity();
}

double dark_below(int code_bits) {
  return code_bits > 0 ? half_code(code_bits) : -std::numeric_limits<double>::infinity();
}

bool at_full_scale(double value, double full_scale) {
  return full_scale > 0 && value >= full_scale * (1 - float_of_limit);
}

}  // namespace gonio::photograph
