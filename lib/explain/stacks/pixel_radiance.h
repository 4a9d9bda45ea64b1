// What a linear sensor would have read in a second at single pixels of a stack of exposures.
#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "explain/stacks/stack_sites.h"

namespace gonio::explain::stacks {

struct PixelRadiance {
  double value = std::numeric_limits<double>::quiet_NaN(), variance = 0;  // NaN: no picture shows it
  bool known() const { return !std::isnan(value); }
};

// Weighted least squares over the pictures in which a pixel counts and reads less than `clear` of full scale. Weights
// are those of what all these pictures together expect: by their own noise, low readings would weigh more than high
// ones. The stack and its noise outlive it.
class PixelRadiances {
 public:
  PixelRadiances(const Stack& stack, const ReadingNoise& noise, double clear);
  const PixelRadiance& at(int x, int y, int channel);                         // each looked for once
  PixelRadiance without(std::size_t image, int x, int y, int channel) const;  // in all other pictures

 private:
  PixelRadiance over_all_but(std::size_t left_out, std::size_t i, int channel) const;
  bool tells(std::size_t image, std::size_t i) const;

  const Stack& stack_;
  const ReadingNoise& noise_;
  double clear_;
  std::vector<PixelRadiance> found_;
  std::vector<std::uint8_t> looked_;
};

// Over all readings that count, linear: what an effect is a share of.
double sum_of_squared_readings(const Stack& stack);

}  // namespace gonio::explain::stacks
