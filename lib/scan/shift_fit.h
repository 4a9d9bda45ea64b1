// Least squares over the shifts of one cosine (decode.h). For this room.
#pragma once
#include <cmath>
#include <span>

#include "geom/mat3_inverse.h"

namespace gonio::scan {

// A + C cos + S sin fitted to readings at given shifts, three at least that differ: (A, C, S) = this * (sum of
// readings, with cos, with sin).
inline Mat3 shift_fit(std::span<const double> shifts_rad) {
  Mat3 m{{}};
  for (const double s : shifts_rad) {
    const double row[3] = {1, std::cos(s), std::sin(s)};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) m(i, j) += row[i] * row[j];
  }
  return inverse(m);
}

}  // namespace gonio::scan
