// The response of a camera that is not linear, from several exposures of one view: Debevec & Malik 1997 (Recovering
// high dynamic range radiance maps from photographs) as the likeliest curve.
//   Z_pj = g^-1(ln E_p + ln t_j + d_j) + noise
// Z: code, 0 to 255; g: log exposure over code, of each channel its own; E_p: light of patch p; t_j: stated exposure
// time; d_j: how far the shutter was off. g is the integral of exp(q), q a cubic B-spline (response_curve.h): it rises
// by construction. What is compared are codes, at the place that all exposures of a patch say together, so that noise
// bends nothing; the weight of a code is 1 / (its variance g'^2), where its variance is what codes of that height
// scatter by. Codes near an end of the scale, by what the other exposures say of them, have none.
//
// Exposures alone know neither a scale nor an exponent: with g also a g fits, with lights E^a and times t^a. The stated
// times decide: d_j have a prior about 0, whose width comes from what the exposures contradict (J - 2 numbers) and from
// `shutter_sigma`; what is left of it is in the uncertainty of g. Scale: linear value 0.2140 at code 127.5, as srgb has
// it, in each channel.
#pragma once
#include <string>
#include <vector>

namespace gonio::photograph {

// One place of a picture: its codes in some of the exposures.
struct ResponsePatch {
  struct Reading {
    std::size_t time;  // place in `times_s`
    double code;       // 0 to 255
  };
  std::vector<Reading> readings;
};
struct ResponseData {
  std::vector<double> times_s;  // those that differ
  std::vector<std::string> channels;
  std::vector<std::vector<ResponsePatch>> patches;  // of each channel
};

struct ResponseRow {
  double code = 0, linear = 0, sigma = 0;  // code over full scale; one standard deviation of `linear`
};
struct ResponseCurve {
  std::string channel;
  std::vector<ResponseRow> rows;         // from code 0 to 1; beyond what was seen they are guesses
  double lowest = 0, highest = 0;        // codes over full scale that were seen
  double noise = 0;                      // codes of 255, typical standard deviation of a reading
  std::size_t patches = 0, dropped = 0;  // dropped: contradict themselves
};
struct FoundResponse {
  std::vector<ResponseCurve> curves;
  std::vector<double> times_s, times_sigma;  // as the exposures and the stated times say together
  double exponent_sigma = 0;                 // of g, by the stated times' uncertainty
  double chi_square_per_freedom = 0;
};

// `shutter_sigma`: relative, what is expected of the stated times; 0: they are exact. Error(data) for fewer than two
// times, and for a channel with fewer than 50 patches that two exposures or more tell.
FoundResponse find_response(const ResponseData& data, double shutter_sigma);

}  // namespace gonio::photograph
