// See exposure_merge.h.
#include "photograph/exposure_merge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "base/error.h"
#include "base/parallel.h"
#include "geom/angle.h"
#include "photograph/exposure_times.h"
#include "photograph/merge_sums.h"
#include "photograph/noise_variance.h"
#include "stats/distributions.h"

namespace gonio::photograph {
namespace {

constexpr int strip_rows = 16;
constexpr std::size_t pixels_at_once = 2048;  // that the nearest cache holds with all that is made of them
constexpr std::size_t rows_at_once = 16;
constexpr double moved_beyond = 5;  // standard normal: of a neighbourhood's chi-square

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
      : r_(request),
        variance_of_(request.noise),
        pixels_(static_cast<std::size_t>(request.width) * static_cast<std::size_t>(request.height)) {
    check();
    order_ = by_duration(r_.exposures_s);
    merged_.exposures_s = r_.exposures_s;
    merged_.exposures_sigma.assign(r_.exposures_s.size(), 0);
  }

  MergedPlane run() {
    if (r_.refine_exposures && order_.size() > 1) refine();
    merged_.rate.assign(pixels_, 0), merged_.variance.assign(pixels_, 0);
    merged_.trust.assign(pixels_, Trust::no_sample);
    merged_.first.assign(pixels_, 0), merged_.last.assign(pixels_, 0);
    chi_square_.assign(pixels_, 0), freedom_.assign(pixels_, 0);
    for_strips([&](const Strip& strip) {
      start(strip);
      step(strip, false), step(strip, true);
      compare(strip);
    });
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

  // Pixels from `first` to `last`, and what all exposures, by their place in the order, read from pixel `loaded_first`
  // on; where that is nothing, they are read one by one.
  struct Strip {
    std::size_t first = 0, last = 0, loaded_first = 0;
    const std::vector<Sorted>* loaded = nullptr;
    std::size_t size() const { return last - first; }
  };
  int rows_of_strips() const { return std::max(strip_rows, 4 * r_.blooming_px); }

  // Rows of one exposure. Those beside them tell where light spilled.
  Sorted read_rows(std::size_t k, int first, int last) const {
    const int above = std::max(0, first - r_.blooming_px), below = std::min(r_.height, last + r_.blooming_px);
    RawPlane plane;
    r_.read_rows(k, above, below - above, plane);
    Sorted s{{}, kinds_of(plane, r_.width, below - above, r_.full_scale, r_.blooming_px)};
    s.codes = std::move(plane.codes);
    const auto cut = [&](auto& values) {
      const auto from = static_cast<std::ptrdiff_t>(at(0, first - above));
      values.erase(values.begin(), values.begin() + from);
      values.resize(at(0, last - first));
    };
    cut(s.codes), cut(s.kinds);
    return s;
  }

  template <class Body>  // body(strip), side by side
  void for_strips(const Body& body) const {
    if (!r_.read_rows) return body(Strip{0, pixels_});
    const int rows = rows_of_strips();
    parallel_for(0, static_cast<std::size_t>((r_.height + rows - 1) / rows), [&](std::size_t n) {
      const int first = static_cast<int>(n) * rows, last = std::min(r_.height, first + rows);
      std::vector<Sorted> loaded;
      for (const std::size_t k : order_) loaded.push_back(read_rows(k, first, last));
      for (std::size_t i = at(0, first); i < at(0, last); i += pixels_at_once)
        body(Strip{i, std::min(i + pixels_at_once, at(0, last)), at(0, first), &loaded});
    });
  }

  // body(run) for each exposure, and some of the strip's pixels at a time.
  template <class Body>
  void pass(const Strip& strip, const Body& body) const {
    constexpr std::size_t chunk = 1 << 14;
    const auto some = [&](std::size_t place, const Sorted& s, std::size_t first, std::size_t last, std::size_t from) {
      const std::size_t count = last - first;
      body(ExposureRun{{&s.codes[first - from], count},
                       {&s.kinds[first - from], count},
                       first - strip.first,
                       static_cast<float>(lasts(place)),
                       static_cast<std::uint8_t>(place)});
    };
    for (std::size_t place = 0; place < order_.size(); ++place) {
      if (strip.loaded != nullptr) {
        some(place, (*strip.loaded)[place], strip.first, strip.last, strip.loaded_first);
        continue;
      }
      const Sorted s = read(order_[place]);
      parallel_for(0, (pixels_ + chunk - 1) / chunk,
                   [&](std::size_t c) { some(place, s, c * chunk, std::min(pixels_, (c + 1) * chunk), 0); });
    }
  }

  // Samples of some pixels in all exposures, for the exposures' own times.
  void refine() {
    constexpr std::size_t most = 60000;
    const std::size_t stride = std::max<std::size_t>(1, pixels_ / most) | 1;  // odd: all colours of a mosaic
    ExposureSamples samples{r_.exposures_s, {}, r_.noise, r_.full_scale, r_.floor};
    samples.codes.assign(order_.size(), std::vector<float>((pixels_ + stride - 1) / stride));
    for_strips([&](const Strip& strip) {
      pass(strip, [&](const ExposureRun& run) {
        std::vector<float>& codes = samples.codes[order_[run.place]];
        const std::size_t first = strip.first + run.begin, last = first + run.codes.size();
        for (std::size_t i = (first + stride - 1) / stride * stride; i < last; i += stride)
          codes[i / stride] =
              run.kinds[i - first] == SampleKind::read ? run.codes[i - first] : std::numeric_limits<float>::quiet_NaN();
      });
    });
    const RefinedExposures refined = refine_exposures(samples);
    merged_.exposures_s = refined.exposures_s, merged_.exposures_sigma = refined.sigma_s;
  }

  // All light over all time: the best where there is shot noise alone.
  void start(const Strip& strip) {
    LightSums sums(strip.size());
    pass(strip, [&](const ExposureRun& run) { sums.add(run, static_cast<float>(r_.full_scale)); });
    for (std::size_t n = 0, i = strip.first; n < strip.size(); ++n, ++i) {
      if (sums.time_s[n] > 0) {
        merged_.rate[i] = sums.light[n] / sums.time_s[n];
        merged_.first[i] = sums.first[n], merged_.last[i] = sums.last[n];
        merged_.trust[i] = Trust::good;
      } else {
        merged_.variance[i] = std::numeric_limits<float>::infinity();
        if (std::isfinite(sums.bound[n])) merged_.rate[i] = sums.bound[n], merged_.trust[i] = Trust::too_bright;
      }
    }
  }

  // Of a sample that is not far from full scale. Full and usable ones alone.
  Word said_near_full(SampleKind kind, double code, double t, double rate) const {
    const double variance = variance_of_(rate * t), left = r_.full_scale - rate * t, weight = t / variance,
                 sigma = std::sqrt(variance), a = -left / sigma;
    const double phi = std::exp(-0.5 * a * a) / std::sqrt(2 * pi), below = stats::normal_cdf(-a),
                 above = stats::normal_cdf(a), hazard = above > 0 ? phi / above : 0;
    return {kind == SampleKind::read ? weight * (code - rate * t) : t / sigma * hazard,
            weight * t * std::max(0.0, below + a * phi + phi * hazard)};
  }

  std::span<const float> rates_of(const Strip& strip) const { return {&merged_.rate[strip.first], strip.size()}; }

  // One step of scoring; the last one leaves the variance.
  void step(const Strip& strip, bool last) {
    ScoreSums sums(strip.size());
    const std::span<const float> rates = rates_of(strip);
    pass(strip, [&](const ExposureRun& run) {
      if (!sums.add(run, rates, variance_of_, static_cast<float>(r_.full_scale))) return;
      for (std::size_t k = 0, n = run.begin; k < run.codes.size(); ++k, ++n) {
        if (sums.near[n] == 0) continue;
        const Word word = said_near_full(run.kinds[k], run.codes[k], run.exposure_s, rates[n]);
        sums.score[n] += static_cast<float>(word.score), sums.information[n] += static_cast<float>(word.information);
      }
    });
    for (std::size_t n = 0, i = strip.first; n < strip.size(); ++n, ++i) {
      if (merged_.trust[i] != Trust::good || !(sums.information[n] > 0)) continue;
      merged_.rate[i] += sums.score[n] / sums.information[n];
      if (last) merged_.variance[i] = 1 / sums.information[n];
    }
  }

  // Chi-square of what each pixel read about its rate, of samples that are clear of full scale.
  void compare(const Strip& strip) {
    const std::span<float> chi_square{&chi_square_[strip.first], strip.size()};
    const std::span<std::uint8_t> freedom{&freedom_[strip.first], strip.size()};
    pass(strip, [&](const ExposureRun& run) {
      add_squares(run, rates_of(strip), variance_of_, static_cast<float>(r_.full_scale), chi_square, freedom);
    });
    for (std::size_t i = strip.first; i < strip.last; ++i) {
      freedom_[i] = freedom_[i] > 1 && merged_.trust[i] == Trust::good ? static_cast<std::uint8_t>(freedom_[i] - 1) : 0;
      if (freedom_[i] == 0) chi_square_[i] = 0;
    }
  }

  // The chi-square of so many degrees of freedom that is as unlikely as `moved_beyond` (Wilson & Hilferty 1931).
  static std::vector<float> limits(std::size_t most_freedom) {
    std::vector<float> of(most_freedom + 1, std::numeric_limits<float>::infinity());
    for (std::size_t f = 1; f < of.size(); ++f) {
      const double freedom = static_cast<double>(f), spread = 2 / (9 * freedom),
                   root = 1 - spread + moved_beyond * std::sqrt(spread);
      of[f] = static_cast<float>(freedom * root * root * root);
    }
    return of;
  }

  // Sums of each pixel of a row and its neighbours of the same colour, above and below; then of those beside it, too.
  struct Neighbourhoods {
    std::vector<float> chi_square;
    std::vector<std::uint16_t> freedom;
  };
  void add_neighbours(int y, Neighbourhoods& columns, Neighbourhoods& all) const {
    const auto width = static_cast<std::size_t>(r_.width), beside = static_cast<std::size_t>(r_.period_px);
    columns.chi_square.assign(width + 2 * beside, 0), columns.freedom.assign(width + 2 * beside, 0);
    for (int v = y - r_.period_px; v <= y + r_.period_px; v += r_.period_px) {
      if (v < 0 || v >= r_.height) continue;
      const float* chi = &chi_square_[at(0, v)];
      const std::uint8_t* freedom = &freedom_[at(0, v)];
      for (std::size_t x = 0; x < width; ++x) columns.chi_square[x + beside] += chi[x];
      for (std::size_t x = 0; x < width; ++x)
        columns.freedom[x + beside] = static_cast<std::uint16_t>(columns.freedom[x + beside] + freedom[x]);
    }
    all.chi_square.resize(width), all.freedom.resize(width);
    const float* chi = columns.chi_square.data();
    const std::uint16_t* freedom = columns.freedom.data();
    for (std::size_t x = 0; x < width; ++x) {
      all.chi_square[x] = chi[x] + chi[x + beside] + chi[x + 2 * beside];
      all.freedom[x] = static_cast<std::uint16_t>(freedom[x] + freedom[x + beside] + freedom[x + 2 * beside]);
    }
  }

  // Noise that was stated too small makes everything contradict itself: half of all pixels show no motion. A
  // chi-square's own median lies below its mean. From some of the pixels, of all colours of a mosaic.
  double noise_factor() const {
    constexpr std::size_t some = 300000;
    const std::size_t stride = std::max<std::size_t>(1, pixels_ / some) | 1;
    std::vector<float> ratios;
    double sum = 0;
    for (std::size_t i = 0; i < pixels_; i += stride)
      if (freedom_[i] > 0)
        ratios.push_back(chi_square_[i] / static_cast<float>(freedom_[i])), sum += static_cast<double>(freedom_[i]);
    if (ratios.empty()) return 1;
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    const double freedom = sum / static_cast<double>(ratios.size());
    return std::max(1.0, *middle * freedom / stats::chi2_quantile(0.5, freedom));
  }

  void mark_moved() {
    const std::vector<float> limit = limits(9 * order_.size());
    const auto factor = static_cast<float>(noise_factor());
    struct Row {
      std::vector<std::size_t> moved;
      double chi_square = 0, freedom = 0;  // of those that did not move
    };
    std::vector<Row> rows(static_cast<std::size_t>(r_.height));
    parallel_for(0, (rows.size() + rows_at_once - 1) / rows_at_once, [&](std::size_t some) {
      Neighbourhoods columns, all;
      for (std::size_t y = some * rows_at_once; y < std::min(rows.size(), (some + 1) * rows_at_once); ++y) {
        add_neighbours(static_cast<int>(y), columns, all);
        const std::size_t first = at(0, static_cast<int>(y));
        for (std::size_t x = 0, i = first; x < all.freedom.size(); ++x, ++i) {
          if (merged_.trust[i] != Trust::good) continue;
          if (all.chi_square[x] > factor * limit[all.freedom[x]])
            rows[y].moved.push_back(i);
          else
            rows[y].chi_square += chi_square_[i], rows[y].freedom += freedom_[i];
        }
      }
    });
    std::vector<std::size_t> moved;
    double chi_square = 0, freedom = 0;
    for (const Row& row : rows) {
      moved.insert(moved.end(), row.moved.begin(), row.moved.end());
      chi_square += row.chi_square, freedom += row.freedom;
    }
    for (const std::size_t i : moved) merged_.trust[i] = Trust::moved;
    if (freedom > 0) merged_.chi_square_per_freedom = chi_square / freedom;
    if (!moved.empty()) take_one_exposure(moved);
  }
  // What an exposure read in these pixels, which are in order.
  Sorted read_at(std::size_t k, const std::vector<std::size_t>& pixels) const {
    Sorted picked{std::vector<float>(pixels.size()), std::vector<SampleKind>(pixels.size())};
    const auto pick = [&](const Sorted& from, std::size_t first, std::size_t n) {
      picked.codes[n] = from.codes[pixels[n] - first], picked.kinds[n] = from.kinds[pixels[n] - first];
    };
    if (!r_.read_rows) {
      const Sorted all = read(k);
      for (std::size_t n = 0; n < pixels.size(); ++n) pick(all, 0, n);
      return picked;
    }
    const std::size_t strip = at(0, rows_of_strips());
    std::vector<std::size_t> starts;  // places in `pixels` where another strip begins
    for (std::size_t n = 0; n < pixels.size(); ++n)
      if (n == 0 || pixels[n] / strip != pixels[n - 1] / strip) starts.push_back(n);
    parallel_for(0, starts.size(), [&](std::size_t s) {
      const std::size_t end = s + 1 < starts.size() ? starts[s + 1] : pixels.size(),
                        first = pixels[starts[s]] / strip * strip;
      const int row = static_cast<int>(first / static_cast<std::size_t>(r_.width));
      const Sorted some = read_rows(k, row, std::min(r_.height, row + rows_of_strips()));
      for (std::size_t n = starts[s]; n < end; ++n) pick(some, first, n);
    });
    return picked;
  }

  // The exposure in which most of them are well exposed; where it is not, the one next to it.
  void take_one_exposure(const std::vector<std::size_t>& moved) {
    std::vector<double> worth(order_.size());
    for (std::size_t place = 0; place < order_.size(); ++place) {
      const Sorted s = read_at(order_[place], moved);
      for (std::size_t n = 0; n < moved.size(); ++n)
        if (s.kinds[n] == SampleKind::read)
          worth[place] += std::max(0.0f, s.codes[n]) / std::sqrt(noise_variance(r_.noise, s.codes[n]));
    }
    const auto best = std::ranges::max_element(worth) - worth.begin();
    std::vector<std::size_t> places(order_.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    std::ranges::stable_sort(places, {},
                             [&](std::size_t p) { return std::abs(static_cast<std::ptrdiff_t>(p) - best); });
    std::vector<std::size_t> left = moved;
    for (const std::size_t place : places) {
      if (left.empty()) break;
      const Sorted s = read_at(order_[place], left);
      const double t = lasts(place);
      std::vector<std::size_t> still;
      for (std::size_t n = 0; n < left.size(); ++n) {
        const std::size_t i = left[n];
        if (s.kinds[n] != SampleKind::read) {
          still.push_back(i);
          continue;
        }
        merged_.rate[i] = static_cast<float>(s.codes[n] / t);
        merged_.variance[i] = static_cast<float>(noise_variance(r_.noise, s.codes[n]) / (t * t));
        merged_.first[i] = merged_.last[i] = static_cast<std::uint8_t>(place);
      }
      left = std::move(still);
    }
  }

  const MergeRequest& r_;
  NoiseVariance variance_of_;
  std::size_t pixels_;
  std::vector<std::size_t> order_;  // by duration
  MergedPlane merged_;
  std::vector<float> chi_square_;
  std::vector<std::uint8_t> freedom_;
};

}  // namespace

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
