// See patch_readings.h.
#include "colour/patch_readings.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "geom/mat3_inverse.h"
#include "linear/geom_matrices.h"
#include "linear/qr.h"
#include "stats/intervals.h"

namespace gonio::colour {
namespace {

constexpr double inner = 0.6, far = 4, most_clipped = 0.01, most_masked = 0.4;
constexpr int cells = 4;
constexpr std::size_t least_pixels = 16;

struct Pixel {
  Rgb rgb;
  int cell = 0;
  PixelState state = PixelState::good;
};

// Pixels whose centre lies in the inner part.
std::vector<Pixel> pixels_of(const io::Image& picture, std::span<const PixelState> states, const ChartPose& pose,
                             const Patch& patch, const std::string& place) {
  const auto outline = outline_of(pose, patch, inner);
  double left = HUGE_VAL, right = -HUGE_VAL, top = HUGE_VAL, bottom = -HUGE_VAL;
  for (const Vec2 p : outline) {
    left = std::min(left, p.x), right = std::max(right, p.x);
    top = std::min(top, p.y), bottom = std::max(bottom, p.y);
  }
  if (!(left >= 0 && top >= 0 && right <= picture.width - 1 && bottom <= picture.height - 1))
    throw Error(Exit::data, place,
                format("patch %s reaches out of the picture (%.0f, %.0f to %.0f, %.0f px of %d x %d)",
                       patch.name.c_str(), left, top, right, bottom, picture.width, picture.height),
                "show the whole chart");
  const Mat3 chart_from_image = inverse(pose.image_from_chart);
  std::vector<Pixel> found;
  for (int y = static_cast<int>(top); y <= static_cast<int>(bottom) + 1 && y < picture.height; ++y)
    for (int x = static_cast<int>(left); x <= static_cast<int>(right) + 1 && x < picture.width; ++x) {
      const Vec3 h = chart_from_image * Vec3{static_cast<double>(x), static_cast<double>(y), 1};
      const double u = ((h.x / h.z - patch.centre.x) / (patch.size.x * inner) + 0.5) * cells,
                   v = ((h.y / h.z - patch.centre.y) / (patch.size.y * inner) + 0.5) * cells;
      if (!(u >= 0 && v >= 0 && u < cells && v < cells)) continue;
      const auto at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x);
      found.push_back({{picture.at(x, y, 0), picture.at(x, y, 1), picture.at(x, y, 2)},
                       static_cast<int>(v) * cells + static_cast<int>(u),
                       states.empty() ? PixelState::good : states[at]});
    }
  if (found.size() < least_pixels)
    throw Error(Exit::data, place,
                format("patch %s shows %zu pixels, limit %zu", patch.name.c_str(), found.size(), least_pixels),
                "photograph the chart from nearer");
  return found;
}

// Means without pixels that stand far out, and those of cells.
void average(const std::vector<Pixel>& pixels, PatchReading& reading) {
  Rgb middle, width;
  std::array<std::vector<double>, 3> values;
  for (const Pixel& p : pixels)
    for (int c = 0; c < 3; ++c) values[static_cast<std::size_t>(c)].push_back(p.rgb[c]);
  std::array<double, 3> m{}, s{};
  for (std::size_t c = 0; c < 3; ++c) m[c] = stats::median(values[c]), s[c] = far * stats::robust_sigma(values[c]);
  middle = {m[0], m[1], m[2]}, width = {s[0], s[1], s[2]};
  std::array<Rgb, cells * cells> sum{};
  std::array<double, cells * cells> count{};
  Rgb all;
  for (const Pixel& p : pixels) {
    const Rgb off = p.rgb - middle;
    // Where most pixels are equal to the last digit sigma is zero, and nothing stands out.
    const auto stands_out = [](double d, double w) { return w > 0 && std::abs(d) > w; };
    if (stands_out(off.x, width.x) || stands_out(off.y, width.y) || stands_out(off.z, width.z)) continue;
    const auto cell = static_cast<std::size_t>(p.cell);
    sum[cell] += p.rgb, ++count[cell], all += p.rgb, ++reading.pixels;
  }
  reading.rgb = all / static_cast<double>(reading.pixels);
  std::vector<std::size_t> used;
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (count[k] > 0) used.push_back(k);
  const auto rows = static_cast<Eigen::Index>(used.size());
  if (rows < 6) return;
  Eigen::MatrixXd plane(rows, 3), means(rows, 3);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const std::size_t k = used[static_cast<std::size_t>(i)];
    plane.row(i) << 1, static_cast<double>(k % cells), static_cast<double>(k / cells);
    means.row(i) = linear::as_eigen(sum[k] / count[k]).transpose();
  }
  const Eigen::MatrixXd rest = means - plane * linear::PivotedQr(plane).solve(means);
  reading.covariance = linear::mat3_of(rest.transpose() * rest / static_cast<double>((rows - 3) * rows));
}

PatchReading reading_of(const std::vector<Pixel>& pixels) {
  PatchReading reading{{}, {{0, 0, 0, 0, 0, 0, 0, 0, 0}}, 0, {}};
  std::vector<Pixel> good;
  double clipped = 0, masked = 0;
  for (const Pixel& p : pixels) {
    if (p.state == PixelState::clipped)
      ++clipped;
    else if (p.state == PixelState::masked)
      ++masked;
    else if (!is_finite(p.rgb))
      reading.left_out = "not-finite";
    else
      good.push_back(p);
  }
  const auto count = static_cast<double>(pixels.size());
  if (!reading.left_out.empty()) return reading;
  if (clipped > most_clipped * count)
    reading.left_out = "clipped";
  else if (masked > most_masked * count)
    reading.left_out = "masked";
  else
    average(good, reading);
  return reading;
}

}  // namespace

std::vector<PatchReading> read_patches(const io::Image& picture, std::span<const PixelState> states,
                                       const ChartPose& pose, const Chart& chart, const std::string& place) {
  std::vector<PatchReading> readings;
  for (const Patch& patch : chart.patches)
    readings.push_back(reading_of(pixels_of(picture, states, pose, patch, place)));
  return readings;
}

}  // namespace gonio::colour
