// Noise of a table that states none. Its variance at a value m is
//   var(m) = read^2 + shot |m| + share^2 m^2,   all three >= 0,
// (Janesick 2007, equation 3.5: read noise, photon noise, fixed pattern) fitted to squared differences of observations
// that should be equal:
//   repeats: rows with equal conditions, or further takes: var = (a - b)^2 / 2;
//   else neighbours: rows are ordered so that one condition at a time changes from one to the next, and second
//   differences of y - f are taken, (r_i-1 - 2 r_i + r_i+1)^2 / 6 (Gasser, Sroka & Jennen-Steinmetz, Biometrika 73,
//   1986). The ordering with the smallest differences counts: structure makes them larger, never smaller.
// Medians within bins of m make single outliers harmless.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "explain/tables/table_model.h"

namespace gonio::explain::tables {

struct NoiseModel {
  double read2 = 0, shot = 0, share2 = 0;
  std::string how;  // for the report: "from 40 repeated rows"
  bool from_neighbours = false;
  double sigma(double value) const;
};

// `observed`, and `prediction` of the fitted base model: one per observation. `repeats`: read_repeats(). `conditions`:
// columns that may carry structure.
NoiseModel table_noise(const Table& table, std::span<const double> observed, std::span<const double> prediction,
                       const std::vector<std::vector<double>>& repeats, const std::vector<std::size_t>& conditions);

// Standard deviation of whitened residuals as their neighbours show it; 1 where the noise is what was believed.
double neighbour_scatter(const Table& table, std::span<const double> whitened,
                         const std::vector<std::size_t>& conditions);

// For tests: the model that fits pairs (value, variance estimate from one degree of freedom) best.
NoiseModel fit_noise(std::vector<std::pair<double, double>> pairs);

}  // namespace gonio::explain::tables
