// Cells that behave unlike their class over the views.
//
// Of cell i and view v, z_iv is the relative deviation from the class's polynomial over the class's
// scatter in that view. R is
// the correlation between views within the class, of z clipped at 3 so that defects do not make themselves normal, and
// shrunk towards no correlation by the weight that Schaefer & Strimmer 2005 derive (equation 8), so that there may be
// more views than cells. With its eigenvectors e_k and eigenvalues l_k, over all views a cell has the distance
//     d_i^2 = sum over k of (e_k . z_i)^2 / max(l_k, 1) / views:
// what sound cells do together in many views is taken at its own size. Directions in which they hardly vary are not
// enlarged: there what is small and not normal, such as the square of a cell's tilt, would outweigh everything.
//
// What sound cells do is simulated: normal z with the correlation R go through the same steps (the same robust
// polynomial in every view, its scatter, clipped, R estimated anew), `draws` times. The fit has to be the same one, and
// not its least-squares kin: among n cells and p terms least squares takes the share p / n out of each cell's own
// deviation, and more at the rim, while the biweight lets a far cell stand as far away as it is; a null by least
// squares gave false alarms in 16 % of samples where 5 % were asked for, and this one does not. Normal z suffice: cells
// whose roughness and azimuth scatter by 0.02 have brightnesses with skewnesses below 0.21 and excess kurtoses below
// 0.1 in all views of that study. Were the bulk of the cells wider than the draws (the median or the 85 % quantile of
// d^2 tells: scatters that differ over the sample, tails that are not normal), the null is widened alike, never
// narrowed. A cell's p is the share of simulated samples whose largest d^2 reaches its own, over both classes together
// (Sidak): the chance that a sample without defects has any such cell.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "contrast/measure/pattern.h"

namespace gonio::contrast {

struct CellDefect {
  std::size_t cell = 0;
  double distance = 0, p = 1;
  std::size_t view = 0;  // where it deviates most, and by how many scatters
  double deviation = 0;
  int brighter = 0, darker = 0;  // views in which it is so by more than 3
};
struct Defects {
  std::vector<double> distance, p;  // per cell; NaN where it was seen in less than half of the views
  std::vector<CellDefect> found;    // p <= alarm rate, most deviating first
  double limit = 0;                 // distance from which a cell is found: the larger of the two classes'
  double alarm_rate = 0.05;
  int draws = 0;
  std::vector<double> widening{1, 1};  // of the null, by class
};

// `deviation[v][cell]`: z of a cell in a view; NaN where it does not count.
Defects find_defects(const CellPattern& pattern, const std::vector<std::vector<double>>& deviation, double alarm_rate,
                     std::uint64_t seed);

}  // namespace gonio::contrast
