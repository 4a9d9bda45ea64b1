// Materials in a histogram: normal components, and between neighbouring ones the voxels that hold both (Santago & Gage
// 1993), whose value is uniform between the two means, smeared by the noise:
//
//   p(x) = (Phi((x - m1) / s1) - Phi((x - m2) / s2)) / (m2 - m1)
//
// Expectation maximisation. Means and widths are moments of what a material alone is responsible for: at the true
// parameters these moments are the true ones, so that the estimate is consistent although the mixed component, too,
// knows the means. Widths of bins are taken off and put on again (Sheppard).
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "volume/look.h"

namespace gonio::volume {
namespace {

// Noise of a tomogram is shared over about three voxels along each axis: so many voxels tell as much as one.
constexpr double voxels_per_fact = 27;
// Two normal components of which neither has a mode of its own are one material with a slope in it (Ashman, Bird & Zepf
// 1994: D = |m1 - m2| / rms(s1, s2) > 2).
constexpr double least_separation = 2.2, least_share = 2e-5;
// What lies between two materials is where they meet, and no volume is mostly that: two heaps with more between them
// are the ends of noise that is spread evenly (dithered, or clipped).
constexpr double most_partial = 0.5;

struct Bins {
  std::vector<double> at, weight;  // centre, share of all voxels
  double width = 0, voxels = 0;
};

// No more than 640 bins over what holds all but a millionth of the voxels on either side.
Bins bins_of(const Histogram& h) {
  Bins bins;
  const std::size_t n = h.counts.size();
  for (const auto c : h.counts) bins.voxels += static_cast<double>(c);
  std::size_t first = 0, last = n;
  for (double below = 0; first + 1 < last; ++first)
    if ((below += static_cast<double>(h.counts[first])) > 1e-6 * bins.voxels) break;
  for (double above = 0; last > first + 1; --last)
    if ((above += static_cast<double>(h.counts[last - 1])) > 1e-6 * bins.voxels) break;
  const std::size_t together = (last - first + 639) / 640;
  const double width = (h.high - h.low) / static_cast<double>(n);
  bins.width = width * static_cast<double>(together);
  for (std::size_t b = first; b < last; b += together) {
    double sum = 0;
    for (std::size_t k = b; k < std::min(b + together, last); ++k) sum += static_cast<double>(h.counts[k]);
    bins.at.push_back(h.low + width * (static_cast<double>(b) + 0.5 * static_cast<double>(together)));
    bins.weight.push_back(sum / bins.voxels);
  }
  return bins;
}

double phi(double z) {
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

struct Model {
  std::vector<double> mean, sd, share, mixed;  // mixed[k]: between k and k + 1
  double log_likelihood = -HUGE_VAL;           // per voxel
  bool operator<(const Model& o) const { return log_likelihood < o.log_likelihood; }
};

// Of all components at x: the materials, then what lies between each and the next.
void densities(const Model& m, double x, std::vector<double>& p, std::vector<double>& below) {
  const std::size_t k = m.mean.size();
  for (std::size_t c = 0; c < k; ++c) {
    const double z = (x - m.mean[c]) / m.sd[c];
    p[c] = std::abs(z) < 12 ? m.share[c] * std::exp(-0.5 * z * z) / (m.sd[c] * std::sqrt(2 * pi)) : 0;
    below[c] = z > 6 ? 1 : z < -6 ? 0 : phi(z);
  }
  for (std::size_t c = 0; c + 1 < k; ++c) {
    const double wide = m.mean[c + 1] - m.mean[c];
    p[k + c] = wide > 0 ? m.mixed[c] * std::max(0.0, below[c] - below[c + 1]) / wide : 0;
  }
}

// One step; the likelihood is that of the model as it came.
void improve(Model& m, const Bins& bins) {
  const std::size_t k = m.mean.size(), all = 2 * k - 1;
  std::vector<double> weight(all, 0.0), sum(k, 0.0), squares(k, 0.0), p(all), below(k);
  double likelihood = 0;
  for (std::size_t b = 0; b < bins.at.size(); ++b) {
    if (bins.weight[b] == 0) continue;
    double total = 1e-300;
    densities(m, bins.at[b], p, below);
    for (std::size_t c = 0; c < all; ++c) total += p[c];
    likelihood += bins.weight[b] * std::log(total);
    for (std::size_t c = 0; c < all; ++c) {
      const double w = bins.weight[b] * p[c] / total;
      weight[c] += w;
      if (c < k) sum[c] += w * (bins.at[b] - m.mean[c]), squares[c] += w * std::pow(bins.at[b] - m.mean[c], 2);
    }
  }
  m.log_likelihood = likelihood;
  const double narrowest = 0.3 * bins.width;
  for (std::size_t c = 0; c < k; ++c) {
    m.share[c] = weight[c];
    if (weight[c] < 1e-12) continue;
    const double shift = sum[c] / weight[c];
    m.sd[c] = std::max(narrowest, std::sqrt(std::max(0.0, squares[c] / weight[c] - shift * shift)));
    m.mean[c] += shift;
  }
  for (std::size_t c = k; c < all; ++c) m.mixed[c - k] = weight[c];
}

Model started(const Bins& bins, std::vector<double> means) {
  // Lloyd's iteration from there.
  const std::size_t k = means.size();
  std::vector<double> sum(k), squares(k), weight(k);
  for (int round = 0; round < 50; ++round) {
    std::fill(sum.begin(), sum.end(), 0), std::fill(weight.begin(), weight.end(), 0);
    std::fill(squares.begin(), squares.end(), 0);
    for (std::size_t b = 0; b < bins.at.size(); ++b) {
      std::size_t nearest = 0;
      for (std::size_t c = 1; c < k; ++c)
        if (std::abs(bins.at[b] - means[c]) < std::abs(bins.at[b] - means[nearest])) nearest = c;
      weight[nearest] += bins.weight[b], sum[nearest] += bins.weight[b] * bins.at[b];
      squares[nearest] += bins.weight[b] * bins.at[b] * bins.at[b];
    }
    for (std::size_t c = 0; c < k; ++c)
      if (weight[c] > 0) means[c] = sum[c] / weight[c];
  }
  Model m;
  for (std::size_t c = 0; c < k; ++c) {
    const double variance = weight[c] > 0 ? squares[c] / weight[c] - means[c] * means[c] : 0;
    m.mean.push_back(means[c]);
    m.sd.push_back(std::max(bins.width, std::sqrt(std::max(0.0, variance)) / 2));
    m.share.push_back(std::max(1e-6, 0.9 * weight[c]));
  }
  m.mixed.assign(k - 1, 0.1 / static_cast<double>(k));
  return m;
}

Mixture mixture_of(const Model& m, const Bins& bins) {
  Mixture mixture;
  const double facts = bins.voxels / voxels_per_fact;
  std::vector<std::size_t> order(m.mean.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return m.mean[a] < m.mean[b]; });
  for (const std::size_t c : order) {
    const double variance = std::max(m.sd[c] * m.sd[c] - bins.width * bins.width / 12, 0.0);
    mixture.materials.push_back({m.mean[c], std::sqrt(variance), m.share[c],
                                 m.sd[c] / std::sqrt(std::max(1.0, m.share[c] * facts)),
                                 c < m.mixed.size() ? m.mixed[c] : 0});
  }
  mixture.partial_share = std::accumulate(m.mixed.begin(), m.mixed.end(), 0.0);
  const double numbers = 4 * static_cast<double>(m.mean.size()) - 2;  // means, widths, shares, mixed shares, sum 1
  mixture.bic = -2 * facts * m.log_likelihood + numbers * std::log(std::max(2.0, facts));
  return mixture;
}

bool is_of_separate_materials(const Mixture& mixture) {
  for (std::size_t c = 0; c < mixture.materials.size(); ++c) {
    const Material& b = mixture.materials[c];
    if (b.share < least_share) return false;
    if (c == 0) continue;
    const Material& a = mixture.materials[c - 1];
    if (a.partial_above > most_partial) return false;
    if (!(b.mean - a.mean > least_separation * std::sqrt((a.sd * a.sd + b.sd * b.sd) / 2))) return false;
  }
  return true;
}

// A heap of the histogram: where, how wide (to 60 % of its height on the steeper side: a standard deviation), and by
// which factor of its height one must descend from it to reach a higher one.
struct Heap {
  std::size_t bin;
  double sd, prominence;
};
std::vector<Heap> heaps_of(const Bins& bins) {
  const auto n = static_cast<std::ptrdiff_t>(bins.at.size());
  const double wide = std::max(0.7, static_cast<double>(n) / 200);
  const auto reach = static_cast<std::ptrdiff_t>(3 * wide) + 1;
  std::vector<double> smooth(bins.at.size());
  for (std::ptrdiff_t b = 0; b < n; ++b) {
    double sum = 0, weights = 0;
    for (std::ptrdiff_t c = std::max<std::ptrdiff_t>(0, b - reach); c <= std::min(n - 1, b + reach); ++c) {
      const double z = static_cast<double>(c - b) / wide, w = std::exp(-0.5 * z * z);
      sum += w * bins.weight[static_cast<std::size_t>(c)], weights += w;
    }
    smooth[static_cast<std::size_t>(b)] = sum / weights + 0.1 / bins.voxels;
  }
  std::vector<Heap> heaps;
  for (std::size_t b = 0; b < smooth.size(); ++b) {
    if ((b > 0 && smooth[b] < smooth[b - 1]) || (b + 1 < smooth.size() && smooth[b] <= smooth[b + 1])) continue;
    double prominence = HUGE_VAL, width = HUGE_VAL;
    for (const std::ptrdiff_t step : {std::ptrdiff_t{-1}, std::ptrdiff_t{1}}) {
      double lowest = smooth[b];
      std::ptrdiff_t c = static_cast<std::ptrdiff_t>(b);
      bool higher = false, narrow = false;
      for (; c >= 0 && c < n && !higher; c += step) {
        const double here = smooth[static_cast<std::size_t>(c)];
        if (!narrow && here < 0.607 * smooth[b])
          width = std::min(width, std::abs(static_cast<double>(c) - static_cast<double>(b))), narrow = true;
        lowest = std::min(lowest, here), higher = here > smooth[b];
      }
      if (higher) prominence = std::min(prominence, smooth[b] / lowest);
    }
    heaps.push_back({b, bins.width * std::max(0.5, width == HUGE_VAL ? 1 : width), prominence});
  }
  std::sort(heaps.begin(), heaps.end(), [](const Heap& a, const Heap& b) { return a.prominence > b.prominence; });
  return heaps;
}

// From the k most prominent heaps; empty where there are fewer.
Model started_on_heaps(const Bins& bins, std::size_t k) {
  std::vector<Heap> heaps = heaps_of(bins);
  Model m;
  if (heaps.size() < k) return m;
  heaps.resize(k);
  std::sort(heaps.begin(), heaps.end(), [](const Heap& a, const Heap& b) { return a.bin < b.bin; });
  double covered = 0;
  for (const Heap& h : heaps) {
    double share = 0;
    for (std::size_t b = 0; b < bins.at.size(); ++b)
      if (std::abs(bins.at[b] - bins.at[h.bin]) < 2 * h.sd) share += bins.weight[b];
    m.mean.push_back(bins.at[h.bin]), m.sd.push_back(h.sd), m.share.push_back(std::max(1e-6, 0.8 * share));
    covered += m.share.back();
  }
  m.mixed.assign(k - 1, std::max(1e-6, (1 - covered) / static_cast<double>(k)));
  return m;
}

void iterate(Model& m, const Bins& bins) {
  double before = -HUGE_VAL;
  for (int step = 0; step < 300; ++step) {
    improve(m, bins);
    if (step > 10 && m.log_likelihood - before < 1e-8) break;
    before = m.log_likelihood;
  }
}

// One more than asked for, the one with the fewest voxels left out again: what lies between materials is mixed.
Model one_left_out(const Bins& bins, std::size_t k) {
  Model more = started_on_heaps(bins, k + 1);
  if (more.mean.empty()) return more;
  iterate(more, bins);
  const auto least = std::min_element(more.share.begin(), more.share.end()) - more.share.begin();
  for (auto* v : {&more.mean, &more.sd, &more.share}) v->erase(v->begin() + least);
  more.mixed.assign(k - 1, 0.1 / static_cast<double>(k));
  return more;
}

// From values spread evenly, from even shares of the square roots of the counts, and from the heaps.
Model best_model(const Bins& bins, std::size_t k) {
  std::vector<double> even, shares;
  const double low = bins.at.front(), high = bins.at.back(), n = static_cast<double>(k);
  for (std::size_t c = 0; c < k; ++c)
    even.push_back(low + (high - low) * (static_cast<double>(c) + (k == 1 ? 0.5 : 0)) / std::max(1.0, n - 1));
  double sum = 0, done = 0;
  for (const double w : bins.weight) sum += std::sqrt(w);
  for (std::size_t b = 0; b < bins.at.size() && shares.size() < k; ++b)
    if ((done += std::sqrt(bins.weight[b])) >= sum * (static_cast<double>(shares.size()) + 0.5) / n)
      shares.push_back(bins.at[b]);
  while (shares.size() < k) shares.push_back(high);
  std::vector<Model> starts{started(bins, even), started(bins, shares), started_on_heaps(bins, k)};
  Model best, best_sound;
  starts.push_back(one_left_out(bins, k));
  for (Model& m : starts) {
    if (m.mean.empty()) continue;
    iterate(m, bins);
    if (best < m) best = m;
    if (best_sound < m && is_of_separate_materials(mixture_of(m, bins))) best_sound = m;
  }
  return best_sound.mean.empty() ? best : best_sound;
}

}  // namespace

Mixture materials(const Histogram& histogram, int count) {
  if (count < 1 || count > 16)
    throw Error(Exit::usage, "materials", std::to_string(count) + " asked (1 to 16 can be told apart)");
  const Bins bins = bins_of(histogram);
  const auto values = std::count_if(bins.weight.begin(), bins.weight.end(), [](double w) { return w > 0; });
  if (values < count)
    throw Error(Exit::data, "histogram",
                std::to_string(count) + " materials asked, but " + std::to_string(values) + " value" +
                    (values == 1 ? " occurs" : "s occur"),
                "a volume of one value has no surface: check the scan, or the window in which it was exported");
  return mixture_of(best_model(bins, static_cast<std::size_t>(count)), bins);
}

Mixture materials(const Histogram& histogram) {
  const auto values = static_cast<std::size_t>(
      std::count_if(histogram.counts.begin(), histogram.counts.end(), [](std::uint64_t n) { return n > 0; }));
  if (values < 2) return materials(histogram, 1);
  Mixture best = materials(histogram, 2);
  for (int count = 3; count <= 5 && values >= static_cast<std::size_t>(2 * count); ++count) {
    const Mixture more = materials(histogram, count);
    if (is_of_separate_materials(more) && (more.bic < best.bic || !is_of_separate_materials(best))) best = more;
  }
  return best;
}

}  // namespace gonio::volume
