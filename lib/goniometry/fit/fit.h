// Analytic fits: which registered surface, with which numbers, how sure, and what the samples cannot say.
//
// Numbers of a model are shared by all bands (roughness, direction) or one per band (colours). All bands of all rows
// are fitted at once by bounded Levenberg-Marquardt with the models' own slopes (Marquardt 1963), from several starts
// (goniometry/fit/start.h). What is minimised is the sum of squares of one of
//   noise     (f - m) / sqrt(sigma^2 + e^2 (m + 1 / w)^2)    where samples state sigma; e, the error of the best model
//                                                        on the scale log(1 + w f), w = 100 ci co, is what makes the
//                                                        mean square one, 0 where it is so without
//   log1p     log(1 + 100 f ci co) - log(1 + 100 m ci co)    relative where there is light, absolute elsewhere
//   log10     log10(f / m)                                    decades, over samples above zero
// Covariance: H^-1 of the noise scale, or, where blocks of neighbouring samples disagree by more than that, the
// sandwich over blocks (Liang & Zeger 1986; Bell & McCaffrey 2002): goniometry/fit/uncertainty.h. Held-out error: every
// block or series is predicted by a fit without it. Chosen is the simplest fit whose held-out error is within one
// standard error of the least, or exceeds it by nothing material: goniometry/fit/fit_choice.h.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "goniometry/samples.h"
#include "surface/surface.h"

namespace gonio::goniometry {

enum class Scale { automatic, noise, log1p, log10 };  // automatic: noise where sigma is stated, else log1p

struct FitOptions {
  std::vector<std::string> models;  // ids; empty: every registered surface that reflects by itself
  int lobes = 2;                    // most of one fit; light sent back to the lamp counts as one
  std::optional<bool> anisotropic;  // nothing: tried where half vectors turn about the normal
  Scale scale = Scale::automatic;
  int random_starts = 4;  // beside those that the samples suggest
  std::uint64_t seed = 1;
  int folds = 5;                  // 0: no held-out error; the fitted one ranks
  std::size_t most_rows = 20000;  // beyond, rows are thinned evenly
  bool check = true;              // energy and reciprocity
};

// One free number of a fit. `band` is that of a colour, and whole_sample of what bands share.
inline constexpr std::size_t whole_sample = static_cast<std::size_t>(-1);
struct FittedNumber {
  std::string name;  // of the model's parameter
  std::size_t band = whole_sample;
  double value = 0;
  double sigma = 0;      // standard uncertainty; NaN at a bound, where it would be one-sided, and where nothing says
  double degrees = 1e6;  // of freedom, for Student's t
  double low = 0, high = 0;  // 95 % interval, cut at the bounds; at a bound from it to where the fit is 3.84 worse
  enum class At { inside, lower, upper } at = At::inside;
};

struct FitError {
  double scaled = 0;   // rms on the scale of the fit
  double log1p = 0;    // rms of log(1 + 100 f ci co)
  double decades = 0;  // rms of log10(f / m) over samples above zero
};

struct Fit {
  const surface::Model* model = nullptr;
  std::string variant;                   // "two lobes, anisotropic"; empty: plain
  std::vector<surface::Values> triples;  // bands 3 t, 3 t + 1, 3 t + 2 as red, green and blue; one band: all alike
  std::vector<FittedNumber> numbers;     // what was free
  std::vector<double> covariance;        // of `numbers`, row by row; zero where something is at a bound
  bool converged = false;
  std::size_t observations = 0;  // numbers of samples that took part
  Scale scale = Scale::log1p;
  double model_error = 0;            // e above
  FitError fitted, held_out;         // held_out: NaN without folds
  std::vector<double> band_log1p;    // rms per band
  double held_out_excess = 0;        // of the mean square over the least one of all candidates
  double held_out_excess_sigma = 0;  // its standard error over folds
  double energy = 0;                 // greatest directional albedo
  double reciprocity = 0;            // greatest |f(wo, wi) - f(wi, wo)| over their mean
  std::string verdict;               // one sentence
  std::string reason;                // why it is not the chosen one
  std::string same_as;               // the fit of fewer numbers that predicts the same, "glossy (two lobes)"
  const FittedNumber* number(const std::string& name, std::size_t band = whole_sample) const;
  double evaluate(Vec3 wo, Vec3 wi, std::size_t band) const;
};

// A model that was not fitted or whose fit is not to be believed.
struct Refusal {
  std::string model, variant, reason;
};

struct Fits {
  std::vector<Fit> candidates;        // by held-out error, least first
  std::size_t chosen = whole_sample;  // of candidates; whole_sample where all were refused
  std::vector<Refusal> refusals;
  double least_alpha = 0;  // roughness below which these directions tell nothing: goniometry/fit/limits.h
  std::string untold;      // of every surface, what these directions cannot tell, and what to measure; empty: nothing
  std::vector<std::string> notes;
};

// Error(data) at samples.name where there is nothing to fit, or a model is not registered.
Fits fit_surfaces(const Samples& samples, const FitOptions& options = {});

}  // namespace gonio::goniometry
