// See stack_sites.h. Levels are cut into strata of equal width; each gives its share of the sites, in random places,
// the flattest of eight draws.
#include "explain/stacks/stack_sites.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "photograph/noise_variance.h"

namespace gonio::explain::stacks {
namespace {

constexpr std::size_t strata = 16, draws = 8, fewest_sites = 32, noise_bins = 16;
constexpr std::uint64_t site_seed = 97;
constexpr double clear_of_ends = 3;  // standard deviations

std::size_t index(const Stack& stack, int x, int y, int c) {
  return stack.images[0].picture.index(x, y, c);
}

// Largest difference to the four neighbours of the same filter over the mean, averaged over the images in which all
// count; edges of the picture have none.
double roughness(const Stack& stack, int x, int y, int c, const std::vector<std::size_t>& seen) {
  double spread = 0, sum = 0;
  for (const std::size_t g : seen) {
    const io::Image& p = stack.images[g].picture;
    const double v = p.at(x, y, c);
    double worst = 0;
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
      worst = std::max(worst, std::abs(double{p.at(x + dx * stack.step, y + dy * stack.step, c)} - v));
    spread += worst;
    sum += std::abs(v);
  }
  return sum > 0 ? spread / sum : 1e9;
}

// Does the brightness around a pixel keep clear of the codes' ends?
bool keeps_clear(const Stack& stack, const ReadingNoise& noise, std::size_t g, int x, int y, int c) {
  if (!stack.integer) return true;
  const StackImage& image = stack.images[g];
  double mean = 0;
  for (int v = -1; v <= 1; ++v)
    for (int u = -1; u <= 1; ++u) {
      if (u == 0 && v == 0) continue;
      const std::size_t i = image.picture.index(x + u * stack.step, y + v * stack.step, c);
      if (!image.counts[i]) return false;
      mean += image.picture.data[i] / 8;
    }
  const double reach = clear_of_ends * noise.sigma(g, mean);
  return mean > stack.lowest + reach && mean < stack.highest - reach;
}

// All sites of one channel that count in enough images, without their roughness.
std::vector<Site> all_sites(const Stack& stack, const ReadingNoise& noise, int c, std::size_t fewest) {
  std::vector<Site> sites;
  const int edge = stack.step;
  for (int y = edge; y + edge < stack.height(); ++y)
    for (int x = edge; x + edge < stack.width(); ++x) {
      Site site{x, y, c, 0, 0, {}};
      const std::size_t i = index(stack, x, y, c);
      for (std::size_t g = 0; g < stack.images.size(); ++g) {
        if (stack.images[g].counts[i] && keeps_clear(stack, noise, g, x, y, c)) site.seen.push_back(g);
        site.level += stack.images[g].picture.data[i] / static_cast<double>(stack.images.size());
      }
      if (site.seen.size() >= fewest && std::isfinite(site.level)) sites.push_back(std::move(site));
    }
  return sites;
}

std::vector<Site> chosen_of_channel(const Stack& stack, const ReadingNoise& noise, int c, std::size_t wanted,
                                    const SiteOptions& options) {
  std::vector<Site> all = all_sites(stack, noise, c, options.fewest), chosen;
  if (all.empty()) return chosen;
  const auto [least, most] =
      std::minmax_element(all.begin(), all.end(), [](const Site& a, const Site& b) { return a.level < b.level; });
  const double lower = least->level, width = (most->level - lower) / strata;
  std::vector<std::vector<std::size_t>> stratum(strata);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double at = width > 0 ? (all[k].level - lower) / width : 0;
    stratum[std::min(strata - 1, static_cast<std::size_t>(at))].push_back(k);
  }
  std::size_t filled = 0;
  for (const auto& members : stratum) filled += !members.empty();
  Random random(site_seed, static_cast<std::uint64_t>(c));
  for (std::vector<std::size_t>& members : stratum) {
    const std::size_t share = (wanted + filled - 1) / filled;
    for (std::size_t n = 0; n < share && !members.empty(); ++n) {
      std::size_t best = 0;
      double flattest = 1e300;
      for (std::size_t d = 0; d < (options.flat ? draws : 1); ++d) {
        const std::size_t k = random.below(static_cast<std::uint32_t>(members.size()));
        Site& site = all[members[k]];
        if (site.roughness == 0) site.roughness = roughness(stack, site.x, site.y, c, site.seen);
        if (site.roughness < flattest) flattest = site.roughness, best = k;
      }
      chosen.push_back(all[members[best]]);
      members[best] = members.back();
      members.pop_back();
    }
  }
  return chosen;
}

// Interleaved bits of x and y: neighbours in this order are neighbours in the picture.
std::uint64_t morton(int x, int y) {
  std::uint64_t code = 0;
  for (int bit = 0; bit < 20; ++bit)
    code |= (static_cast<std::uint64_t>(x >> bit & 1) << (2 * bit)) |
            (static_cast<std::uint64_t>(y >> bit & 1) << (2 * bit + 1));
  return code;
}

}  // namespace

std::vector<Site> choose_sites(const Stack& stack, const ReadingNoise& noise, const SiteOptions& options,
                               const std::string& place) {
  std::vector<Site> sites;
  for (std::size_t c = 0; c < stack.channels.size(); ++c) {
    std::vector<Site> own =
        chosen_of_channel(stack, noise, static_cast<int>(c), options.sites / stack.channels.size(), options);
    sites.insert(sites.end(), std::make_move_iterator(own.begin()), std::make_move_iterator(own.end()));
  }
  if (sites.size() < fewest_sites)
    throw Error(Exit::data, place,
                "has only " + std::to_string(sites.size()) + " readings that count in at least " +
                    std::to_string(options.fewest) + " pictures",
                "expose so that less is clipped");
  std::stable_sort(sites.begin(), sites.end(),
                   [](const Site& a, const Site& b) { return morton(a.x, a.y) < morton(b.x, b.y); });
  const std::size_t tiles = std::min(options.tiles, sites.size() / 4);
  for (std::size_t k = 0; k < sites.size(); ++k) sites[k].tile = static_cast<std::uint32_t>(k * tiles / sites.size());
  return sites;
}

ReadingNoise::ReadingNoise(const Stack& stack) : stack_(stack) {
  for (const StackImage& image : stack.images) stated_ = stated_ && image.noise_stated;
  if (stated_) return;
  std::vector<std::pair<double, double>> seen;  // reading, |second difference|
  const int step = stack.step, channels = static_cast<int>(stack.channels.size());
  for (const StackImage& image : stack.images)
    for (int y = 0; y < stack.height(); ++y)
      for (int x = step; x + step < stack.width(); ++x)
        for (int c = 0; c < channels; ++c) {
          const io::Image& p = image.picture;
          if (!image.counts[p.index(x - step, y, c)] || !image.counts[p.index(x, y, c)] ||
              !image.counts[p.index(x + step, y, c)])
            continue;
          const double left = p.at(x - step, y, c), middle = p.at(x, y, c), right = p.at(x + step, y, c);
          seen.emplace_back((left + middle + right) / 3, std::abs(left - 2 * middle + right));
        }
  std::sort(seen.begin(), seen.end());
  for (std::size_t b = 0; b < noise_bins; ++b) {
    const auto first = seen.begin() + static_cast<std::ptrdiff_t>(b * seen.size() / noise_bins);
    const auto last = seen.begin() + static_cast<std::ptrdiff_t>((b + 1) * seen.size() / noise_bins);
    if (last - first < 32) continue;
    const auto middle = first + (last - first) / 2;
    level_.push_back(middle->first);
    std::nth_element(first, middle, last, [](const auto& a, const auto& c) { return a.second < c.second; });
    sigma_.push_back(middle->second / 0.6745 / std::sqrt(6.0));
  }
  if (level_.empty()) level_ = {0}, sigma_ = {1e-3 * stack.full_scale};
}

double ReadingNoise::sigma(std::size_t image, double reading) const {
  const double rounding = stack_.quantum * stack_.quantum / 12;
  const StackImage& own = stack_.images[image];
  if (own.noise_stated) return std::sqrt(photograph::noise_variance(own.noise, reading) + rounding + 1e-18);
  const auto above = std::upper_bound(level_.begin(), level_.end(), reading);
  double sigma = above == level_.begin() ? sigma_.front() : above == level_.end() ? sigma_.back() : 0;
  if (sigma == 0 && above != level_.begin() && above != level_.end()) {
    const auto k = static_cast<std::size_t>(above - level_.begin());
    const double t = (reading - level_[k - 1]) / std::max(1e-300, level_[k] - level_[k - 1]);
    sigma = (1 - t) * sigma_[k - 1] + t * sigma_[k];
  }
  return std::sqrt(sigma * sigma + rounding + 1e-18);
}

}  // namespace gonio::explain::stacks
