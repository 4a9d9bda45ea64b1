// A volume read in slabs of slices that overlap, so that neighbourhoods are whole while memory stays bounded: what
// every step over a whole volume is made of. Values as floats; what lies outside the volume is `outside`.
#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "io/volume.h"

namespace gonio::volume {

// Slices first - margin .. first + count - 1 + margin; those beyond the volume's ends are filled with `outside`.
struct Slab {
  std::size_t width = 0, height = 0, first = 0, count = 0, margin = 0;
  std::vector<float> values;  // (count + 2 margin) * width * height
  // k counts from the volume's first slice; first - margin <= k < first + count + margin.
  const float* slice(std::ptrdiff_t k) const {
    return values.data() +
           static_cast<std::size_t>(k - static_cast<std::ptrdiff_t>(first) + static_cast<std::ptrdiff_t>(margin)) *
               width * height;
  }
};

struct SlabWish {
  std::size_t count = 32, margin = 1;
  float outside = 0;
};
// Calls `body` for slabs from the first to the last slice; every slice is read once.
void for_each_slab(io::VolumeSource& source, const SlabWish& wish, const std::function<void(const Slab&)>& body);

}  // namespace gonio::volume
