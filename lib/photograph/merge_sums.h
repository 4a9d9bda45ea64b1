// What one exposure's samples add to the sums of exposure_merge.h, for a run of pixels: elementwise and without
// branches, which is what compilers make vectors of.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "photograph/noise_variance.h"
#include "photograph/sample_kinds.h"

namespace gonio::photograph {

// A run of pixels as one exposure saw them.
struct ExposureRun {
  std::span<const float> codes;
  std::span<const SampleKind> kinds;  // as many
  std::size_t begin = 0;              // the place of its first pixel in the sums
  float exposure_s = 0;
  std::uint8_t place = 0;  // of the exposure, in the order of durations
};

// All light over all time, of samples that were read: where a scoring begins.
struct LightSums {
  std::vector<float> light, time_s, bound;  // bound: the least rate that saturates a sample which is full
  std::vector<std::uint8_t> first, last;    // places of exposures that were read; meaningless where time is 0
  explicit LightSums(std::size_t pixels);
  void add(const ExposureRun& run, float full_scale);
};

// d log likelihood / d rate, and its information, of samples that are far (8 sigma) from full scale at these rates: a
// sample that is full, of such light, says nothing. `near`: those which are not so far, for the caller to add; not of
// samples that are unusable.
struct ScoreSums {
  std::vector<float> score, information;
  std::vector<std::uint8_t> near;  // of the last run
  explicit ScoreSums(std::size_t pixels);
  // `rates`: of all pixels of the sums. Whether any of the run is near.
  bool add(const ExposureRun& run, std::span<const float> rates, const NoiseVariance& variance_of, float full_scale);
};
inline constexpr double far_from_full = 8;  // standard deviations: of such light all is full, or nothing

// Adds chi-square of what was read about its rate, and how many readings that is, of samples clear of full scale.
// `rates` and the sums are of the same pixels.
void add_squares(const ExposureRun& run, std::span<const float> rates, const NoiseVariance& variance_of,
                 float full_scale, std::span<float> chi_square, std::span<std::uint8_t> readings);
inline constexpr double clear_of_full = 4;  // standard deviations: nearer to full scale what was read is a selection

}  // namespace gonio::photograph
