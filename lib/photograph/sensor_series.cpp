// See sensor_series.h.
#include "photograph/sensor_series.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <opencv2/core.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "photograph/polarizers.h"
#include "photograph/raw_views.h"

namespace gonio::photograph {
namespace {

constexpr int least_tile = 5;  // samples across: a polynomial of second order has to leave some freedom

// One colour's samples of a frame: every `period`-th from (x0, y0).
struct Grid {
  int x0 = 0, y0 = 0, period = 1, width = 0, height = 0;
  std::size_t at(int x, int y, int frame_width) const {
    return static_cast<std::size_t>(y0 + y * period) * static_cast<std::size_t>(frame_width) +
           static_cast<std::size_t>(x0 + x * period);
  }
};

struct Window {
  int x = 0, y = 0, width = 0, height = 0;
};
Window tile(const Grid& g, std::size_t k) {
  const int i = static_cast<int>(k) % tiles_across, j = static_cast<int>(k) / tiles_across;
  const auto edge = [](int n, int of) { return n * of / tiles_across; };
  return {edge(i, g.width), edge(j, g.height), edge(i + 1, g.width) - edge(i, g.width),
          edge(j + 1, g.height) - edge(j, g.height)};
}

// Values of 1, x and x^2, orthogonal over 0 .. n - 1.
double orthogonal(int order, int x, int n) {
  const double u = x - (n - 1) / 2.0;
  return order == 0 ? 1 : order == 1 ? u : u * u - (static_cast<double>(n) * n - 1) / 12;
}
constexpr std::array<std::array<int, 2>, 6> orders{{{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}}};

// What is left of values in the window beside a polynomial of second order. On a full grid products of orthogonal
// polynomials are orthogonal, so that no system has to be solved.
std::vector<double> without_trend(const std::vector<double>& values, int stride, const Window& w) {
  std::vector<double> left;
  for (int y = 0; y < w.height; ++y)
    for (int x = 0; x < w.width; ++x)
      left.push_back(values[static_cast<std::size_t>(w.y + y) * static_cast<std::size_t>(stride) +
                            static_cast<std::size_t>(w.x + x)]);
  for (const auto& [p, q] : orders) {
    double product = 0, square = 0;
    const auto each = [&, p = p, q = q](const auto& body) {
      std::size_t i = 0;
      for (int y = 0; y < w.height; ++y)
        for (int x = 0; x < w.width; ++x) body(left[i++], orthogonal(p, x, w.width) * orthogonal(q, y, w.height));
    };
    each([&](double v, double b) { product += v * b, square += b * b; });
    each([&](double& v, double b) { v -= product / square * b; });
  }
  return left;
}

// Of m without its trend.
Spectrum mean_power(const cv::Mat& rows) {
  cv::Mat transformed;
  cv::dft(rows, transformed, cv::DFT_ROWS | cv::DFT_COMPLEX_OUTPUT);
  Spectrum power(static_cast<std::size_t>(rows.cols / 2));
  for (int y = 0; y < rows.rows; ++y)
    for (std::size_t k = 0; k < power.size(); ++k) {
      const auto v = transformed.at<cv::Vec2d>(y, static_cast<int>(k) + 1);
      power[k] += (v[0] * v[0] + v[1] * v[1]) / rows.cols / rows.rows;
    }
  return power;
}

// Frames of one exposure and one colour.
class Level {
 public:
  explicit Level(const Grid& grid) : g_(grid) {
    const std::size_t n = static_cast<std::size_t>(g_.width) * static_cast<std::size_t>(g_.height);
    sum_.resize(n), squares_.resize(n);
  }

  void add(const RawFrame& frame) {
    std::array<double, tiles_across * tiles_across> means{};
    std::array<double, tiles_across * tiles_across> full{}, lowest{};
    parallel_for(0, means.size(), [&](std::size_t k) {
      const Window w = tile(g_, k);
      for (int y = w.y; y < w.y + w.height; ++y)
        for (int x = w.x; x < w.x + w.width; ++x) {
          const float v = frame.codes[g_.at(x, y, frame.width)];
          const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(g_.width) + static_cast<std::size_t>(x);
          sum_[i] += v, squares_[i] += static_cast<double>(v) * v, means[k] += v;
          full[k] += v >= frame.full_scale, lowest[k] += v <= frame.floor + 0.25;
        }
      means[k] /= w.width * w.height;
    });
    means_.push_back(means);
    full_ += std::accumulate(full.begin(), full.end(), 0.0);
    lowest_ += std::accumulate(lowest.begin(), lowest.end(), 0.0);
  }

  SeriesLevel reduced(const SeriesFrame& first) {
    SeriesLevel level{.exposure_s = first.exposure_s, .frames = means_.size(), .name = first.name};
    const auto frames = static_cast<double>(means_.size()), all = frames * static_cast<double>(sum_.size());
    level.share_full = full_ / all, level.share_lowest = lowest_ / all;
    std::vector<double> m(sum_.size());
    std::ranges::transform(sum_, m.begin(), [&](double s) { return s / frames; });
    parallel_for(0, level.tiles.size(), [&](std::size_t k) { level.tiles[k] = tile_sums(k, m); });
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const auto& means : means_) {
      const double mean = std::accumulate(means.begin(), means.end(), 0.0);
      least = std::min(least, mean), most = std::max(most, mean);
    }
    level.drift = (most - least) / static_cast<double>(level.tiles.size());
    std::vector<double> left = without_trend(m, g_.width, {0, 0, g_.width, g_.height});
    const cv::Mat picture(g_.height, g_.width, CV_64F, left.data());
    level.rows = mean_power(picture), level.columns = mean_power(picture.t());
    return level;
  }

 private:
  TileSums tile_sums(std::size_t k, const std::vector<double>& m) const {
    const Window w = tile(g_, k);
    const auto frames = static_cast<double>(means_.size());
    TileSums t;
    t.samples = static_cast<double>(w.width) * w.height;
    for (int y = w.y; y < w.y + w.height; ++y)
      for (int x = w.x; x < w.x + w.width; ++x) {
        const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(g_.width) + static_cast<std::size_t>(x);
        t.sum += m[i], t.squares += m[i] * m[i];
        t.temporal += std::max(0.0, squares_[i] - frames * m[i] * m[i]);
      }
    for (const auto& means : means_) t.temporal -= t.samples * std::pow(means[k] - t.sum / t.samples, 2);
    t.temporal = std::max(0.0, t.temporal), t.temporal_freedom = (t.samples - 1) * (frames - 1);
    for (const double v : without_trend(m, g_.width, w)) t.structure += v * v;
    t.structure_freedom = t.samples - static_cast<double>(orders.size());
    return t;
  }

  Grid g_;
  std::vector<double> sum_, squares_;
  std::vector<std::array<double, tiles_across * tiles_across>> means_;  // of each frame
  double full_ = 0, lowest_ = 0;
};

// Codes of a sensor of fewer bits than its file are often shifted: what they have in common.
void narrow_step(const RawFrame& frame, const Grid& g, double& step, double& first) {
  if (std::isinf(frame.floor)) return;  // numbers, not codes
  if (std::isnan(first)) first = frame.codes[g.at(0, 0, frame.width)];
  auto common = std::llround(step);
  for (int y = 0; y < g.height && common != 1; ++y)
    for (int x = 0; x < g.width && common != 1; ++x)
      common = std::gcd(common, std::llround(frame.codes[g.at(x, y, frame.width)] - first));
  step = static_cast<double>(common);
}

class Summing {
 public:
  explicit Summing(const SensorSeries& series) : s_(series), order_(series.frames.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::ranges::stable_sort(order_, {},
                             [&](std::size_t k) { return std::pair(s_.frames[k].dark, s_.frames[k].exposure_s); });
  }

  SeriesSums run() {
    for (std::size_t k = 0; k < order_.size();) {
      std::size_t end = k + 1;
      while (end < order_.size() && same(order_[k], order_[end])) ++end;
      const SeriesFrame& first = s_.frames[order_[k]];
      if (end - k < 2)
        throw Error(Exit::data, first.name,
                    format("is the only %s frame of %g s", first.dark ? "dark" : "lit", first.exposure_s),
                    "noise needs two frames or more of each exposure");
      sum_level(k, end);
      k = end;
    }
    for (std::size_t p = 0; p < grids_.size(); ++p) sums_.planes[p].step = steps_[p];
    return std::move(sums_);
  }

 private:
  bool same(std::size_t a, std::size_t b) const {
    const SeriesFrame &f = s_.frames[a], &g = s_.frames[b];
    return f.dark == g.dark && std::abs(f.exposure_s - g.exposure_s) <= 1e-4 * f.exposure_s;
  }

  void sum_level(std::size_t begin, std::size_t end) {
    std::vector<Level> levels;
    for (std::size_t k = begin; k < end; ++k) {
      throw_if_interrupted();
      const RawFrame frame = s_.read(order_[k]);
      if (grids_.empty()) begin_with(frame, s_.frames[order_[k]].name);
      check(frame, s_.frames[order_[k]].name);
      for (std::size_t p = 0; p < grids_.size(); ++p) {
        if (levels.size() == p) levels.emplace_back(grids_[p]);
        levels[p].add(frame);
        narrow_step(frame, grids_[p], steps_[p], firsts_[p]);
        sums_.planes[p].full_scale = std::min(sums_.planes[p].full_scale, frame.full_scale);
      }
    }
    const SeriesFrame& first = s_.frames[order_[begin]];
    for (std::size_t p = 0; p < grids_.size(); ++p)
      (first.dark ? sums_.planes[p].dark : sums_.planes[p].lit).push_back(levels[p].reduced(first));
  }

  void begin_with(const RawFrame& frame, const std::string& name) {
    mosaic_ = frame.mosaic;
    sums_.width = frame.width, sums_.height = frame.height, sums_.full_code = frame.full_code;
    const int period = mosaic_.period_px();
    for (int y = 0; y < period; ++y)
      for (int x = 0; x < period; ++x) {
        grids_.push_back(
            {x, y, period, (frame.width - x + period - 1) / period, (frame.height - y + period - 1) / period});
        std::string colour = mosaic_.mono()         ? "Y"
                             : mosaic_.polarizers() ? std::to_string(polarizer_degrees(x, y)) + " degrees"
                                                    : std::string(1, "RGB"[mosaic_.colour(x, y)]);
        if (colour == "G") colour += mosaic_.colour(x ^ 1, y) == 0 ? "1" : "2";
        sums_.planes.push_back({colour, {}, {}, 0, std::numeric_limits<double>::infinity()});
      }
    steps_.assign(grids_.size(), 0), firsts_.assign(grids_.size(), std::numeric_limits<double>::quiet_NaN());
    if (std::min(grids_.back().width, grids_.back().height) < least_tile * tiles_across)
      throw Error(Exit::data, name,
                  format("has %d x %d samples of a colour", grids_.back().width, grids_.back().height),
                  format("%d each way are the least", least_tile * tiles_across));
  }

  void check(const RawFrame& frame, const std::string& name) const {
    if (frame.width != sums_.width || frame.height != sums_.height)
      throw Error(
          Exit::data, name,
          format("has %d x %d samples, the first frame %d x %d", frame.width, frame.height, sums_.width, sums_.height),
          "frames of a series come from one camera");
    if (!(frame.mosaic == mosaic_))
      throw Error(Exit::data, name, "has another mosaic than the first frame", "state --mosaic");
    if (frame.full_code != sums_.full_code)
      throw Error(Exit::data, name, format("has codes to %g, the first frame to %g", frame.full_code, sums_.full_code),
                  "frames of a series have the same number of bits");
    if (!std::ranges::all_of(frame.codes, [](float v) { return std::isfinite(v); }))
      throw Error(Exit::data, name, "has samples that are no finite numbers", "leave the frame out");
    const auto beyond = std::ranges::count_if(frame.codes, [&](float v) { return v > 1.02 * frame.full_scale + 1; });
    if (static_cast<double>(beyond) > 0.01 * static_cast<double>(frame.codes.size()))
      throw Error(Exit::data, name,
                  format("has %.3g %% of its samples beyond full scale, up to code %g above black",
                         100.0 * static_cast<double>(beyond) / static_cast<double>(frame.codes.size()),
                         static_cast<double>(std::ranges::max(frame.codes))),
                  "state --full-scale in the file's own codes: a sensor of 12 bits may be stored shifted");
  }

  const SensorSeries& s_;
  std::vector<std::size_t> order_;
  Mosaic mosaic_;
  std::vector<Grid> grids_;
  std::vector<double> steps_, firsts_;
  SeriesSums sums_;
};

// By the name, else by the file.
double exposure_of(const std::filesystem::path& path, const RawStated& stated) {
  if (const auto named = exposure_in_name(path.stem().string())) return named->exposure_s;
  const RawFrame frame = read_raw_frame(path, stated);
  if (!frame.exposure_s)
    throw Error(Exit::data, path.string(), "does not say how long it was exposed",
                "state exposure_s, or write it into the name: flat_20ms_1.png");
  return *frame.exposure_s;
}

}  // namespace

SensorSeries series_of_files(const std::vector<std::filesystem::path>& lit,
                             const std::vector<std::filesystem::path>& dark,
                             const std::vector<std::optional<double>>& exposures_s, const RawStated& stated) {
  SensorSeries series;
  std::vector<std::filesystem::path> paths = lit;
  paths.insert(paths.end(), dark.begin(), dark.end());
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const double exposure_s = exposures_s.empty() || !exposures_s[k] ? exposure_of(paths[k], stated) : *exposures_s[k];
    if (!(exposure_s > 0))
      throw Error(Exit::data, paths[k].string(), format("is said to be exposed for %g s", exposure_s),
                  "state exposure_s in seconds");
    series.frames.push_back({paths[k].string(), k >= lit.size(), exposure_s});
  }
  series.read = [paths, stated](std::size_t k) {
    RawFrame frame = read_raw_frame(paths[k], stated);
    if (stated.white && *stated.white > frame.full_code && !std::isinf(frame.floor))
      throw Error(Exit::data, paths[k].string(),
                  format("has codes to %g, and the sensor is said to be full at %g", frame.full_code, *stated.white),
                  "state --full-scale in the file's own codes");
    return frame;
  };
  return series;
}

SeriesSums sum_series(const SensorSeries& series) {
  return Summing(series).run();
}

}  // namespace gonio::photograph
