// Which materials there are: modes of the density of colours, their number by a criterion with a penalty.
//
// A colour is log(v / S), or log chromaticity where a picture's shading is not known; only pixels on even ground count.
// Modes: every colour is linked to the nearest one of higher density (quick shift, Vedaldi & Soatto 2008), and a mode
// that stands out from the ridge to a higher one by less than a factor two is part of that one (Chazal et al. 2013).
// Number: modes enter a mixture, beside an even density for what no material explains (highlights), by size, while the
// Bayesian information criterion falls; neighbouring pixels say the same thing, so that only a part of them counts.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/union_find.h"
#include "reassembly/label_evidence.h"
#include "stats/intervals.h"

namespace gonio::reassembly {
namespace {

constexpr std::size_t most_colours = 4000;
constexpr double bandwidth = 0.12, stands_out = 2, least_share = 0.005, alike_pixels = 4;

using Feature = std::array<float, 3>;  // log of R/G, of B/G, of the mean (0 without shading)

struct Sample {
  Feature feature;
  std::array<float, 3> log_albedo;
};

// The light divided out, and what that makes of a pixel; nothing where it tells no colour.
class Surveyor {
 public:
  Surveyor(const LitPicture& lit, bool by_shading) : lit_(lit), values_(*lit.picture, "the photograph") {
    const Tone mean = values_.mean();
    darkest_ = 0.01f * (mean[0] + mean[1] + mean[2]) / 3;
    if (!by_shading) return;
    shading_ = {*lit.shading, "the shading", lit.picture->width, lit.picture->height};
    const Tone light = shading_.mean();
    dimmest_ = 0.05f * (light[0] + light[1] + light[2]) / 3;
  }
  bool sample(int x, int y, Sample& out) const {
    const int w = lit_.picture->width, h = lit_.picture->height;
    if (x < 1 || y < 1 || x + 1 >= w || y + 1 >= h) return false;
    Feature low{}, high{};
    std::array<float, 3> sum{};
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        std::array<float, 3> log{};
        if (!pixel(static_cast<std::size_t>(y + dy) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x + dx),
                   log))
          return false;
        const Feature f = feature(log);
        for (std::size_t c = 0; c < 3; ++c) {
          low[c] = dx + dy == -2 ? f[c] : std::min(low[c], f[c]);
          high[c] = dx + dy == -2 ? f[c] : std::max(high[c], f[c]);
          sum[c] += log[c] / 9;
        }
      }
    out = {feature(sum), sum};
    steepness_ = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
    return true;
  }
  float steepness() const { return steepness_; }  // of the last sample's neighbourhood

 private:
  bool pixel(std::size_t i, std::array<float, 3>& log) const {
    if (lit_.clipped != nullptr && !lit_.clipped->empty() && (*lit_.clipped)[i] != 0) return false;
    const Tone v = values_(i), s = shading_.known() ? shading_(i) : Tone{1, 1, 1};
    if (!(v[0] + v[1] + v[2] > darkest_) || !((s[0] + s[1] + s[2]) / 3 > dimmest_)) return false;
    for (std::size_t c = 0; c < 3; ++c) log[c] = std::log(std::max(v[c], 0.05f * darkest_) / std::max(s[c], 1e-9f));
    return std::isfinite(log[0] + log[1] + log[2]) && (!shading_.known() || log[1] < 0.3f);  // else it shines
  }
  // Lightness errs by the shading, too: it counts half.
  Feature feature(const std::array<float, 3>& log) const {
    return {log[0] - log[1], log[2] - log[1], shading_.known() ? 0.5f * (log[0] + log[1] + log[2]) / 3 : 0};
  }
  const LitPicture& lit_;
  Tones values_, shading_;
  float darkest_ = 0, dimmest_ = 0;
  mutable float steepness_ = 0;
};

// Evenly over all pictures, from even ground: the half of the samples with the least contrast around them. Under seeds
// all, for these are few.
std::vector<Sample> survey(std::span<const LitPicture> pictures, const std::vector<std::uint8_t>& counts) {
  const bool by_shading =
      std::all_of(pictures.begin(), pictures.end(), [](const LitPicture& p) { return p.shading != nullptr; });
  std::vector<std::pair<float, Sample>> found;
  for (const LitPicture& lit : pictures) {
    const Surveyor surveyor(lit, by_shading);
    std::vector<std::size_t> among;
    for (std::size_t i = 0; i < counts.size(); ++i)
      if (counts[i] != 0) among.push_back(i);
    const std::size_t all = counts.empty() ? lit.picture->pixels() : among.size();
    const auto width = static_cast<std::size_t>(lit.picture->width);
    const std::size_t wanted = std::min(all, std::max<std::size_t>(1, 3 * most_colours / pictures.size()));
    for (std::size_t k = 0; k < wanted; ++k) {
      // Multiples of the golden ratio are spread evenly whatever the width (Weyl).
      const double turn = 0.6180339887498949 * static_cast<double>(k + 1);
      const auto at = std::min(all - 1, static_cast<std::size_t>((turn - std::floor(turn)) * static_cast<double>(all)));
      const std::size_t pixel = counts.empty() ? at : among[at];
      Sample sample{};
      if (surveyor.sample(static_cast<int>(pixel % width), static_cast<int>(pixel / width), sample))
        found.emplace_back(surveyor.steepness(), sample);
    }
  }
  const auto by_steepness = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::stable_sort(found.begin(), found.end(), by_steepness);
  if (counts.empty()) found.resize((found.size() + 1) / 2);
  std::vector<Sample> samples;
  const std::size_t stride = found.size() / most_colours + 1;
  for (std::size_t i = 0; i < found.size(); i += stride) samples.push_back(found[i].second);
  return samples;
}

double distance2(const Feature& a, const Feature& b) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += static_cast<double>(a[c] - b[c]) * static_cast<double>(a[c] - b[c]);
  return sum / (bandwidth * bandwidth);
}

// The mode of every sample: an index of the sample at its peak.
std::vector<std::size_t> modes(const std::vector<Sample>& samples) {
  const std::size_t n = samples.size();
  std::vector<double> density(n);
  parallel_for(
      0, n,
      [&](std::size_t i) {
        for (const Sample& other : samples) {
          const double square = distance2(samples[i].feature, other.feature);
          if (square < 20) density[i] += std::exp(-square / 2);
        }
      },
      16);
  const auto higher = [&](std::size_t a, std::size_t b) {
    return density[a] > density[b] || (density[a] == density[b] && a < b);
  };
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), higher);
  // From the highest down a colour joins the highest that is near; where it joins two hills, the lower one is a part of
  // the other unless its peak stands out from here.
  UnionFind hills(n);
  std::vector<std::size_t> top(n), near;
  const auto hill = [&](std::size_t i) { return hills.group(static_cast<std::uint32_t>(i)); };
  const auto join = [&](std::size_t a, std::size_t b) {  // the peak of what comes out is the higher one
    const std::size_t high = higher(top[hill(a)], top[hill(b)]) ? top[hill(a)] : top[hill(b)];
    hills.join(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
    top[hill(a)] = high;
  };
  for (std::size_t rank = 0; rank < n; ++rank) {
    const std::size_t i = order[rank];
    top[i] = i;
    near.clear();
    for (std::size_t earlier = 0; earlier < rank; ++earlier)
      if (distance2(samples[i].feature, samples[order[earlier]].feature) < 2.25) near.push_back(order[earlier]);
    if (!near.empty()) join(i, near.front());
    for (const std::size_t j : near) {
      if (hill(i) == hill(j)) continue;
      const double lower = std::min(density[top[hill(i)]], density[top[hill(j)]]);
      if (lower < stands_out * density[i]) join(i, j);
    }
  }
  std::vector<std::size_t> peak(n);
  for (std::size_t i = 0; i < n; ++i) peak[i] = top[hill(i)];
  return peak;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Cluster {
  Feature middle{};
  Vec3 albedo;
  double spread = 0.05;
  std::size_t size = 0;
};

Cluster describe(const std::vector<Sample>& samples, const std::vector<std::size_t>& members, bool by_shading) {
  Cluster result;
  result.size = members.size();
  const auto middle = [&](const auto& value) {
    std::vector<double> all;
    for (const std::size_t i : members) all.push_back(static_cast<double>(value(samples[i])));
    return median_of(all);
  };
  std::array<double, 3> log{};
  for (std::size_t c = 0; c < 3; ++c) {
    result.middle[c] = static_cast<float>(middle([&](const Sample& s) { return s.feature[c]; }));
    log[c] = middle([&](const Sample& s) { return by_shading ? s.log_albedo[c] : s.log_albedo[c] - s.log_albedo[1]; });
  }
  double wide = 0;  // 1.4826 median deviations, of the chromaticities
  for (std::size_t c = 0; c < 2; ++c)
    wide = std::max(wide, stats::sigma_of_median *
                              middle([&](const Sample& s) { return std::abs(s.feature[c] - result.middle[c]); }));
  result.spread = std::clamp(wide, 0.03, 0.3);
  const double scale = by_shading ? 0 : std::max({log[0], log[1], log[2]});
  result.albedo = {std::exp(log[0] - scale), std::exp(log[1] - scale), std::exp(log[2] - scale)};
  return result;
}

// Bayesian information criterion of the first `count` clusters with free shares beside an even density.
double criterion(const std::vector<Sample>& samples, const std::vector<Cluster>& clusters, std::size_t count,
                 double volume) {
  const std::size_t n = samples.size();
  std::vector<double> share(count + 1, 1.0 / static_cast<double>(count + 1)), density(n * (count + 1));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < count; ++k)
      density[i * (count + 1) + k] =
          std::exp(-distance2(samples[i].feature, clusters[k].middle) / 2) / std::pow(2 * pi, 1.5);
    density[i * (count + 1) + count] = 1 / volume;
  }
  double log_likelihood = 0;
  for (int round = 0; round < 20; ++round) {
    std::vector<double> next(count + 1);
    log_likelihood = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double sum = 0;
      for (std::size_t k = 0; k <= count; ++k) sum += share[k] * density[i * (count + 1) + k];
      for (std::size_t k = 0; k <= count; ++k) next[k] += share[k] * density[i * (count + 1) + k] / sum;
      log_likelihood += std::log(sum);
    }
    for (std::size_t k = 0; k <= count; ++k) share[k] = next[k] / static_cast<double>(n);
  }
  const double told = static_cast<double>(n) / alike_pixels;
  return -2 * log_likelihood / alike_pixels + 4.0 * static_cast<double>(count) * std::log(told);
}

}  // namespace

std::vector<Material> cluster(std::span<const LitPicture> pictures, int most, const std::vector<std::uint8_t>& counts) {
  const bool by_shading =
      std::all_of(pictures.begin(), pictures.end(), [](const LitPicture& p) { return p.shading != nullptr; });
  const std::vector<Sample> samples = survey(pictures, counts);
  if (samples.empty())
    throw Error(Exit::data, "the photographs", "no pixel tells a colour",
                "brighter pictures, or fewer saturated pixels");
  const std::vector<std::size_t> peak = modes(samples);
  std::vector<std::vector<std::size_t>> members(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) members[peak[i]].push_back(i);
  std::stable_sort(members.begin(), members.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  std::vector<Cluster> clusters;
  for (const auto& group : members) {
    const bool large = static_cast<double>(group.size()) >= least_share * static_cast<double>(samples.size());
    if (clusters.empty() || (large && static_cast<int>(clusters.size()) < most))
      clusters.push_back(describe(samples, group, by_shading));
  }
  double volume = 1;  // of the box of all colours, in bandwidths
  for (std::size_t c = 0; c < 3; ++c) {
    const auto [low, high] = std::minmax_element(
        samples.begin(), samples.end(), [c](const Sample& a, const Sample& b) { return a.feature[c] < b.feature[c]; });
    volume *= 3 + static_cast<double>(high->feature[c] - low->feature[c]) / bandwidth;
  }
  std::size_t best = 1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t count = 1; count <= clusters.size(); ++count) {
    const double value = criterion(samples, clusters, count, volume);
    if (value >= least) continue;
    least = value;
    best = count;
  }
  std::vector<Material> materials;
  for (std::size_t k = 0; k < best; ++k)
    materials.push_back({"m" + std::to_string(k + 1), clusters[k].albedo, clusters[k].spread});
  return materials;
}

std::vector<Material> find_materials(std::span<const LitPicture> pictures, int most) {
  if (pictures.empty() || most < 1)
    throw Error(Exit::data, "the photographs", "none, or no material allowed", "give one at least");
  return cluster(pictures, most);
}

}  // namespace gonio::reassembly
