// See merge_sums.h.
#include "photograph/merge_sums.h"

#include <algorithm>
#include <limits>

namespace gonio::photograph {
namespace {

// body(variance), where variance(expected) is the noise's: a line is a few instructions, a table is looked up.
template <class Body>
void with_variance(const NoiseVariance& of, const Body& body) {
  if (of.is_line())
    body([least = static_cast<float>(of.least()), slope = static_cast<float>(of.slope())](float expected) {
      return std::max(expected, 0.0f) * slope + least;
    });
  else
    body([&of](float expected) { return static_cast<float>(of(expected)); });
}

}  // namespace

LightSums::LightSums(std::size_t pixels)
    : light(pixels),
      time_s(pixels),
      bound(pixels, std::numeric_limits<float>::infinity()),
      first(pixels, std::numeric_limits<std::uint8_t>::max()),
      last(pixels) {}

void LightSums::add(const ExposureRun& run, float full_scale) {
  const float *codes = run.codes.data(), t = run.exposure_s, full_rate = full_scale / t;
  const SampleKind* kinds = run.kinds.data();
  float *lights = &light[run.begin], *times = &time_s[run.begin], *bounds = &bound[run.begin];
  const std::size_t count = run.codes.size();
  for (std::size_t i = 0; i < count; ++i) {
    const SampleKind kind = kinds[i];
    const float code = codes[i], bound_before = bounds[i];
    lights[i] += kind == SampleKind::read ? code : 0.0f;
    times[i] += kind == SampleKind::read ? t : 0.0f;
    bounds[i] = (kind == SampleKind::full) & (full_rate < bound_before) ? full_rate : bound_before;
  }
  std::uint8_t *firsts = &first[run.begin], *lasts = &last[run.begin], place = run.place;
  for (std::size_t i = 0; i < count; ++i) {
    const bool read = kinds[i] == SampleKind::read;
    const std::uint8_t first_before = firsts[i], last_before = lasts[i];
    firsts[i] = read & (place < first_before) ? place : first_before;
    lasts[i] = read & (place > last_before) ? place : last_before;
  }
}

ScoreSums::ScoreSums(std::size_t pixels) : score(pixels), information(pixels), near(pixels) {}

bool ScoreSums::add(const ExposureRun& run, std::span<const float> rates, const NoiseVariance& variance_of,
                    float full_scale) {
  constexpr auto far = static_cast<float>(far_from_full * far_from_full);
  std::uint8_t any = 0;
  with_variance(variance_of, [&, codes = run.codes.data(), kinds = run.kinds.data(), rate = &rates[run.begin],
                              t = run.exposure_s, count = run.codes.size(), scores = &score[run.begin],
                              informations = &information[run.begin], nears = &near[run.begin]](const auto& variance) {
    std::uint8_t some = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const SampleKind kind = kinds[i];
      const float expected = rate[i] * t, v = variance(expected), left = full_scale - expected, weight = t / v,
                  said = weight * (codes[i] - expected), known = weight * t;
      const bool is_near = left * left < far * v, usable = kind != SampleKind::unusable;
      scores[i] += !is_near & (kind == SampleKind::read) ? said : 0.0f;
      informations[i] += !is_near & usable & (left > 0) ? known : 0.0f;
      nears[i] = is_near & usable;
      some |= nears[i];
    }
    any = some;
  });
  return any != 0;
}

void add_squares(const ExposureRun& run, std::span<const float> rates, const NoiseVariance& variance_of,
                 float full_scale, std::span<float> chi_square, std::span<std::uint8_t> readings) {
  constexpr auto clear = static_cast<float>(clear_of_full * clear_of_full);
  with_variance(variance_of, [&, codes = run.codes.data(), kinds = run.kinds.data(), rate = &rates[run.begin],
                              t = run.exposure_s, count = run.codes.size(), chi = &chi_square[run.begin],
                              counts = &readings[run.begin]](const auto& variance) {
    for (std::size_t i = 0; i < count; ++i) {
      const float expected = rate[i] * t, v = variance(expected), left = full_scale - expected,
                  off = codes[i] - expected;
      const float square = off * off / v;
      const bool counted = (kinds[i] == SampleKind::read) & (left >= 0) & (left * left >= clear * v);
      chi[i] += counted ? square : 0.0f;
      counts[i] = static_cast<std::uint8_t>(counts[i] + (counted ? 1 : 0));
    }
  });
}

}  // namespace gonio::photograph
