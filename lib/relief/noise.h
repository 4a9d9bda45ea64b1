// Sparse convolution noise (Lewis 1989, "Algorithms for solid noise synthesis"; Frisvad & Wyvill 2007, "Fast
// high-quality noise") as a closed function of place and seed: no table, and any place can be asked for.
//
// Space is cut into unit cells. Each holds N impulses at uniform places x_j with uniform heights a_j in (-1, 1), from a
// generator that is addressed by (seed, cell), and
//   noise(p) = c sum_j a_j k(|x_j - p|),  k(r) = (1 - 4 r^2)^3 for r < 1/2, else 0,  c = 4 / (5 N^(1/3)), N = 30.
// Impulses are independent, so that (Campbell 1909)
//   mean 0,  <noise(p) noise(p + r)> = c^2 N / 3 C(r),  C(r) = integral of k(|v|) k(|v + r|) dv,
//   C(0) = (pi / 4) B(3/2, 7) = 0.035709,  standard deviation 0.15388.
// (Luongo et al. 2020, appendix A, alternate the signs of uniform numbers in (0, 1): that takes 8 % of the variance
// away and leaves a trace of the grid; and number impulses by a congruential generator of period 65536, by which cells
// recur.)
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "geom/vector.h"
#include "relief/relief.h"

namespace gonio::relief {

inline constexpr int impulses_per_cell = 30;

class SparseNoise {
 public:
  // Periods in cells, 0: none.
  explicit SparseNoise(std::uint64_t seed = 0, std::array<int, 3> period = {0, 0, 0}) : seed_(seed), period_(period) {}
  double operator()(Vec3 p) const;

  struct Impulse {
    Vec3 place;
    double height;
  };
  void impulses_of(int x, int y, int z, std::vector<Impulse>& list) const;  // of a cell, appended

 private:
  std::uint64_t seed_;
  std::array<int, 3> period_;
};

double noise_sigma();                    // of noise(p)
double noise_correlation(double cells);  // C(r) / C(0), r in cells; 0 from 1 on

// A sum of such noises: each of the root mean square sq_m, its cells cell_m wide.
struct NoisePart {
  double sq_m = 0, cell_m = 0;
};
struct NoiseField {
  std::vector<NoisePart> parts;
  int nx = 512, ny = 512;
  double step_m = 1e-6;
  std::uint64_t seed = 0;
  bool periodic = false;  // cells are then changed to the nearest that divide the field
};
Relief noise_relief(const NoiseField& field);  // Error(usage) at "noise"

}  // namespace gonio::relief
