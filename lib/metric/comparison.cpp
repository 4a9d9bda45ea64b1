#include "metric/comparison.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

#include "metric/blocks.h"
#include "report/number_text.h"
#include "metric/ssim.h"

namespace gonio::metric {
namespace {

using report::number_text;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Everything the measures are made of, additive over blocks.
struct Sums {
  double n = 0, d = 0, d2 = 0, r2 = 0, log = 0, ssim = 0, ssim_n = 0, z2 = 0, z_n = 0, z_far = 0;
  Sums& operator+=(const Sums& o) {
    n += o.n, d += o.d, d2 += o.d2, r2 += o.r2, log += o.log, ssim += o.ssim, ssim_n += o.ssim_n;
    z2 += o.z2, z_n += o.z_n, z_far += o.z_far;
    return *this;
  }
  Sums without(const Sums& o) const {
    return {n - o.n,       d - o.d,           d2 - o.d2, r2 - o.r2,   log - o.log,
            ssim - o.ssim, ssim_n - o.ssim_n, z2 - o.z2, z_n - o.z_n, z_far - o.z_far};
  }
};

double root_mean(double squares, double n) {
  return std::sqrt(std::max(squares, 0.0) / n);
}

// Delete-one-block jackknife of a function of the sums.
std::optional<Estimate> jackknife(const std::vector<Sums>& blocks, const Sums& total,
                                  const std::function<double(const Sums&)>& f) {
  const double value = f(total);
  if (!std::isfinite(value)) return {};
  std::vector<double> left_out;
  for (const Sums& block : blocks) {
    if (block.n == 0) continue;
    const double v = f(total.without(block));
    if (std::isfinite(v)) left_out.push_back(v);
  }
  const auto count = static_cast<double>(left_out.size());
  if (count < 2) return Estimate{value, 0};
  double mean = 0, squares = 0;
  for (const double v : left_out) mean += v / count;
  for (const double v : left_out) squares += (v - mean) * (v - mean);
  return Estimate{value, std::sqrt(squares * (count - 1) / count)};
}

template <class Visit>
void for_each_pixel(const Overlay& o, const Visit& visit) {
  for (std::size_t p = 0; p < o.counts.size(); ++p)
    if (o.counts[p]) visit(p);
}

double mean_square(const Overlay& o) {
  double sum = 0, n = 0;
  const std::size_t channels = o.channels.size();
  for_each_pixel(o, [&](std::size_t p) {
    for (std::size_t i = p * channels; i < (p + 1) * channels; ++i, ++n)
      sum += double{o.photograph[i]} * o.photograph[i];
  });
  return n > 0 ? sum / n : 0;
}

double upper_end(const Overlay& o) {  // 99.9th percentile of the photograph
  std::vector<float> values;
  const std::size_t channels = o.channels.size();
  for_each_pixel(o, [&](std::size_t p) {
    for (std::size_t i = p * channels; i < (p + 1) * channels; ++i) values.push_back(o.photograph[i]);
  });
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

void add_errors(const Overlay& o, const Differences& d, double floor, const Blocks& blocks, std::vector<Sums>& sums) {
  const std::size_t channels = o.channels.size();
  for_each_pixel(o, [&](std::size_t p) {
    Sums& s = sums[blocks.of_pixel(p, o.width)];
    for (std::size_t i = p * channels; i < (p + 1) * channels; ++i) {
      const double e = d.signed_difference[i], r = o.photograph[i];
      s.n += 1;
      s.d += e;
      s.d2 += e * e;
      s.r2 += r * r;
      s.log += std::log10(std::max(std::abs(e), floor));
      if (d.z.empty() || std::isnan(d.z[i])) continue;
      s.z_n += 1;
      s.z2 += double{d.z[i]} * d.z[i];
      s.z_far += std::abs(d.z[i]) > 3;
    }
  });
}

void add_ssim(const Overlay& o, double scale, double data_range, const Blocks& blocks, std::vector<Sums>& sums) {
  const std::size_t channels = o.channels.size(), pixels = o.counts.size();
  std::vector<float> a(pixels), b(pixels);
  for (std::size_t c = 0; c < channels; ++c) {
    for (std::size_t p = 0; p < pixels; ++p) {
      a[p] = o.counts[p] ? o.photograph[p * channels + c] : 0.0f;
      b[p] = o.counts[p] ? static_cast<float>(scale * o.rendering[p * channels + c]) : 0.0f;
    }
    const auto map = ssim_map(a, b, o.counts, o.width, o.height, data_range);
    for (std::size_t p = 0; p < pixels; ++p) {
      if (std::isnan(map[p])) continue;
      Sums& s = sums[blocks.of_pixel(p, o.width)];
      s.ssim += map[p];
      s.ssim_n += 1;
    }
  }
}

}  // namespace

Differences differences(const Overlay& o, double scale) {
  Differences result;
  const std::size_t channels = o.channels.size();
  result.signed_difference.assign(o.photograph.size(), static_cast<float>(nan));
  if (o.knows_variance()) result.z = result.signed_difference;
  for_each_pixel(o, [&](std::size_t p) {
    for (std::size_t i = p * channels; i < (p + 1) * channels; ++i) {
      const double d = scale * o.rendering[i] - o.photograph[i];
      result.signed_difference[i] = static_cast<float>(d);
      if (result.z.empty() || (!o.clipped.empty() && o.clipped[p])) continue;
      const double variance = o.variance(i, scale);
      if (variance > 0) result.z[i] = static_cast<float>(d / std::sqrt(variance));
    }
  });
  return result;
}

Measures measure(const Overlay& o, const MeasureOptions& options) {
  Measures m;
  m.pixels = o.pixels;
  m.exposure_scale = options.exposure_scale;
  m.exposure_fitted = options.exposure_fitted;
  m.not_finite = o.not_finite;
  for (std::size_t p = 0; p < o.clipped.size(); ++p) m.clipped += o.counts[p] && o.clipped[p];
  const double scale = options.exposure_scale.value;
  m.photograph_rms = std::sqrt(mean_square(o));
  m.data_range = options.data_range ? *options.data_range : o.integer_codes ? 1.0 : upper_end(o);
  m.log_floor = m.photograph_rms > 0 ? 1e-4 * m.photograph_rms : 1e-12;
  if (o.not_finite.pixels > 0 || o.pixels == 0) return m;

  const Blocks blocks(o.width, o.height);
  m.block_px = blocks.side;
  std::vector<Sums> sums(blocks.count());
  add_errors(o, differences(o, scale), m.log_floor, blocks, sums);
  if (m.data_range > 0) add_ssim(o, scale, m.data_range, blocks, sums);
  Sums total;
  for (const Sums& s : sums) total += s;
  m.mean_difference = total.d / total.n;
  m.rmse = jackknife(sums, total, [](const Sums& s) { return root_mean(s.d2, s.n); });
  m.relative_rmse = jackknife(sums, total, [](const Sums& s) { return s.r2 > 0 ? root_mean(s.d2, s.r2) : nan; });
  m.log10_error = jackknife(sums, total, [](const Sums& s) { return s.log / s.n; });
  m.ssim = jackknife(sums, total, [](const Sums& s) { return s.ssim_n > 0 ? s.ssim / s.ssim_n : nan; });
  m.z_rms = jackknife(sums, total, [](const Sums& s) { return s.z_n > 0 ? root_mean(s.z2, s.z_n) : nan; });
  m.z_above_3 = jackknife(sums, total, [](const Sums& s) { return s.z_n > 0 ? s.z_far / s.z_n : nan; });
  return m;
}

std::vector<std::string> violations(const Measures& m, const Limits& limits) {
  std::vector<std::string> found;
  if (m.not_finite.pixels > 0)
    found.push_back(std::to_string(m.not_finite.pixels) + (m.not_finite.pixels == 1 ? " pixel holds" : " pixels hold") +
                    " a NaN or an infinity; the first lies at (" + std::to_string(m.not_finite.x) + ", " +
                    std::to_string(m.not_finite.y) + ") in channel " + m.not_finite.channel + " of the " +
                    (m.not_finite.in_photograph ? "photograph" : "rendering"));
  const auto hold = [&](const char* name, const std::optional<Estimate>& value, const std::optional<double>& limit,
                        bool upper) {
    if (!limit || m.not_finite.pixels > 0) return;
    if (!value) {
      found.push_back(std::string(name) + " is not defined here, and has the limit " + number_text(*limit, 4));
    } else if (upper ? !(value->value <= *limit) : !(value->value >= *limit)) {
      found.push_back(std::string(name) + " " + number_text(value->value, 4) + " is " + (upper ? "above" : "below") +
                      " the limit " + number_text(*limit, 4));
    }
  };
  hold("RMSE", m.rmse, limits.max_rmse, true);
  hold("relative RMSE", m.relative_rmse, limits.max_relative_rmse, true);
  hold("log10 error", m.log10_error, limits.max_log10_error, true);
  hold("rms z", m.z_rms, limits.max_z_rms, true);
  hold("SSIM", m.ssim, limits.min_ssim, false);
  return found;
}

}  // namespace gonio::metric
