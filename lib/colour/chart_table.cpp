// See chart_table.h.
#include "colour/chart_table.h"

#include <algorithm>
#include <cmath>

namespace gonio::colour {
namespace {

// Patches are held out in eight folds, so that all of them serve (a quarter of sixteen groups or more is kept aside,
// and the one black patch with it), and no fold has two greys of the classic chart.
constexpr std::size_t chart_folds = 8;

Rgb mean_of(const io::Image& picture) {
  Rgb sum{};
  std::size_t count = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const Rgb v{picture.at(x, y, 0), picture.at(x, y, 1), picture.at(x, y, 2)};
      if (is_finite(v)) sum += v, ++count;
    }
  return count > 0 ? sum / static_cast<double>(count) : sum;
}

}  // namespace

std::optional<manifest::Table> chart_table(const Chart& chart, std::span<const PatchReading> readings,
                                           const ChartPose& pose, const io::Image& picture, const ChartPicture& of) {
  manifest::Table table;
  table.model = "chart";
  table.columns = {{"patch", ""},    {"fold", ""},     {"picture", ""},      {"X", "1"},      {"Y", "1"},
                   {"Z", "1"},       {"x", "1"},       {"y", "1"},           {"mean_R", "1"}, {"mean_G", "1"},
                   {"mean_B", "1"},  {"R", "1"},       {"G", "1"},           {"B", "1"},      {"R_sigma", "1"},
                   {"G_sigma", "1"}, {"B_sigma", "1"}, {"image_radius", "1"}};
  if (of.exposure_s) table.columns.emplace_back("exposure_s", "s");
  for (const char* channel : {"sensed_R", "sensed_G", "sensed_B"})
    if (!of.sensed.empty()) table.columns.emplace_back(channel, "1");
  const Rgb mean = mean_of(picture);
  manifest::Value::Array rows;
  for (std::size_t p = 0; p < readings.size(); ++p) {
    if (!readings[p].left_out.empty()) continue;
    const Patch& patch = chart.patches[p];
    const Rgb v = readings[p].rgb;
    const Mat3& c = readings[p].covariance;
    const Vec2 at = pose.at(patch.centre), middle{0.5 * (picture.width - 1), 0.5 * (picture.height - 1)};
    manifest::Value::Array row = {patch.name, std::to_string(p % chart_folds + 1),
                                  of.image.empty() ? "chart" : of.image};
    for (const double number :
         {patch.xyz.x, patch.xyz.y, patch.xyz.z, patch.centre.x, patch.centre.y * chart.height_over_width, mean.x,
          mean.y, mean.z, v.x, v.y, v.z, std::sqrt(c(0, 0)), std::sqrt(c(1, 1)), std::sqrt(c(2, 2)),
          norm(at - middle) / (0.5 * picture.width)})
      row.emplace_back(number);
    if (of.exposure_s) row.emplace_back(*of.exposure_s);
    for (int channel = 0; channel < 3 && !of.sensed.empty(); ++channel) row.emplace_back(of.sensed[p][channel]);
    rows.emplace_back(std::move(row));
  }
  if (rows.size() < fewest_chart_rows) return {};
  table.rows = std::move(rows);
  table.observed = {"R", "G", "B"};
  table.sigma = {"R_sigma", "G_sigma", "B_sigma"};
  table.group = "fold", table.block = "patch";
  return table;
}

}  // namespace gonio::colour
