// See mix_ups.h: errors of every file against every prediction, and which differences between them count.
#include "metric/mix_ups.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/parallel.h"
#include "metric/blocks.h"
#include "photograph/noise_variance.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::metric {
namespace {

constexpr double floor_share = 0.05;  // c over the recording's rms
constexpr double least_own = 0.03, most_other = 0.3, most_ratio = 1.0 / 3, most_raw_ratio = 2.0 / 3;
constexpr double false_mix_ups = 1e-3;  // a set
constexpr double near_best = 1.5;       // errors within this factor of the best stand beside it
constexpr double place_ratio = 2;       // of a picture's own file, beside one that fits it
constexpr double knee = 0.3;            // of Huber's weights, while exposures are fitted
constexpr int exposure_steps = 6;
constexpr std::size_t fewest_of_label = 60, fewest_at_a_glance = 15, places_at_a_glance = 160;
constexpr double least_reference = 0.01, closed_ratio = 3, median_of_normal = 0.6745;
constexpr double hopeless = 0.7;  // of its own error, at a glance

struct Sample {
  double log_recorded = 0, predicted = 0, noise2 = 0;
  std::uint32_t label = 0, block = 0;
};

// Of one file against one prediction: mean squares, as a whole and in blocks.
struct Held {
  double square = std::numeric_limits<double>::infinity(), noise2 = 0;
  std::map<std::uint32_t, std::pair<double, double>> blocks;  // sum, count
  double above_noise() const { return std::max(0.0, square - noise2); }
};

double floor_of(const PictureOfSet& file) {
  double squares = 0, count = 0;
  for (std::size_t i = 0; i < file.recording.size(); ++i) {
    if (!file.counts[i / file.channels]) continue;
    squares += double{file.recording[i]} * double{file.recording[i]};
    count += 1;
  }
  return count > 0 ? floor_share * std::sqrt(squares / count) : 0;
}

std::vector<Sample> samples_of(const PictureOfSet& file, double floor, const PictureOfSet& shown, std::size_t step) {
  std::vector<Sample> samples;
  const Blocks blocks(file.width, file.height);
  for (std::size_t k = 0; k < shown.at.size(); k += step) {
    const std::size_t pixel = shown.at[k];
    if (!file.counts[pixel]) continue;
    for (std::size_t c = 0; c < file.channels; ++c) {
      const double v = std::max(0.0, double{file.recording[pixel * file.channels + c]});
      samples.push_back({std::log(v + floor), shown.predicted[k * file.channels + c],
                         std::min(1.0, photograph::noise_variance(file.noise, v) / ((v + floor) * (v + floor))),
                         shown.label.empty() ? 0 : shown.label[k],
                         static_cast<std::uint32_t>(blocks.of_pixel(pixel, file.width))});
    }
  }
  return samples;
}

// The factor that brings the predictions nearest to the recording on the scale of its logarithm: Gauss-Newton under
// Huber's loss. `counts(sample)`: does it take part?
template <class Counts>
double exposure(const std::vector<Sample>& samples, double floor, const Counts& counts) {
  double recorded = 0, predicted = 0;
  for (const Sample& s : samples) {
    if (!counts(s)) continue;
    recorded += std::exp(s.log_recorded) - floor;
    predicted += s.predicted;
  }
  if (!(recorded > 0) || !(predicted > 0)) return 1;
  double scale = recorded / predicted;
  for (int step = 0; step < exposure_steps; ++step) {
    double pull = 0, weight = 0;
    for (const Sample& s : samples) {
      if (!counts(s)) continue;
      const double lit = scale * std::max(0.0, s.predicted), d = s.log_recorded - std::log(lit + floor);
      const double slope = lit / (lit + floor), w = std::abs(d) > knee ? knee / std::abs(d) : 1;
      pull += w * slope * d;
      weight += w * slope * slope;
    }
    if (!(weight > 0)) break;
    scale *= std::exp(std::clamp(pull / weight, -1.0, 1.0));
  }
  return scale;
}

Held held_against(const PictureOfSet& file, double floor, const PictureOfSet& shown, std::size_t step = 1) {
  Held held;
  const std::vector<Sample> samples = samples_of(file, floor, shown, step);
  if (samples.empty() || !(floor > 0)) return held;
  std::map<std::uint32_t, std::size_t> of_label;
  for (const Sample& s : samples) ++of_label[s.label];
  const double common = exposure(samples, floor, [](const Sample&) { return true; });
  std::map<std::uint32_t, double> scale;
  for (const auto& [label, count] : of_label)
    scale[label] = count < (step > 1 ? fewest_at_a_glance : fewest_of_label)
                       ? common
                       : exposure(samples, floor, [own = label](const Sample& s) { return s.label == own; });
  double sum = 0, noise2 = 0;
  for (const Sample& s : samples) {
    const double d = s.log_recorded - std::log(scale[s.label] * std::max(0.0, s.predicted) + floor);
    const double square = std::min(1.0, d * d);
    sum += square;
    noise2 += s.noise2;
    auto& [block_sum, block_count] = held.blocks[s.block];
    block_sum += square;
    block_count += 1;
  }
  held.square = sum / static_cast<double>(samples.size());
  held.noise2 = noise2 / static_cast<double>(samples.size());
  return held;
}

bool comparable(const PictureOfSet& a, const PictureOfSet& b) {
  return a.width == b.width && a.height == b.height && a.channels == b.channels;
}

// Student's t of the fall of the squares over blocks that both predictions cover, against its quantile.
bool falls(const Held& own, const Held& other, double level) {
  double n = 0, sum = 0, squares = 0;
  for (const auto& [block, mine] : own.blocks) {
    const auto theirs = other.blocks.find(block);
    if (theirs == other.blocks.end()) continue;
    const double fall = mine.first / mine.second - theirs->second.first / theirs->second.second;
    n += 1, sum += fall, squares += fall * fall;
  }
  if (n < 3) return false;
  const double mean = sum / n, variance = std::max(0.0, (squares - n * mean * mean) / (n - 1));
  return mean > stats::student_quantile(1 - level, n - 1) * std::sqrt(variance / n);
}

struct Match {
  std::size_t shows = 0;
  double other = 0, misfit = 0;  // error; the same above the noise
};

// Predictions that the file fits far better than its own, the best first.
std::vector<Match> matches(std::span<const PictureOfSet> set, std::size_t i, const Held& own, double floor) {
  std::vector<Match> found;
  const double misfit = own.above_noise();
  if (!std::isfinite(own.square) || misfit < least_own * least_own) return found;
  const double level = false_mix_ups / (static_cast<double>(set.size()) * static_cast<double>(set.size()));
  for (std::size_t j = 0; j < set.size(); ++j) {
    if (j == i || !comparable(set[i], set[j])) continue;
    const std::size_t step = set[j].at.size() / places_at_a_glance;
    if (step > 1 && held_against(set[i], floor, set[j], step).above_noise() > hopeless * hopeless * misfit) continue;
    const Held other = held_against(set[i], floor, set[j]);
    const double left = other.above_noise();
    if (left <= most_ratio * most_ratio * misfit && other.square <= most_raw_ratio * most_raw_ratio * own.square &&
        other.square <= most_other * most_other && falls(own, other, level))
      found.push_back({j, std::sqrt(other.square), std::sqrt(left)});
  }
  std::ranges::stable_sort(found, {}, &Match::other);
  return found;
}

bool same_file(const PictureOfSet& a, const PictureOfSet& b) {
  return std::ranges::equal(a.recording, b.recording);
}

// Is the picture part of a closed exchange?
bool closed(const std::vector<const Match*>& to, std::size_t i) {
  std::size_t at = i;
  for (std::size_t steps = 0; steps < to.size() && to[at] != nullptr; ++steps) {
    at = to[at]->shows;
    if (at == i) return true;
  }
  return false;
}

// Of pictures that are nearly alike, the one whose own file is elsewhere.
std::vector<const Match*> chosen_of(const std::vector<std::vector<Match>>& all) {
  std::vector<const Match*> to(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].empty()) continue;
    to[i] = &all[i].front();
    for (const Match& m : all[i]) {
      if (m.other > near_best * all[i].front().other) break;
      if (all[m.shows].empty()) continue;
      to[i] = &m;
      break;
    }
  }
  return to;
}

// The error above the noise that is usual in this set, every file at the place that it fits.
double usual_misfit(const std::vector<Held>& own, const std::vector<const Match*>& to) {
  std::vector<double> misfits;
  for (std::size_t i = 0; i < own.size(); ++i)
    if (to[i] != nullptr || std::isfinite(own[i].square))
      misfits.push_back(to[i] != nullptr ? to[i]->misfit : std::sqrt(own[i].above_noise()));
  return misfits.empty() ? least_reference : std::max(least_reference, stats::median(misfits));
}

}  // namespace

std::vector<MixUp> mix_ups(std::span<const PictureOfSet> set) {
  const std::size_t n = set.size();
  std::vector<std::vector<Match>> all(n);
  std::vector<Held> own(n);
  parallel_for(0, n, [&](std::size_t i) {
    const double floor = floor_of(set[i]);
    own[i] = held_against(set[i], floor, set[i]);
    all[i] = matches(set, i, own[i], floor);
  });
  const std::vector<const Match*> to = chosen_of(all);
  const double usual = usual_misfit(own, to);
  const double size = std::max(2.0, static_cast<double>(n));
  const double open_ratio = stats::student_quantile(1 - false_mix_ups / (2 * size), size - 1) / median_of_normal;
  const auto error = [&](std::size_t i) { return std::sqrt(std::min(1.0, own[i].square)); };
  std::vector<MixUp> found;
  for (std::size_t i = 0; i < n; ++i) {
    if (to[i] == nullptr) continue;
    const std::size_t j = to[i]->shows;
    const double ratio = std::sqrt(own[i].above_noise()) / usual;
    if (ratio < (closed(to, i) ? closed_ratio : open_ratio) && !same_file(set[i], set[j])) continue;
    found.push_back({i, j, error(i), to[i]->other, error(j) <= place_ratio * to[i]->other + least_own});
  }
  return found;
}

}  // namespace gonio::metric
