// One picture of radiance from several exposures of a view, sample by sample of the sensor, before any resampling.
//
// Exposure k of a pixel, black taken off, lasts t_k and reads x_k = L t_k + noise, in codes, of variance
//   V(x) = x / gain + read^2               EMVA 1288: shot noise, `gain` electrons per code; read noise in codes
// L, in codes per second, makes likeliest what was read and what could not be:
//   l(L) = - sum_(x_k < F) (x_k - L t_k)^2 / (2 V(L t_k))  +  sum_(x_k >= F) log Phi((L t_k - F) / sqrt V(L t_k))
// with F the full scale (Tobin 1958). Numbers of saturated samples have no weight at all; that they were saturated has:
// without the second sum, pixels of which an exposure stayed below F by its noise alone would come out too dark. The
// weights 1 / V are those of the merged L, not of each reading, which would pull dark pixels down. One standard
// deviation of L is the inverse root of the information,
//   I(L) = sum t_k^2 / V (Phi(-a) + a phi(a) + phi(a)^2 / Phi(a)),  a = (L t_k - F) / sqrt V,
// where a sample far below F has a = -infinity and counts t^2 / V. Four passes over the exposures (start, two steps
// of scoring, and what is left); what is kept is a few planes, however many exposures there are.
//
// A pixel of which two exposures contradict each other by more than noise, together with its neighbours of the same
// colour, shows something that moved: its value is that of one exposure alone, and it is marked.
// It does not take off black, dark current or shading: photograph/raw_correction.h does.
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "photograph/noise_variance.h"
#include "photograph/sample_kinds.h"

namespace gonio::photograph {

struct MergeRequest {
  int width = 0, height = 0;
  std::vector<double> exposures_s;
  std::function<RawPlane(std::size_t exposure)> read;  // called some times for each
  // The same of some rows alone, for frames that lie in memory: the picture is then made strip by strip, by several
  // threads. Left out: from whole frames, one at a time. What comes out is the same.
  std::function<void(std::size_t exposure, int first_row, int rows, RawPlane& into)> read_rows{};
  NoiseModel noise;
  double full_scale = 0;                                    // codes beyond black: from here on a sample is saturated
  double floor = -std::numeric_limits<double>::infinity();  // the lowest code, black taken off
  int blooming_px = 1;                                      // samples so near to a saturated one are not used
  int period_px = 2;  // to the next sample of the same colour: 1 without a mosaic, 2 Bayer, 4 of polarization
  bool refine_exposures = true;
};

enum class Trust : std::uint8_t { good, too_bright, no_sample, moved };

struct MergedPlane {
  std::vector<float> rate, variance;  // L and its variance, per exposure_s of the request (of its second as stated)
  std::vector<Trust> trust;
  std::vector<std::uint8_t> first, last;  // shortest and longest exposure that was read: places in the stated order
  std::vector<double> exposures_s, exposures_sigma;  // as refined (exposure_times.h)
  double chi_square_per_freedom = 0;                 // of the readings about L, over pixels that can be trusted
};

// Places of exposures in the order of their durations, which `first` and `last` count by.
std::vector<std::size_t> by_duration(const std::vector<double>& exposures_s);

// Error(data) for fewer than one exposure, planes of another size, or a noise or full scale that is not positive.
MergedPlane merge_exposures(const MergeRequest& request);

}  // namespace gonio::photograph
