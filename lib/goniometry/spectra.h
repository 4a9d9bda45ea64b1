// The numbers of a fit as tables and, where there are many bands, as spectra: 31 albedos are a curve, not 31 rows.
#pragma once
#include <string>
#include <vector>

#include "goniometry/outputs.h"
#include "report/plot.h"

namespace gonio::goniometry {

// Bands beyond the ones that stand for red, green and blue.
bool has_spectra(const Outcome& outcome);
// One for each number that bands have of their own (albedo, f0, ...), over wavelength where the bands have one, else
// over their place, with 95 % intervals; those at a bound are marked.
struct Spectrum {
  std::string number;
  report::Plot plot;
};
std::vector<Spectrum> spectra_of(const Outcome& outcome);
// The error of the fit per band, rms of log(1 + 100 f cos cos).
report::Plot band_error_plot(const Outcome& outcome);
// One row per number of the chosen fit: name, band, wavelength_m (empty where all bands share it), value, one standard
// deviation (empty at a bound), 95 % interval, "lower" or "upper" at a bound.
std::string numbers_csv(const Outcome& outcome);
// What is to be said of numbers at bounds: one sentence each, or one for all bands of a number that are.
std::vector<std::string> bound_notes(const Outcome& outcome, const Fit& fit);

}  // namespace gonio::goniometry
