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

struct Bins {
  std::vector<double> at, weight;  // centre, share of all voxels
  double width = 0, voxels = 0;
};

// No more than 1024 bins over what holds all but a millionth of the voxels on either side.
Bins bins_of(const Histogram& h) {
  Bins bins;
  const std::size_t n = h.counts.size();
  for (const auto c : h.counts) bins.voxels += static_cast<double>(c);
  std::size_t first = 0, last = n;
  for (double below = 0; first + 1 < last; ++first)
    if ((below += static_cast<double>(h.counts[first])) > 1e-6 * bins.voxels) break;
  for (double above = 0; last > first + 1; --last)
    if ((above += static_cast<double>(h.counts[last - 1])) > 1e-6 * bins.voxels) break;
  const std::size_t together = (last - first + 1023) / 1024;
  const double width = (h.high - h.low) / static_cast<double>(n);
  bins.width = width * static_cast<double>(together);
  for (std::size_t b = first; b < last; b += together) {
    double sum = 0;
    for (std::size_t k = b; k < std::min(b + together, last); ++k) sum += static_cast<double>(h.counts[k]);
    if (sum == 0) continue;
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

double density(const Model& m, std::size_t component, double x) {
  const std::size_t k = m.mean.size();
  if (component < k) {
    const double z = (x - m.mean[component]) / m.sd[component];
    return m.share[component] * std::exp(-0.5 * z * z) / (m.sd[component] * std::sqrt(2 * pi));
  }
  const std::size_t a = component - k, b = a + 1;
  const double wide = m.mean[b] - m.mean[a];
  if (!(wide > 0) || m.mixed[a] == 0) return 0;
  return m.mixed[a] * std::max(0.0, phi((x - m.mean[a]) / m.sd[a]) - phi((x - m.mean[b]) / m.sd[b])) / wide;
}

// One step; the likelihood is that of the model as it came.
void improve(Model& m, const Bins& bins) {
  const std::size_t k = m.mean.size(), all = 2 * k - 1;
  std::vector<double> weight(all, 0.0), sum(k, 0.0), squares(k, 0.0), p(all);
  double likelihood = 0;
  for (std::size_t b = 0; b < bins.at.size(); ++b) {
    double total = 1e-300;
    for (std::size_t c = 0; c < all; ++c) total += p[c] = density(m, c, bins.at[b]);
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

void iterate(Model& m, const Bins& bins) {
  double before = -HUGE_VAL;
  for (int step = 0; step < 400; ++step) {
    improve(m, bins);
    if (step > 10 && m.log_likelihood - before < 1e-9) break;
    before = m.log_likelihood;
  }
}

// From values spread evenly, and from even shares of the voxels that are not of the largest heap.
Model best_model(const Bins& bins, std::size_t k) {
  std::vector<double> even, shares;
  const double low = bins.at.front(), high = bins.at.back();
  for (std::size_t c = 0; c < k; ++c)
    even.push_back(low + (high - low) * (static_cast<double>(c) + (k == 1 ? 0.5 : 0)) / std::max(1.0, double(k) - 1));
  double sum = 0;
  for (const double w : bins.weight) sum += std::sqrt(w);
  double done = 0;
  for (std::size_t b = 0; b < bins.at.size() && shares.size() < k; ++b)
    if ((done += std::sqrt(bins.weight[b])) >= sum * (static_cast<double>(shares.size()) + 0.5) / double(k))
      shares.push_back(bins.at[b]);
  while (shares.size() < k) shares.push_back(high);
  Model best;
  for (const auto& start : {even, shares}) {
    Model m = started(bins, start);
    iterate(m, bins);
    if (best < m) best = m;
  }
  return best;
}

Mixture mixture_of(const Model& m, const Bins& bins) {
  Mixture mixture;
  const double facts = bins.voxels / voxels_per_fact;
  std::vector<std::size_t> order(m.mean.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return m.mean[a] < m.mean[b]; });
  for (const std::size_t c : order) {
    const double variance = std::max(m.sd[c] * m.sd[c] - bins.width * bins.width / 12, 0.0);
    mixture.materials.push_back(
        {m.mean[c], std::sqrt(variance), m.share[c], m.sd[c] / std::sqrt(std::max(1.0, m.share[c] * facts))});
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
    if (!(b.mean - a.mean > least_separation * std::sqrt((a.sd * a.sd + b.sd * b.sd) / 2))) return false;
  }
  return true;
}

}  // namespace

Mixture materials(const Histogram& histogram, int count) {
  if (count < 1 || count > 16)
    throw Error(Exit::usage, "materials", std::to_string(count) + " asked (1 to 16 can be told apart)");
  const Bins bins = bins_of(histogram);
  if (bins.at.size() < static_cast<std::size_t>(count))
    throw Error(Exit::data, "histogram",
                std::to_string(count) + " materials asked, but " + std::to_string(bins.at.size()) + " value" +
                    (bins.at.size() == 1 ? " occurs" : "s occur"),
                "a volume of one value has no surface: check the scan, or the window in which it was exported");
  return mixture_of(best_model(bins, static_cast<std::size_t>(count)), bins);
}

Mixture materials(const Histogram& histogram) {
  const Bins bins = bins_of(histogram);
  if (bins.at.size() < 2) return materials(histogram, 1);
  Mixture best = materials(histogram, 2);
  for (int count = 3; count <= 5 && bins.at.size() >= static_cast<std::size_t>(2 * count); ++count) {
    const Mixture more = materials(histogram, count);
    if (is_of_separate_materials(more) && (more.bic < best.bic || !is_of_separate_materials(best))) best = more;
  }
  return best;
}

}  // namespace gonio::volume
