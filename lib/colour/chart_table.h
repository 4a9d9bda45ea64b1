// A photograph's patches as a table, one row for each that counts: what color-calib writes and what the table model
// "chart" of `explain` reads (lib/explain/tables/models/chart.cpp). References are XYZ under D50, a perfect white
// having Y = 1; readings are the picture's own, over nothing; places are in widths of the chart.
#pragma once
#include <optional>
#include <span>
#include <string>

#include "colour/chart.h"
#include "colour/chart_pose.h"
#include "colour/patch_readings.h"
#include "io/image.h"
#include "manifest/sections/table.h"

namespace gonio::colour {

// Fewer patches `explain` does not take.
constexpr std::size_t fewest_chart_rows = 12;

struct ChartPicture {
  std::string image;                 // id in the manifest; may be empty
  std::optional<double> exposure_s;  // where it is known
  std::span<const Rgb> sensed{};     // of every patch, by the sensor's sensitivities (metamerism.h); may be empty
};

// Nothing where too few patches count. `picture`: the means of its three channels are those of its finite pixels.
std::optional<manifest::Table> chart_table(const Chart& chart, std::span<const PatchReading> readings,
                                           const ChartPose& pose, const io::Image& picture, const ChartPicture& of);

}  // namespace gonio::colour
