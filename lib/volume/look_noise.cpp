// Noise: deviations from the mean of a cube round a voxel, where the cube and a margin of a voxel surely are air or
// surely object. A cube of 7 voxels where there is room, else of 3; the voxel's own share in the mean is put back.
#include <cmath>

#include "volume/look_parts.h"

namespace gonio::volume {
namespace {

struct Tier {
  std::size_t room, half;  // erosion; the cube has 2 half + 1 voxels
};
constexpr std::array<Tier, 3> tiers_of_noise{{{4, 3}, {2, 1}, {1, 1}}};
constexpr std::size_t enough_residuals = 3000, most_residuals = 1 << 18;

}  // namespace

NoiseProbe::NoiseProbe() {
  for (std::size_t t = 0; t < tiers_of_noise.size(); ++t)
    air_.emplace_back(most_residuals), object_.emplace_back(most_residuals);
}

void NoiseProbe::take(const Slab& slab, const Flags& air, const Flags& object) {
  take_side(slab, air, air_);
  take_side(slab, object, object_);
}

void NoiseProbe::take_side(const Slab& slab, const Flags& side, Tiers& tiers) {
  const std::size_t w = slab.width, slice = w * slab.height;
  for (std::size_t t = 0; t < tiers_of_noise.size(); ++t) {
    // A better cube had enough already.
    if (t > 0 && tiers[t - 1].all().size() >= enough_residuals) return;
    const Flags deep = eroded(slab, side, tiers_of_noise[t].room);
    const auto half = static_cast<std::ptrdiff_t>(tiers_of_noise[t].half);
    const double n = std::pow(2 * static_cast<double>(half) + 1, 3), own = std::sqrt(n / (n - 1));
    for (std::size_t at = slab.margin * slice; at < (slab.margin + slab.count) * slice; ++at) {
      if (!deep[at] || !tiers[t].wants()) continue;
      double sum = 0;
      const float* v = slab.values.data() + at;
      for (std::ptrdiff_t c = -half; c <= half; ++c)
        for (std::ptrdiff_t b = -half; b <= half; ++b)
          for (std::ptrdiff_t a = -half; a <= half; ++a)
            sum += v[c * static_cast<std::ptrdiff_t>(slice) + b * static_cast<std::ptrdiff_t>(w) + a];
      const double mean = sum / n;
      const auto off = [&](float value) { return static_cast<float>((value - mean) * own); };
      tiers[t].add({off(v[0]), off(v[1]), off(v[w]), off(v[slice])});
    }
  }
}

void NoiseProbe::finish(Look& look) {
  const auto best = [](Tiers& tiers) -> std::vector<Residual>& {
    for (auto& tier : tiers)
      if (tier.all().size() >= enough_residuals) return tier.all();
    for (auto& tier : tiers)
      if (tier.all().size() >= 50) return tier.all();
    tiers.back().all().clear();  // too few to say anything
    return tiers.back().all();
  };
  const auto here = [](const std::vector<Residual>& residuals) {
    std::vector<double> values;
    for (const Residual& r : residuals) values.push_back(r.here);
    return values;
  };
  const std::vector<Residual>& air = best(air_);
  look.noise_air = robust_sd(here(air));
  look.noise_object = robust_sd(here(best(object_)));
  double products = 0, squares = 0;
  for (const Residual& r : air) {
    const auto within = [&](float v) { return std::abs(v) <= 3 * look.noise_air; };
    if (!within(r.here) || !within(r.along_i) || !within(r.along_j) || !within(r.along_k)) continue;
    products += r.here * (r.along_i + r.along_j + r.along_k) / 3.0;
    squares += double{r.here} * r.here;
  }
  look.noise_correlation = squares > 0 ? products / squares : 0;
}

}  // namespace gonio::volume
