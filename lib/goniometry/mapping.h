// Cells of a table in MERL format as coordinates of a linear space, and the logarithm in which BRDFs are nearly linear.
//
// Cells: theta_h = (i + 1/2)^2 / n^2 pi / 2, theta_d and phi_d in the middles of uniform bins (io/merl.h,
// surface/half_angle.h). An isotropic surface without handedness has f(phi_d) = f(pi - phi_d): mirroring at the plane
// of h and the normal takes phi_d to -phi_d, exchanging light and eye adds pi. The two cells are one coordinate here,
// the mean of both where a table is read: half of the memory and time, and every output is reciprocal. Cells whose
// middle lies below the horizon are no coordinates; where interpolation asks for one, the next with smaller theta_d
// stands in, as in surface/merl_table.h.
//
// Mapping of Nielsen, Jensen & Ramamoorthi 2015, "On optimal, minimal BRDF sampling for reflectance acquisition",
// section 4. Reflectances span six decades, and their errors matter relatively where there is light: a logarithm. At
// grazing angles f grows like 1 / (cos cos) while radiance does not: f is weighted by w = max(cos theta_i cos theta_o,
// epsilon). Noise has a floor: epsilon is added. What all materials share is taken out by a reference, the median of
// f over the materials, cell by cell:
//   x = ln (f w + epsilon) - ln (f_ref w + epsilon),    f = (exp(x) (f_ref w + epsilon) - epsilon) / w
//   dx/df = w / (f w + epsilon)
// The reference is the paper's; a principal component analysis that subtracts the mean of x gives the same
// reconstruction with any reference, so that it is only a matter of the numbers' size. epsilon = 0.001 / sr.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geom/vector.h"

namespace gonio::goniometry {

using Bins = std::array<std::size_t, 3>;  // of theta_h, theta_d, phi_d
inline constexpr Bins merl_bins = {90, 90, 180};
inline constexpr double mapping_epsilon = 1e-3;

// ln(f w + epsilon): the mapping before the reference is taken off. Negative f, which noise makes, count as 0.
inline double log_level(double f, double w) {
  return std::log(std::max(f, 0.0) * w + mapping_epsilon);
}
inline double level_slope(double f, double w) {
  return w / (std::max(f, 0.0) * w + mapping_epsilon);
}
inline double of_level(double level, double w) {
  return std::max(0.0, (std::exp(level) - mapping_epsilon) / w);
}
inline double cosine_weight(Vec3 wi, Vec3 wo) {
  return std::max(wi.z * wo.z, mapping_epsilon);
}

class Cells {
 public:
  explicit Cells(const Bins& bins);  // 2 to 4096 of each

  const Bins& bins() const { return bins_; }
  std::size_t count() const { return weight_.size(); }  // of coordinates
  double weight(std::size_t cell) const { return static_cast<double>(weight_[cell]); }
  // Directions at the middle; phi_d in [0, pi / 2].
  struct Pair {
    Vec3 wo, wi;
  };
  Pair directions(std::size_t cell) const;
  // Coordinates with first <= theta_h bin < last are ring_begin(first) to ring_begin(last).
  std::size_t ring_begin(std::size_t ring) const { return ring_begin_[ring]; }
  // Of a place in a table, [(h * bins[1] + d) * bins[2] + p]; none where it lies below the horizon.
  static constexpr std::uint32_t none = 0xffffffff;
  std::uint32_t cell_of(std::size_t h, std::size_t d, std::size_t p) const;

  // Linear in sqrt(theta_h), theta_d and phi_d, as tables are interpolated; weights sum to one.
  struct Blend {
    std::array<std::uint32_t, 8> cell{};
    std::array<double, 8> share{};
  };
  Blend blend(Vec3 wo, Vec3 wi) const;  // both above the horizon

 private:
  std::size_t folded() const { return (bins_[2] + 1) / 2; }
  std::uint32_t nearest(std::size_t h, std::size_t d, std::size_t p) const;

  Bins bins_;
  std::vector<std::uint32_t> index_, place_;  // of folded places; of cells: their folded place
  std::vector<std::size_t> ring_begin_;
  std::vector<float> weight_;
};

}  // namespace gonio::goniometry
