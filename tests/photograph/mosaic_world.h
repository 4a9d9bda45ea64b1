// Samples of a sensor behind filters, all of variance 1 and trusted until a test says otherwise.
#pragma once
#include <cstdint>
#include <vector>

#include "photograph/demosaic.h"

namespace gonio::photograph::tests {

struct Samples {
  int width, height;
  std::vector<float> value, variance;
  std::vector<std::uint8_t> trusted;
  Samples(int w, int h)
      : width(w),
        height(h),
        value(static_cast<std::size_t>(w * h)),
        variance(value.size(), 1),
        trusted(value.size(), 1) {}
  Demosaiced demosaiced(const Mosaic& mosaic, Demosaicing how) const {
    return demosaic({width, height, value, variance, trusted}, mosaic, how);
  }
};

}  // namespace gonio::photograph::tests
