// See raw_correction.h.
#include "photograph/raw_correction.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "stats/intervals.h"

namespace gonio::photograph {
namespace {

constexpr double far_out = 8;  // robust standard deviations of dark frames' means
constexpr double next_to_nothing = 0.05;
constexpr std::size_t most_for_median = 200000;

void check_size(const RawFrame& frame, std::size_t pixels, const std::filesystem::path& path) {
  if (pixels != 0 && frame.codes.size() != pixels)
    throw Error(Exit::data, path.string(), "is of another size than the others", "frames of one sensor");
}

// Median and robust standard deviation of some of them.
struct Middle {
  double at = 0, sigma = 0;
};
Middle middle_of(const std::vector<float>& values) {
  std::vector<double> some;
  const std::size_t stride = 1 + values.size() / most_for_median;
  for (std::size_t i = 0; i < values.size(); i += stride) some.push_back(values[i]);
  return {stats::median(some), stats::robust_sigma(some)};
}

void mark(const std::vector<float>& values, std::vector<std::uint8_t>& hot) {
  const Middle m = middle_of(values);
  const double least = std::max(m.sigma, 0.5);  // codes are whole: half of one is no defect
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::abs(values[i] - m.at) > far_out * least) hot[i] = 1;
}

}  // namespace

DarkField dark_field(const std::vector<std::filesystem::path>& frames, const RawStated& stated) {
  DarkField dark;
  double sum_t = 0, sum_tt = 0;
  std::vector<double> sum_x, sum_tx;
  bool timed = true;
  for (const auto& path : frames) {
    const RawFrame frame = read_raw_frame(path, stated);
    check_size(frame, sum_x.size(), path);
    if (sum_x.empty()) sum_x.resize(frame.codes.size()), sum_tx.resize(frame.codes.size());
    const double t = frame.exposure_s.value_or(0);
    timed &= t > 0;
    sum_t += t, sum_tt += t * t, ++dark.frames;
    for (std::size_t i = 0; i < sum_x.size(); ++i) sum_x[i] += frame.codes[i], sum_tx[i] += t * frame.codes[i];
  }
  const auto n = static_cast<double>(dark.frames);
  const double spread = n * sum_tt - sum_t * sum_t;
  const bool line = timed && spread > 1e-6 * sum_t * sum_t;
  std::vector<float> longest(sum_x.size());
  dark.offset.resize(sum_x.size()), dark.rate_per_s.resize(sum_x.size()), dark.hot.assign(sum_x.size(), 0);
  for (std::size_t i = 0; i < sum_x.size(); ++i) {
    const double rate = line ? (n * sum_tx[i] - sum_t * sum_x[i]) / spread : timed ? sum_x[i] / sum_t : 0;
    dark.rate_per_s[i] = static_cast<float>(rate);
    dark.offset[i] = static_cast<float>(line ? (sum_x[i] - rate * sum_t) / n : timed ? 0 : sum_x[i] / n);
    longest[i] = static_cast<float>(sum_x[i] / n);
  }
  mark(longest, dark.hot);
  return dark;
}

void take_off(const DarkField& dark, double exposure_s, std::vector<float>& codes) {
  for (std::size_t i = 0; i < codes.size(); ++i) codes[i] -= dark.at(i, static_cast<float>(exposure_s));
}

FlatField flat_field(const std::vector<std::filesystem::path>& frames, const RawStated& stated,
                     const std::optional<DarkField>& dark) {
  FlatField flat;
  std::vector<double> sum, squares;
  Mosaic mosaic;
  std::size_t width = 0;
  for (const auto& path : frames) {
    RawFrame frame = read_raw_frame(path, stated);
    check_size(frame, sum.size(), path);
    if (sum.empty()) sum.resize(frame.codes.size()), squares.resize(frame.codes.size());
    const auto full =
        static_cast<double>(std::ranges::count_if(frame.codes, [&](float v) { return v >= frame.full_scale; }));
    if (full > 1e-3 * static_cast<double>(frame.codes.size()))
      throw Error(Exit::data, path.string(),
                  format("is at full scale in %.3g %% of its samples", 100 * full / static_cast<double>(sum.size())),
                  "expose flat frames to half of full scale");
    if (dark) {
      check_size(frame, dark->offset.size(), path);
      take_off(*dark, frame.exposure_s.value_or(0), frame.codes);
    }
    mosaic = frame.mosaic, width = static_cast<std::size_t>(frame.width);
    for (std::size_t i = 0; i < sum.size(); ++i)
      sum[i] += frame.codes[i], squares[i] += static_cast<double>(frame.codes[i]) * frame.codes[i];
  }
  std::array<double, 4> mean{}, count{};  // of each filter
  const auto colour = [&](std::size_t i) {
    return static_cast<std::size_t>(mosaic.colour(static_cast<int>(i % width), static_cast<int>(i / width)));
  };
  for (std::size_t i = 0; i < sum.size(); ++i) mean[colour(i)] += sum[i], ++count[colour(i)];
  for (std::size_t c = 0; c < mean.size(); ++c) mean[c] /= std::max(1.0, count[c]);
  const auto n = static_cast<double>(frames.size());
  flat.frames = frames.size();
  flat.factor.resize(sum.size()), flat.variance.resize(sum.size()), flat.dead.assign(sum.size(), 0);
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const double usual = mean[colour(i)];
    if (!(sum[i] > next_to_nothing * usual)) {
      flat.dead[i] = 1, flat.factor[i] = 1;
      continue;
    }
    flat.factor[i] = static_cast<float>(usual / sum[i]);
    if (n > 1) {
      const double own = std::max(0.0, (squares[i] - sum[i] * sum[i] / n) / (n - 1)) / n;
      flat.variance[i] = static_cast<float>(own / (sum[i] / n * sum[i] / n));
    }
  }
  return flat;
}

}  // namespace gonio::photograph
