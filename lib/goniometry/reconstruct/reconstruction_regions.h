// How much wider intervals have to be, region by region of half and difference angle.
//
// Lobes, what lies beside them and grazing light are foretold differently well: one factor for all cells would be too
// small near the mirror direction and too large far from it. The factor s is kept at the middles of 4 x 3 regions of
// sqrt(theta_h / (pi / 2)) and theta_d / (pi / 2), and its logarithm is linear between them.
//
// From errors of materials that were left out, in units of their standard deviations: where every material is a class
// of its own, s is the 95 % quantile of their magnitude over all of them, over 1.96. Of few classes C, each with its
// own quantile tau_c, one that was not seen is no sample: no finite s holds for it whatever the classes are, unless C
// >= 19 (Lee, Barber & Willett 2023, "Distribution-free inference with hierarchical data"). ln tau is taken as normal
// between classes; that of the next class is then their mean plus their standard deviation times sqrt(1 + 1 / C) t, t
// of C - 1 degrees of freedom, and s solves
//   E[2 Phi(z s / tau) - 1] = 0.95,   z = 1.96
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace gonio::goniometry {

struct Widening {
  static constexpr std::size_t halves = 4, differences = 3, regions = halves * differences;
  std::array<double, regions> s = filled(1);  // half by half
  // u = sqrt(theta_h / (pi / 2)), v = theta_d / (pi / 2).
  double at(double u, double v) const;
  double typical() const;  // geometric mean

  static std::size_t region_of(double u, double v);
  static constexpr std::array<double, regions> filled(double value) {
    std::array<double, regions> all{};
    for (double& s : all) s = value;
    return all;
  }
};

// s of a class that was not seen, from tau of three classes or more, all above 0.
double widening_of_next_class(std::span<const double> tau);

}  // namespace gonio::goniometry
