// See exposure_merge.h.
#include "photograph/exposure_merge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "geom/angle.h"
#include "photograph/exposure_times.h"
#include "photograph/noise_variance.h"
#include "stats/distributions.h"

namespace gonio::photograph {
namespace {

constexpr double clear_of_full = 4;  // standard deviations: nearer to full scale what was read is a selection
constexpr double moved_beyond = 5;   // standard normal: of a neighbourhood's chi-square

// One exposure's samples, sorted.
struct Sorted {
  std::vector<float> codes;
  std::vector<SampleKind> kinds;
};

// What one sample says of the rate: derivative of the log likelihood and information.
struct Word {
  double score = 0, information = 0;
};

class Merge {
 public:
  explicit Merge(const MergeRequest& request)
      : r_(request), pixels_(static_cast<std::size_t>(request.width) * static_cast<std::size_t>(request.height)) {
    check();
    order_ = by_duration(r_.exposures_s);
    merged_.exposures_s = r_.exposures_s;
    merged_.exposures_sigma.assign(r_.exposures_s.size(), 0);
  }

  MergedPlane run() {
    if (r_.refine_exposures && order_.size() > 1) refine();
    start();
    step(false), step(true);
    compare();
    mark_moved();
    return std::move(merged_);
  }

 private:
  void check() const {
    const auto refuse = [](const std::string& place, const std::string& what, const std::string& remedy) {
      throw Error(Exit::data, place, what, remedy);
    };
    if (r_.exposures_s.empty()) refuse("exposures", "are none", "merge one at least");
    if (r_.exposures_s.size() > 255) refuse("exposures", "are more than 255", "leave some out");
    for (const double s : r_.exposures_s)
      if (!(s > 0 && std::isfinite(s))) refuse("exposures", "one does not last longer than 0 s", "state exposure_s");
    if (!(r_.noise.gain > 0 && r_.noise.read >= 0))
      refuse("noise", "has no positive gain", "state electrons per code, and read noise in codes");
    if (!(r_.full_scale > 0)) refuse("full scale", "lies below black", "state the code at which the sensor saturates");
  }

  // What saturated, and what is so near to it that light may have spilled over.
  Sorted read(std::size_t k) const {
    RawPlane plane = r_.read(k);
    if (plane.codes.size() != pixels_ || (!plane.unusable.empty() && plane.unusable.size() != pixels_))
      throw Error(Exit::data, "exposure " + std::to_string(k + 1), "is of another size than the first",
                  "merge exposures of one view by one camera");
    Sorted s{{}, kinds_of(plane, r_.width, r_.height, r_.full_scale, r_.blooming_px)};
    s.codes = std::move(plane.codes);
    return s;
  }
  double lasts(std::size_t place) const { return merged_.exposures_s[order_[place]]; }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(r_.width) + static_cast<std::size_t>(x);
  }

  template <class Body>  // body(place in the order, sorted samples, pixel)
  void pass(const Body& body) const {
    constexpr std::size_t chunk = 1 << 14;
    for (std::size_t place = 0; place < order_.size(); ++place) {
      const Sorted s = read(order_[place]);
      parallel_for(0, (pixels_ + chunk - 1) / chunk, [&](std::size_t c) {
        for (std::size_t i = c * chunk; i < std::min(pixels_, (c + 1) * chunk); ++i) body(place, s, i);
      });
    }
  }

  // Samples of some pixels in all exposures, for the exposures' own times.
  void refine() {
    constexpr std::size_t most = 60000;
    const std::size_t stride = std::max<std::size_t>(1, pixels_ / most) | 1;  // odd: all colours of a mosaic
    ExposureSamples samples{r_.exposures_s, {}, r_.noise, r_.full_scale, r_.floor};
    samples.codes.resize(r_.exposures_s.size());
    for (const std::size_t k : order_) {
      const Sorted s = read(k);
      for (std::size_t i = 0; i < pixels_; i += stride)
        samples.codes[k].push_back(s.kinds[i] == SampleKind::read ? s.codes[i]
                                                                  : std::numeric_limits<float>::quiet_NaN());
    }
    const RefinedExposures refined = refine_exposures(samples);
    merged_.exposures_s = refined.exposures_s, merged_.exposures_sigma = refined.sigma_s;
  }

  // All light over all time: the best where there is shot noise alone.
  void start() {
    merged_.rate.assign(pixels_, 0), merged_.variance.assign(pixels_, 0);
    merged_.trust.assign(pixels_, Trust::no_sample);
    merged_.first.assign(pixels_, 0), merged_.last.assign(pixels_, 0);
    std::vector<float> time(pixels_), bound(pixels_, std::numeric_limits<float>::infinity());
    pass([&](std::size_t place, const Sorted& s, std::size_t i) {
      const double t = lasts(place);
      if (s.kinds[i] == SampleKind::full) {
        bound[i] = std::min(bound[i], static_cast<float>(r_.full_scale / t));
      } else if (s.kinds[i] == SampleKind::read) {
        merged_.rate[i] += s.codes[i], time[i] += static_cast<float>(t);
        if (merged_.trust[i] == Trust::no_sample) merged_.first[i] = static_cast<std::uint8_t>(place);
        merged_.last[i] = static_cast<std::uint8_t>(place);
        merged_.trust[i] = Trust::good;
      }
    });
    for (std::size_t i = 0; i < pixels_; ++i) {
      if (time[i] > 0) {
        merged_.rate[i] /= time[i];
      } else {
        merged_.variance[i] = std::numeric_limits<float>::infinity();
        if (std::isfinite(bound[i])) merged_.rate[i] = bound[i], merged_.trust[i] = Trust::too_bright;
      }
    }
  }

  Word said_by(SampleKind kind, double code, double t, double rate) const {
    const double variance = noise_variance(r_.noise, rate * t), sigma = std::sqrt(variance),
                 a = (rate * t - r_.full_scale) / sigma;
    Word word;
    const bool near = a > -8;
    const double phi = near ? std::exp(-0.5 * a * a) / std::sqrt(2 * pi) : 0, below = near ? stats::normal_cdf(-a) : 1,
                 above = near ? stats::normal_cdf(a) : 0;
    const double hazard = above > 0 ? phi / above : 0;
    word.information = t * t / variance * std::max(0.0, below + a * phi + phi * hazard);
    word.score = kind == SampleKind::read ? t * (code - rate * t) / variance : t / sigma * (near ? hazard : 0);
    return word;
  }

  // One step of scoring; the last one leaves the variance.
  void step(bool last) {
    std::vector<double> score(pixels_), information(pixels_);
    pass([&](std::size_t place, const Sorted& s, std::size_t i) {
      if (merged_.trust[i] != Trust::good || s.kinds[i] == SampleKind::unusable) return;
      const Word word = said_by(s.kinds[i], s.codes[i], lasts(place), merged_.rate[i]);
      score[i] += word.score, information[i] += word.information;
    });
    for (std::size_t i = 0; i < pixels_; ++i) {
      if (merged_.trust[i] != Trust::good || !(information[i] > 0)) continue;
      merged_.rate[i] = static_cast<float>(merged_.rate[i] + score[i] / information[i]);
      if (last) merged_.variance[i] = static_cast<float>(1 / information[i]);
    }
  }

  // Chi-square of what each pixel read about its rate, of samples that are clear of full scale.
  void compare() {
    chi_square_.assign(pixels_, 0), freedom_.assign(pixels_, 0);
    pass([&](std::size_t place, const Sorted& s, std::size_t i) {
      if (merged_.trust[i] != Trust::good || s.kinds[i] != SampleKind::read) return;
      const double expected = merged_.rate[i] * lasts(place), variance = noise_variance(r_.noise, expected);
      if (expected + clear_of_full * std::sqrt(variance) > r_.full_scale) return;
      const double off = s.codes[i] - expected;
      chi_square_[i] += static_cast<float>(off * off / variance), ++freedom_[i];
    });
    for (std::size_t i = 0; i < pixels_; ++i) {
      freedom_[i] = freedom_[i] > 1 ? static_cast<std::uint8_t>(freedom_[i] - 1) : 0;
      if (freedom_[i] == 0) chi_square_[i] = 0;
    }
  }

  // Of a pixel and its neighbours of the same colour, as a standard normal (Wilson & Hilferty 1931); not a number where
  // no pixel was seen twice.
  double contradiction(int x, int y, double noise_factor) const {
    double chi_square = 0, freedom = 0;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const int u = x + dx * r_.period_px, v = y + dy * r_.period_px;
        if (u < 0 || v < 0 || u >= r_.width || v >= r_.height) continue;
        chi_square += chi_square_[at(u, v)], freedom += freedom_[at(u, v)];
      }
    if (freedom == 0) return std::numeric_limits<double>::quiet_NaN();
    const double spread = 2 / (9 * freedom);
    return (std::cbrt(chi_square / (noise_factor * freedom)) - (1 - spread)) / std::sqrt(spread);
  }

  void mark_moved() {
    double chi_square = 0, freedom = 0;
    std::vector<float> ratios;
    for (std::size_t i = 0; i < pixels_; ++i)
      if (freedom_[i] > 0) ratios.push_back(chi_square_[i] / static_cast<float>(freedom_[i]));
    if (ratios.empty()) return;
    // Noise that was stated too small makes everything contradict itself: half of all pixels show no motion. A
    // chi-square's own median lies below its mean.
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    const double noise_factor = std::max(1.0, *middle / usual_median());
    std::vector<std::size_t> moved;
    for (int y = 0; y < r_.height; ++y)
      for (int x = 0; x < r_.width; ++x)
        if (merged_.trust[at(x, y)] == Trust::good && contradiction(x, y, noise_factor) > moved_beyond)
          moved.push_back(at(x, y));
    for (const std::size_t i : moved) merged_.trust[i] = Trust::moved;
    for (std::size_t i = 0; i < pixels_; ++i)
      if (merged_.trust[i] == Trust::good) chi_square += chi_square_[i], freedom += freedom_[i];
    if (freedom > 0) merged_.chi_square_per_freedom = chi_square / freedom;
    if (!moved.empty()) take_one_exposure(moved);
  }
  double usual_median() const {  // of chi-square over its freedom, at the pixels' mean freedom
    double sum = 0, count = 0;
    for (const std::uint8_t f : freedom_)
      if (f > 0) sum += f, ++count;
    const double freedom = std::max(1.0, sum / std::max(1.0, count));
    return stats::chi2_quantile(0.5, freedom) / freedom;
  }

  // The exposure in which most of them are well exposed; where it is not, the one next to it.
  void take_one_exposure(const std::vector<std::size_t>& moved) {
    std::vector<double> worth(order_.size());
    for (std::size_t place = 0; place < order_.size(); ++place) {
      const Sorted s = read(order_[place]);
      for (const std::size_t i : moved)
        if (s.kinds[i] == SampleKind::read)
          worth[place] += std::max(0.0f, s.codes[i]) / std::sqrt(noise_variance(r_.noise, s.codes[i]));
    }
    const auto best = std::ranges::max_element(worth) - worth.begin();
    std::vector<std::size_t> places(order_.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    std::ranges::stable_sort(places, {},
                             [&](std::size_t p) { return std::abs(static_cast<std::ptrdiff_t>(p) - best); });
    std::vector<std::size_t> left = moved;
    for (const std::size_t place : places) {
      if (left.empty()) break;
      const Sorted s = read(order_[place]);
      const double t = lasts(place);
      std::erase_if(left, [&](std::size_t i) {
        if (s.kinds[i] != SampleKind::read) return false;
        merged_.rate[i] = static_cast<float>(s.codes[i] / t);
        merged_.variance[i] = static_cast<float>(noise_variance(r_.noise, s.codes[i]) / (t * t));
        merged_.first[i] = merged_.last[i] = static_cast<std::uint8_t>(place);
        return true;
      });
    }
  }

  const MergeRequest& r_;
  std::size_t pixels_;
  std::vector<std::size_t> order_;  // by duration
  MergedPlane merged_;
  std::vector<float> chi_square_;
  std::vector<std::uint8_t> freedom_;
};

}  // namespace

std::vector<SampleKind> kinds_of(const RawPlane& plane, int width, int height, double full_scale, int blooming_px) {
  std::vector<SampleKind> kinds(plane.codes.size(), SampleKind::read);
  std::vector<std::size_t> full;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (plane.codes[i] >= full_scale)
      kinds[i] = SampleKind::full, full.push_back(i);
    else if ((!plane.unusable.empty() && plane.unusable[i] != 0) ||
             !(plane.codes[i] > -std::numeric_limits<float>::infinity()))
      kinds[i] = SampleKind::unusable;
  }
  const auto columns = static_cast<std::size_t>(width);
  for (const std::size_t i : full) {
    const int x = static_cast<int>(i % columns), y = static_cast<int>(i / columns);
    for (int v = std::max(0, y - blooming_px); v <= std::min(height - 1, y + blooming_px); ++v)
      for (int u = std::max(0, x - blooming_px); u <= std::min(width - 1, x + blooming_px); ++u) {
        SampleKind& kind = kinds[static_cast<std::size_t>(v) * columns + static_cast<std::size_t>(u)];
        if (kind == SampleKind::read) kind = SampleKind::unusable;
      }
  }
  return kinds;
}

std::vector<std::size_t> by_duration(const std::vector<double>& exposures_s) {
  std::vector<std::size_t> order(exposures_s.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return exposures_s[k]; });
  return order;
}

MergedPlane merge_exposures(const MergeRequest& request) {
  return Merge(request).run();
}

}  // namespace gonio::photograph
