// "surface_fits": surfaces told from measured reflectances.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manifest/parameter.h"
#include "manifest/value.h"

namespace gonio::manifest {

// "surface_fits": how the surface of the same name was told from measured reflectances.
struct AlternativeFit {
  std::string model;
  std::optional<std::int64_t> parameters;
  std::optional<double> rms, held_out_rms;  // on the scale log(1 + 100 f cos theta_i cos theta_o)
  std::string reason;                       // why it was not chosen
};
struct DroppedRows {
  std::string reason, first;  // where the first of them stands
  std::int64_t rows = 0;
};
struct SurfaceFit {
  std::string model, verdict, sentence;
  std::map<std::string, std::vector<double>> parameters;  // one number, or one per band
  Sigmas sigma;
  Value covariance;                        // {"order": [...], "values": [[...]]} or null
  std::vector<std::string> bands;          // of the measurement
  std::vector<double> wavelengths_m;       // of the bands, where known
  std::vector<std::string> written_bands;  // that surfaces/NAME takes for red, green and blue
  std::optional<std::int64_t> rows;
  std::vector<DroppedRows> dropped;
  std::optional<double> rms, held_out_rms, rms_decades;  // rms as above; of log10 f
  std::optional<double> energy, reciprocity;             // largest reflectance; largest |f(i, o) / f(o, i) - 1|
  std::optional<bool> converged;
  std::vector<AlternativeFit> alternatives;
  std::vector<std::string> refusals, notes;
  std::string mirror;                  // the convention found: "phi_i + pi" | "phi_i"
  std::optional<double> mirror_ratio;  // brightness at phi_i + pi over brightness at phi_i
  std::string source, basis;           // what was measured; what a reconstruction rests on
  std::map<std::string, std::string> files;
};

}  // namespace gonio::manifest
