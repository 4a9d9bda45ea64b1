// See hot_pixels.h.
#include "explain/stacks/hot_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "explain/stacks/pixel_radiance.h"
#include "inference/apart.h"
#include "inference/wording.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::explain::stacks {
namespace {

constexpr double clear = 0.8;            // of full scale
constexpr double false_share = 0.1;      // of those that are found
constexpr double least_z = 5;            // of a point that stands out
constexpr double most_beside = 0.05;     // of what a hot pixel gathers, in the pixels right beside it
constexpr double most_elsewhere = 0.2;   // of it, in the other channels of the same pixel
constexpr double least_p = 1e-3;         // of its growth with the exposure
constexpr std::size_t named_pixels = 4;  // in words

// A point that is brighter, or darker, than all eight neighbours of its filter.
struct Point {
  HotPixels::Pixel pixel;
  double z = 0;  // how far it stands beyond the nearest of them, over the noise and the scene's own unevenness
  bool bright = false;
};

class Points {
 public:
  Points(const Stack& stack, const ReadingNoise& noise)
      : stack_(stack), noise_(noise), radiances_(stack, noise, clear) {}

  std::vector<Point> all() {
    std::vector<Point> points;
    for (int c = 0; c < static_cast<int>(stack_.channels.size()); ++c) {
      const double uneven = unevenness(c);
      for (int y = reach(); y + reach() < stack_.height(); ++y)
        for (int x = reach(); x + reach() < stack_.width(); ++x)
          if (Point point; stands_out(x, y, c, uneven, point)) points.push_back(point);
    }
    return points;
  }
  std::size_t looked_at() const { return looked_at_; }

  // Relative RMSE of the hot pixels' readings about what their neighbours say, and about what their own other pictures
  // do.
  void score(HotPixels& hot) {
    double with = 0, without = 0, norm = 0;
    for (const HotPixels::Pixel& p : hot.pixels)
      for (std::size_t g = 0; g < stack_.images.size(); ++g) {
        const StackImage& image = stack_.images[g];
        const std::size_t i = image.picture.index(p.x, p.y, p.channel);
        const PixelRadiance own = radiances_.without(g, p.x, p.y, p.channel);
        if (!image.counts[i] || !own.known()) continue;
        const double read = stack_.linear(p.channel, image.picture.data[i]), t = image.exposure_s * image.gain;
        const double neighbours = radiances_.at(p.x, p.y, p.channel).value - p.rate;
        with += std::pow(read - neighbours * t, 2), without += std::pow(read - own.value * t, 2), norm += read * read;
      }
    if (norm > 0) hot.with = std::sqrt(with / norm), hot.without = std::sqrt(without / norm);
  }

 private:
  int reach() const { return stack_.step + 1; }
  // Of the eight neighbours of the same filter; false where one is not known.
  bool ring(int x, int y, int c, std::array<double, 8>& values, double& variance) {
    std::size_t k = 0;
    for (int v = -1; v <= 1; ++v)
      for (int u = -1; u <= 1; ++u) {
        if (u == 0 && v == 0) continue;
        const PixelRadiance& r = radiances_.at(x + u * stack_.step, y + v * stack_.step, c);
        if (!r.known()) return false;
        values[k++] = r.value, variance = std::max(variance, r.variance);
      }
    std::ranges::sort(values);
    return true;
  }
  static double middle(const std::array<double, 8>& sorted) { return 0.5 * (sorted[3] + sorted[4]); }

  // By which a scene changes from pixel to pixel, of its brightness: the median over a grid.
  double unevenness(int c) {
    std::vector<double> all;
    const int stride = std::max(1, stack_.width() / 100);
    for (int y = reach(); y + reach() < stack_.height(); y += stride)
      for (int x = reach(); x + reach() < stack_.width(); x += stride) {
        std::array<double, 8> around{};
        double variance = 0;
        const PixelRadiance r = radiances_.at(x, y, c);
        if (!r.known() || !ring(x, y, c, around, variance) || !(middle(around) > 0)) continue;
        all.push_back(std::abs(r.value - middle(around)) / middle(around));
      }
    return all.empty() ? 0 : stats::sigma_of_median * stats::median(all);
  }

  // What of it lies in the four pixels right beside it, over the middle of their own neighbours, in the mean.
  double beside(int x, int y, int c) {
    double sum = 0, count = 0;
    for (const auto& [u, v] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      std::vector<double> own;
      for (int b = -1; b <= 1; ++b)
        for (int a = -1; a <= 1; ++a) {
          const int p = x + u + a * stack_.step, q = y + v + b * stack_.step;
          if ((a == 0 && b == 0) || (p == x && q == y)) continue;
          if (const PixelRadiance& r = radiances_.at(p, q, c); r.known()) own.push_back(r.value);
        }
      const PixelRadiance& r = radiances_.at(x + u, y + v, c);
      if (r.known() && own.size() >= 5) sum += r.value - stats::median(own), count += 1;
    }
    return count > 0 ? sum / count : 0;
  }

  // Does it stand out in another channel, too? What a scene or a speck does is seen in several.
  bool elsewhere(int x, int y, int c, double excess) {
    for (int other = 0; other < static_cast<int>(stack_.channels.size()); ++other) {
      std::array<double, 8> around{};
      double variance = 0;
      const PixelRadiance r = radiances_.at(x, y, other);
      if (other == c || !r.known() || !ring(x, y, other, around, variance)) continue;
      if (!(std::abs(r.value - middle(around)) < most_elsewhere * std::abs(excess))) return true;
    }
    return false;
  }

  // Does its reading grow with the exposure, within half a code, where two pictures at least show that it is hot?
  bool grows(int x, int y, int c, double rate, double excess, double uneven) const {
    double chi_square = 0, pictures = 0, clear_ones = 0;
    for (std::size_t g = 0; g < stack_.images.size(); ++g) {
      const StackImage& image = stack_.images[g];
      const std::size_t i = image.picture.index(x, y, c);
      const double read = image.picture.data[i], t = image.exposure_s * image.gain;
      if (!image.counts[i] || !(read < clear * stack_.full_scale)) continue;
      const double noise = noise_.sigma(g, read);
      const double spread = 0.5 * (stack_.linear(c, read + noise) - stack_.linear(c, std::max(0.0, read - noise)));
      const double sigma = std::hypot(spread, uneven * (rate - excess) * t, 0.5 * stack_.quantum);
      chi_square += std::pow((stack_.linear(c, read) - rate * t) / sigma, 2);
      pictures += 1, clear_ones += excess * t > 3 * sigma;
    }
    return clear_ones >= 2 && stats::chi2_upper(chi_square, pictures - 1) > least_p;
  }

  bool stands_out(int x, int y, int c, double uneven, Point& point) {
    const PixelRadiance r = radiances_.at(x, y, c);
    std::array<double, 8> around{};
    double variance = 0;
    if (!r.known() || !ring(x, y, c, around, variance)) return false;
    ++looked_at_;
    const double middle_of_all = middle(around), beyond = std::max(r.value - around.back(), around.front() - r.value);
    const double sigma = std::sqrt(r.variance + variance + std::pow(uneven * middle_of_all, 2));
    if (!(beyond > least_z * sigma) || !(beyond > around.back() - around.front())) return false;
    const double excess = r.value - middle_of_all;
    if (!(std::abs(beside(x, y, c)) < most_beside * std::abs(excess)) || elsewhere(x, y, c, excess)) return false;
    if (!grows(x, y, c, r.value, excess, uneven)) return false;
    point = {{x, y, c, excess, std::sqrt(r.variance + variance / 8)}, beyond / sigma, excess > 0};
    return true;
  }

  const Stack& stack_;
  const ReadingNoise& noise_;
  PixelRadiances radiances_;
  std::size_t looked_at_ = 0;
};

// From which z on no more than a tenth are the scene's; infinite: nowhere.
double threshold_of(std::vector<Point>& points, double& p) {
  std::ranges::sort(points, std::ranges::greater(), &Point::z);
  double threshold = std::numeric_limits<double>::infinity(), bright = 0, dark = 0;
  for (const Point& point : points) {
    (point.bright ? bright : dark) += 1;
    if (!point.bright || !(1 + dark <= false_share * bright)) continue;
    threshold = point.z;
    p = stats::binomial_upper(static_cast<int>(bright), static_cast<int>(bright + dark), 0.5);
  }
  return threshold;
}

}  // namespace

HotPixels find_hot_pixels(const Stack& stack, const ReadingNoise& noise) {
  HotPixels hot;
  Points looking(stack, noise);
  std::vector<Point> points = looking.all();
  const double threshold = threshold_of(points, hot.p);
  double rates = 0, squares = 0;
  for (const Point& point : points) {
    if (!point.bright || point.z < threshold) continue;
    hot.pixels.push_back(point.pixel);
    rates += point.pixel.rate, squares += point.pixel.rate * point.pixel.rate;
  }
  if (hot.pixels.empty()) return hot;
  std::ranges::sort(hot.pixels, std::ranges::greater(), &HotPixels::Pixel::rate);
  looking.score(hot);
  const double n = static_cast<double>(hot.pixels.size()), all = static_cast<double>(looking.looked_at());
  hot.share = n / all, hot.share_sigma = std::sqrt(n) / all;
  hot.rate = rates / n, hot.rate_sigma = std::sqrt(std::max(0.0, squares / n - hot.rate * hot.rate) / (n - 1));
  double gathered = 0;
  for (const StackImage& image : stack.images)
    for (const HotPixels::Pixel& pixel : hot.pixels)
      if (image.counts[image.picture.index(pixel.x, pixel.y, pixel.channel)])
        gathered += std::pow(pixel.rate * image.exposure_s * image.gain, 2);
  hot.effect = std::sqrt(gathered / sum_of_squared_readings(stack));
  return hot;
}

void conclude_hot_pixels(const Problem& problem, const HotPixels& hot, std::size_t candidate, Explanation& e) {
  const std::vector<std::size_t>& numbers = problem.candidates()[candidate].parameters;
  inference::Apart apart{.candidate = candidate, .estimates = {}, .p = hot.p, .effect = hot.effect};
  apart.with = hot.with, apart.without = hot.without;
  const double values[] = {hot.share, hot.rate}, sigmas[] = {hot.share_sigma, hot.rate_sigma};
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    e.values[numbers[k]] = values[k], e.sigma[numbers[k]] = sigmas[k];
    const double reach = 1.96 * sigmas[k];
    apart.estimates.push_back(
        {numbers[k], values[k], sigmas[k], std::max(0.0, values[k] - reach), values[k] + reach, false});
  }
  inference::join(problem, apart, e);
}

std::string hot_pixels_remark(const HotPixels& hot) {
  if (hot.pixels.empty()) return "";
  std::string where;
  for (std::size_t k = 0; k < std::min(named_pixels, hot.pixels.size()); ++k)
    where += (k == 0 ? "" : ", ") + std::to_string(hot.pixels[k].x) + "," + std::to_string(hot.pixels[k].y);
  return std::to_string(hot.pixels.size()) + " pixels gather more in the dark than others (the hottest at " + where +
         "): a dark frame takes them off (develop --dark).";
}

}  // namespace gonio::explain::stacks
