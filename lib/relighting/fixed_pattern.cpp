// The pattern's size is what two views have in common, not what either shows: a recording whose noise is other than it
// was stated would otherwise have its noise for a pattern. With d the deviations of a view, k = 1.18 the variance of
// the deviation of pixels of variance 1, e^2 the variance by the noise that was stated, f a factor on it:
//   k s^2 = mean of d_v d_w over pixels, pairs of views v and w;  f such that d^2 / (k s^2 + f e^2) is 1 in the mean of
//   what lies within 3.5 sigmas;  the best linear guess of a pixel's n is d s / (k s^2 + f e^2)  (Wiener 1949).
#include "relighting/fixed_pattern.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "base/parallel.h"
#include "stats/intervals.h"

namespace gonio::relighting {
namespace {

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
constexpr int reach = 2, side = 2 * reach + 1;
constexpr double neighbours = side * side - 1, free_of_surface = neighbours - 6;
constexpr double with_neighbours = 1 + 5.4 / 29.6;  // see surface_at()
constexpr double least_share = 0.05;                // of the picture's mean: darker pixels divide noise by nothing
constexpr double most_uneven = 1.6;                 // of the usual residual's square: one even place in twenty is lost
constexpr double most_sigmas = 3.5;                 // of a deviation that counts
constexpr std::size_t looked_at = 20000;            // pixels of a picture that say what is usual

std::size_t at(const io::Image& picture, int x, int y, int c) {
  return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x)) +
         static_cast<std::size_t>(c);
}

// The neighbours of a pixel against the quadratic surface that fits them best.
struct Surroundings {
  double centre = 0, mean = 0, surface = 0;  // the value, the neighbours' mean, the surface in the pixel's place
  double residual = 0;                       // mean square from the surface, by its degrees of freedom
  bool counts = false;
};

// By symmetry the surface in the middle is sum (5.4 - r^2) v / 29.6 over the neighbours; what is left of them is their
// square less that of their projections on 1, x, y, x y, x^2 - y^2 and r^2, which are orthogonal over the ring once the
// mean is taken from the last.
Surroundings surroundings(const Recording& image, int x, int y, int c) {
  const io::Image& picture = image.picture;
  Surroundings s;
  std::array<double, side * side> v;
  for (int b = -reach, k = 0; b <= reach; ++b)
    for (int a = -reach; a <= reach; ++a, ++k) {
      const std::size_t i = at(picture, x + a, y + b, c);
      if (!image.counts[i / 3] || !std::isfinite(picture.data[i])) return s;
      v[static_cast<std::size_t>(k)] = picture.data[i];
      s.mean += v[static_cast<std::size_t>(k)];
    }
  s.centre = v[v.size() / 2];
  s.mean = (s.mean - s.centre) / neighbours;
  double square = 0, along_x = 0, along_y = 0, saddle = 0, cross = 0, bowl = 0;
  for (int b = -reach, k = 0; b <= reach; ++b)
    for (int a = -reach; a <= reach; ++a, ++k) {
      if (a == 0 && b == 0) continue;
      const double off = v[static_cast<std::size_t>(k)] - s.mean;
      square += off * off;
      along_x += a * off, along_y += b * off, cross += a * b * off;
      saddle += (a * a - b * b) * off, bowl += (a * a + b * b) * off;
    }
  s.surface = s.mean - bowl / 29.6;
  const double left = square - (along_x * along_x + along_y * along_y) / 50 - cross * cross / 100 -
                      saddle * saddle / 140 - bowl * bowl / (370.0 / 3);
  s.residual = std::max(0.0, left) / free_of_surface;
  s.counts = s.mean > least_share * image.mean[c] && s.surface > least_share * image.mean[c];
  return s;
}

double noise_square(const Recording& image, double value) {
  const double sigma = noise_sigma(image, value);
  return sigma * sigma;
}

// What neighbours differ by in most of the picture beyond their noise, relative, squared.
double usual_unevenness(const Recording& image, int width, int height) {
  std::vector<double> beyond;
  const int step = 1 + static_cast<int>(std::sqrt(double(width) * height / looked_at));
  for (int y = reach; y < height - reach; y += step)
    for (int x = reach; x < width - reach; x += step)
      for (int c = 0; c < 3; ++c)
        if (const Surroundings s = surroundings(image, x, y, c); s.counts)
          beyond.push_back((s.residual - noise_square(image, s.mean)) / (s.mean * s.mean));
  return beyond.empty() ? 0 : std::max(0.0, stats::median(beyond));
}

// Weighted means over the pictures of one or several views.
struct Sums {
  std::vector<double> weighted, weight;

  explicit Sums(std::size_t values) : weighted(values), weight(values) {}
  bool known(std::size_t i) const { return weight[i] > 0; }
  double deviation(std::size_t i) const { return weighted[i] / weight[i]; }
  void add(const Sums& other) {
    for (std::size_t i = 0; i < weight.size(); ++i) weighted[i] += other.weighted[i], weight[i] += other.weight[i];
  }
};

void add_picture(const Recording& image, int width, int height, Sums& sums) {
  const double uneven = usual_unevenness(image, width, height);
  parallel_for(
      reach, static_cast<std::size_t>(std::max(reach, height - reach)),
      [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = reach; x < width - reach; ++x)
          for (int c = 0; c < 3; ++c) {
            const Surroundings s = surroundings(image, x, y, c);
            if (!s.counts) continue;
            const double noise = noise_square(image, s.mean), square = s.mean * s.mean;
            if (!(noise > 0) || s.residual > most_uneven * (noise + uneven * square)) continue;
            const double weight = square / (with_neighbours * noise);
            const std::size_t i = at(image.picture, x, y, c);
            sums.weighted[i] += weight * (s.centre / s.surface - 1);
            sums.weight[i] += weight;
          }
      },
      16);
}

double spread_of(const Sums& sums) {
  std::vector<double> known;
  for (std::size_t i = 0; i < sums.weight.size(); ++i)
    if (sums.known(i)) known.push_back(sums.deviation(i));
  return known.empty() ? 0 : stats::robust_sigma(known);
}

// k s^2 of one camera: mean product of what two of its views show at a pixel, over all pairs of them; 0 where they have
// nothing in common. The products of a pixel add up to half of the square of its sum less its sum of squares.
double in_common(const std::vector<const Sums*>& views) {
  std::vector<double> most;
  for (const Sums* view : views) most.push_back(most_sigmas * spread_of(*view));
  double products = 0, pairs = 0;
  for (std::size_t i = 0; i < views[0]->weight.size(); ++i) {
    double sum = 0, squares = 0, count = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (!views[v]->known(i)) continue;
      const double d = views[v]->deviation(i);
      if (std::abs(d) <= most[v]) sum += d, squares += d * d, count += 1;
    }
    products += 0.5 * (sum * sum - squares), pairs += 0.5 * count * (count - 1);
  }
  return pairs > 0 ? std::max(0.0, products / pairs) : 0;
}

// f, by halving its logarithm's range.
double factor_on_noise(const Sums& sums, double pattern) {
  double low = 1e-2, high = 1e4;
  for (int step = 0; step < 20; ++step) {
    const double middle = std::sqrt(low * high);
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < sums.weight.size(); ++i) {
      if (!sums.known(i)) continue;
      const double square = std::pow(sums.deviation(i), 2) / (pattern + middle / sums.weight[i]);
      if (square <= most_sigmas * most_sigmas) sum += square, ++count;
    }
    (sum > count ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

FixedPattern::OfView held_against(const Sums& sums, double pattern) {
  FixedPattern::OfView view;
  view.deviation.assign(sums.weight.size(), unknown);
  view.normal.assign(sums.weight.size(), unknown);
  view.any = std::any_of(sums.weight.begin(), sums.weight.end(), [](double w) { return w > 0; });
  if (!view.any) return view;
  view.size = std::sqrt(pattern / with_neighbours);
  const double factor = factor_on_noise(sums, pattern);
  for (std::size_t i = 0; i < sums.weight.size(); ++i) {
    if (!sums.known(i)) continue;
    const double d = sums.deviation(i), variance = pattern + factor / sums.weight[i];
    view.deviation[i] = static_cast<float>(d);
    if (d * d <= most_sigmas * most_sigmas * variance) view.normal[i] = static_cast<float>(d * view.size / variance);
  }
  return view;
}

// Does view v learn from view w? Each pair in one direction: from the half of the views that follow, in a circle.
bool learns(std::size_t v, std::size_t w, std::size_t views) {
  if (v == w) return false;
  const std::size_t ahead = (w + views - v) % views;
  return 2 * ahead < views || (2 * ahead == views && v < w);
}

}  // namespace

FixedPattern fixed_pattern(const Recordings& recordings) {
  const std::size_t views = recordings.views.size();
  std::vector<Sums> own;
  for (const View& view : recordings.views) {
    const int width = view.model.width_px(), height = view.model.height_px();
    own.emplace_back(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (const Recording& image : recordings.images)
      if (image.view == own.size() - 1) add_picture(image, width, height, own.back());
  }
  FixedPattern result;
  std::map<std::string, double> of_camera;
  for (std::size_t v = 0; v < views; ++v) {
    const auto same = [&](std::size_t w) { return recordings.views[w].camera == recordings.views[v].camera; };
    const auto [pattern, is_new] = of_camera.try_emplace(recordings.views[v].camera);
    if (is_new) {
      std::vector<const Sums*> seen;
      for (std::size_t w = v; w < views; ++w)
        if (same(w)) seen.push_back(&own[w]);
      pattern->second = in_common(seen);
    }
    Sums others(own[v].weight.size());
    for (std::size_t w = 0; w < views; ++w)
      if (same(w) && learns(v, w, views)) others.add(own[w]);
    result.views.push_back(held_against(others, pattern->second));
  }
  return result;
}

}  // namespace gonio::relighting
