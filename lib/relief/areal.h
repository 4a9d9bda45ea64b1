// Areal roughness of height maps after ISO 25178-2: what the heights of a scale-limited surface are, with
// uncertainties.
//
// z: heights above the mean of the points that were measured. With < > the mean over those points:
//   Sa = <|z|>   Sq = <z^2>^(1/2)   Ssk = <z^3> / Sq^3   Sku = <z^4> / Sq^4   Sp = max z   Sv = -min z   Sz = Sp + Sv
//   Sdq = <|grad z|^2>^(1/2), the gradient in the middle of each cell of four measured points
//   Sdr = <area of the cell / its projection> - 1, the mean of the cell's two triangulations
// Levelling is a least-squares plane or polynomial of second order, taken off before filtering. Filters are Gaussian,
// ISO 16610-61: a nesting index L passes half of a wave of the length L,
//   s(r) = exp(-pi r^2 / (a L)^2) / (a L)^2,  a = sqrt(ln 2 / pi);
// weights end at the map's edge and at missing points and are normalised there. The S-filter smooths; the L-filter
// takes what it would smooth away from the map.
//
// Uncertainty: heights nearby are alike, and a map has as many independent areas as the spread of means over tiles
// says. Each figure is a mean of an influence p over the points (that of Sq is (z^2 - Sq^2) / 2 Sq), whose variance is
// estimated by blocking (Flyvbjerg & Petersen 1989, in two dimensions): the map is cut into G x G tiles, and products
// of p's deviations over each tile with those over itself and its eight neighbours add up to the variance. Of
// G = 6 ... 32 the largest estimate counts. independent_areas = var(p) / var(mean p) of Sq. Structure as long as the
// map does not show in it: where the estimate still rises from G = 12 to 6, `long_waves` is set. Sp, Sv and Sz are
// extremes of this map and have no sigma: a larger map has larger ones.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "io/height_map.h"

namespace gonio::relief {

enum class Levelling { none, plane, quadratic };
const std::vector<std::string>& levelling_names();  // in the enum's order
struct Treatment {
  Levelling levelling = Levelling::plane;
  double s_filter_m = 0, l_filter_m = 0;  // nesting indices; 0: none
};
struct Treated {
  io::HeightMap map;  // mean 0
  std::size_t missing = 0;
  double tilt_x = 0, tilt_y = 0;  // slopes of the plane that was taken off, y up the picture
};
// Error(data) at `place` where less than half of the points were measured.
Treated treated(const io::HeightMap& map, const Treatment& treatment, const std::string& place);

struct Figure {
  std::string name, unit, meaning;  // "Sa", "m"
  double value = 0;
  std::optional<double> sigma;
};
struct Roughness {
  std::vector<Figure> figures;  // Sa Sq Sz Sp Sv Ssk Sku Sdq Sdr
  double independent_areas = 0;
  bool long_waves = false;
  const Figure& operator[](const std::string& name) const;
};
Roughness roughness(const io::HeightMap& treated);

// Variance of the mean of a field with gaps (NaN), and of several fields' means together; by blocking as above.
struct MeanVariance {
  std::vector<double> covariance;  // fields x fields
  double independent = 0;          // of the first field
  bool rising = false;
};
MeanVariance variance_of_means(const std::vector<std::vector<double>>& fields, std::size_t width, std::size_t height);

}  // namespace gonio::relief
