// Reflectance tables as directions and bands, the conditions that carry structure in them, and their noise.
//
// Directions in the sample's frame: z the normal, theta from it, phi about it from x; the mirror direction of (theta_i,
// phi_i) is (theta_i, phi_i + pi). f spans decades, so that rows are compared on the scale
//   z = log(1 + 100 f cos theta_i cos theta_o)
// (Loew et al. 2012, "BRDF models for accurate and efficient rendering of glossy surfaces", section 5, with the weight
// that the comparison of measured paints uses): relative where there is light, absolute where there is none.
#pragma once
#include <string>
#include <vector>

#include "explain/tables/table_model.h"
#include "geom/vector.h"

namespace gonio::explain::tables {

struct ReflectanceRows {
  std::vector<Vec3> wi, wo;            // one per row
  std::vector<double> weight;          // 100 cos cos; 0 at and below the horizon
  std::vector<double> excitation;      // one per row, or empty
  std::vector<std::size_t> band;       // of row r and observed column k: band[r * observed + k]
  std::size_t observed = 1;            // columns
  std::vector<std::string> band_name;  // "r", "550 nm"; one band: ""
  std::vector<double> band_m;          // wavelengths; empty where the table has none
  std::vector<std::vector<std::size_t>> rows_of_band;
  std::size_t rows() const { return wi.size(); }
  // Which component of an RGB number stands for a band.
  int component(std::size_t b) const;
};
ReflectanceRows reflectance_rows(const Table& table);

// Half angle, difference angle, incidence, exitance, phase angle (0 at backscatter), azimuth of the half vector,
// wavelength and excitation where they vary. Of every row.
std::vector<Condition> reflectance_conditions(const ReflectanceRows& rows);

// One standard deviation on the scale z, found from what no smooth surface does: each row against a plane through its
// neighbours of the same band and incidence (the median over rows), and rows against the ones with the two directions
// exchanged, whichever is larger; 0.001 at least. `f`: one per observation.
double reflectance_noise(const ReflectanceRows& rows, const std::vector<double>& f);

inline double scaled_reflectance(double f, double weight) {
  const double x = weight * f;
  return x > -0.5 ? std::log1p(x) : std::log(0.5) + 2 * (x + 0.5);  // noise below zero stays monotone
}

}  // namespace gonio::explain::tables
