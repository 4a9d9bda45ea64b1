// See error_intervals.h.
#include "nrsfm/evaluate/error_intervals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/random.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::nrsfm {
namespace {

constexpr double fewest_blocks = 3, most_blocks = 8;  // blocks: degrees of freedom of the variance, and one
constexpr double memories = 6;                        // of correlation in a block, where that leaves enough of them
constexpr std::size_t fewest_frames = 10;

struct Distance {
  double d = 0;
  std::size_t frame = 0;
};

// What the measures need of a frame, so that a draw of frames is a weighted sum.
struct Frame {
  double points = 0, distance = 0, square = 0, truth_square = 0;
  double sigma = 0, axes = 0;  // sum of the axes' population standard deviations of the truth
};

struct Frames {
  std::vector<Frame> each;
  std::vector<Distance> sorted;  // ascending; where the measure needs their order
};

bool is_robust(Measure m) {
  return m == Measure::robust_rms || m == Measure::robust_printed;
}

double population_sigma(const Eigen::RowVectorXd& v) {
  double n = 0, mean = 0, square = 0;
  for (const double a : v)
    if (std::isfinite(a)) n += 1, mean += a;
  mean /= n;
  for (const double a : v)
    if (std::isfinite(a)) square += (a - mean) * (a - mean);
  return n > 0 ? std::sqrt(square / n) : std::numeric_limits<double>::quiet_NaN();
}

Frames frames_of(const Aligned& a, Measure measure) {
  Frames out;
  const bool order = is_robust(measure);
  for (Eigen::Index f = 0; f < a.shapes.rows() / 3; ++f) {
    Frame frame;
    const auto x = shape_of(a.shapes, f), q = shape_of(a.truth, f);
    for (Eigen::Index p = 0; p < x.cols(); ++p) {
      const double square = (x.col(p) - q.col(p)).squaredNorm(), d = std::sqrt(square);
      if (!std::isfinite(d)) continue;
      frame.points += 1, frame.distance += d, frame.square += square, frame.truth_square += q.col(p).squaredNorm();
      if (order) out.sorted.push_back({d, static_cast<std::size_t>(f)});
    }
    for (int i = 0; i < 3; ++i)
      if (const double sigma = population_sigma(q.row(i)); std::isfinite(sigma)) frame.sigma += sigma, frame.axes += 1;
    out.each.push_back(frame);
  }
  std::ranges::sort(out.sorted, {}, &Distance::d);
  return out;
}

// Frame f counts weight[f] times.
double robust(const Frames& frames, const std::vector<double>& weight, bool printed) {
  double total = 0;
  for (std::size_t f = 0; f < weight.size(); ++f) total += weight[f] * frames.each[f].points;
  const double rank[2] = {0.25 * (total - 1), 0.75 * (total - 1)};
  double quartile[2] = {0, 0}, passed = 0;
  int k = 0;
  for (std::size_t i = 0; i < frames.sorted.size() && k < 2; ++i) {
    passed += weight[frames.sorted[i].frame];
    while (k < 2 && passed > rank[k]) {
      // Linear to the next value where the rank lies between two.
      const double between = rank[k] - (passed - 1);
      const double next = i + 1 < frames.sorted.size() ? frames.sorted[i + 1].d : frames.sorted[i].d;
      quartile[k] = frames.sorted[i].d + (between > 0 ? between * (next - frames.sorted[i].d) : 0);
      ++k;
    }
  }
  const double whisker = 2.5 * quartile[1] - 1.5 * quartile[0];
  double sum = 0;
  for (const Distance& d : frames.sorted) {
    const double t = std::min(d.d, whisker);
    sum += weight[d.frame] * (printed ? t : t * t);
  }
  return std::sqrt(sum / total);
}

double value_of(const Frames& frames, const std::vector<double>& weight, Measure measure) {
  if (is_robust(measure)) return robust(frames, weight, measure == Measure::robust_printed);
  Frame sum;
  double ratios = 0, counted = 0;
  for (std::size_t f = 0; f < weight.size(); ++f) {
    const Frame& a = frames.each[f];
    const double w = weight[f];
    sum.points += w * a.points, sum.distance += w * a.distance, sum.square += w * a.square;
    sum.sigma += w * a.sigma, sum.axes += w * a.axes;
    if (a.points > 0) ratios += w * std::sqrt(a.square / a.truth_square), counted += w;
  }
  switch (measure) {
    case Measure::e3d: return sum.distance / sum.points / (sum.sigma / sum.axes);
    case Measure::nrmse: return ratios / counted;
    case Measure::rms: return std::sqrt(sum.square / sum.points);
    default: return sum.distance / sum.points;
  }
}

// Frames over which errors are correlated; of their logarithms, whose sizes are less uneven.
double memory_of(const Frames& frames) {
  std::vector<double> errors;
  for (const Frame& f : frames.each)
    if (f.points > 0 && f.square > 0) errors.push_back(0.5 * std::log(f.square / f.points));
  return std::max(1.0, correlated_frames(errors));
}

Eigen::Index block_of(double memory, std::size_t frames, Eigen::Index given) {
  const double n = static_cast<double>(frames);
  if (given > 0) return std::min<Eigen::Index>(given, static_cast<Eigen::Index>(frames));
  return static_cast<Eigen::Index>(n / std::clamp(n / (memories * memory), fewest_blocks, most_blocks));
}

}  // namespace

const std::vector<std::string>& measure_names() {
  static const std::vector<std::string> names = {"robust-rms", "robust-printed", "e3d", "nrmse",
                                                 "rms",        "mean-distance"};
  return names;
}

double correlated_frames(const std::vector<double>& errors) {
  const std::size_t n = errors.size();
  if (n < 4) return 1;
  const double centre = stats::mean(errors);
  double variance = 0, sum = 1;
  for (const double e : errors) variance += (e - centre) * (e - centre);
  if (!(variance > 0)) return 1;
  for (std::size_t lag = 1; lag < n / 2; ++lag) {
    double product = 0;
    for (std::size_t i = 0; i + lag < n; ++i) product += (errors[i] - centre) * (errors[i + lag] - centre);
    if (product <= 0) break;
    sum += 2 * product / variance;
  }
  return sum;
}

ErrorInterval error_interval(const Aligned& aligned, Measure measure, const IntervalOptions& options) {
  const Frames frames = frames_of(aligned, measure);
  const std::size_t n = frames.each.size();
  ErrorInterval out;
  out.value = value_of(frames, std::vector<double>(n, 1), measure);
  const double memory = memory_of(frames);
  out.block = block_of(memory, n, options.block);
  out.upper = std::numeric_limits<double>::infinity();
  const double blocks = static_cast<double>(n) / static_cast<double>(out.block);
  if (n < fewest_frames || blocks < fewest_blocks || options.draws < 2) return out;
  std::vector<double> draws;
  for (int k = 0; k < options.draws; ++k) {
    Random random(options.seed, static_cast<std::uint64_t>(k));
    std::vector<double> weight(n, 0);
    std::size_t left = n;
    while (left > 0) {
      const std::size_t start = random.below(static_cast<std::uint32_t>(n));
      const std::size_t length = std::min(left, static_cast<std::size_t>(out.block));
      for (std::size_t i = 0; i < length; ++i) weight[(start + i) % n] += 1;
      left -= length;
    }
    if (const double v = value_of(frames, weight, measure); std::isfinite(v)) draws.push_back(v);
  }
  const double lost = (memory * memory - 1) / (2 * memory) / static_cast<double>(out.block);
  const double kept = std::max(0.5, 1 - lost) * (1 - 1 / blocks);
  out.sigma = stats::standard_error(draws) * std::sqrt(static_cast<double>(draws.size()) / kept);
  if (!(out.value > 0)) {
    out.upper = 0;
    return out;
  }
  const double wide = stats::student_quantile(0.5 + 0.5 * options.confidence, blocks - 1) * out.sigma / out.value;
  out.lower = out.value * std::exp(-wide), out.upper = out.value * std::exp(wide);
  return out;
}

}  // namespace gonio::nrsfm
