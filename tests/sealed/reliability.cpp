#include "sealed/reliability.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "base/text.h"
#include "stats/intervals.h"

namespace gonio::sealed {
namespace {

constexpr std::size_t columns_by_chance = 1000;

double share_right(const ReliabilityBin& bin) {
  return static_cast<double>(bin.right) / bin.asked;
}
std::string words_of(const Reliability& r) {
  return format(
      "Expected calibration error %.3f over %d cases (to reach: <= 0.05; true statements alone: %.3f on average, above "
      "%.3f once in twenty).",
      r.error, r.asked, r.error_by_chance, r.error_by_chance_95);
}

Reliability binned(const std::vector<Stated>& stated, int bins) {
  Reliability result;
  std::vector<ReliabilityBin> all(static_cast<std::size_t>(bins));
  for (std::size_t b = 0; b < all.size(); ++b)
    all[b].lower = static_cast<double>(b) / bins, all[b].upper = static_cast<double>(b + 1) / bins;
  for (const Stated& s : stated) {
    const double p = std::clamp(s.probability, 0.0, 1.0);
    ReliabilityBin& bin = all[std::min(static_cast<std::size_t>(p * bins), all.size() - 1)];
    ++bin.asked;
    bin.right += s.right;
    bin.mean += p;
  }
  for (ReliabilityBin& bin : all) {
    if (bin.asked == 0) continue;
    bin.mean /= bin.asked;
    result.asked += bin.asked;
    result.error += std::abs(bin.right - bin.mean * bin.asked);
    result.bins.push_back(bin);
  }
  if (result.asked > 0) result.error /= result.asked;
  return result;
}

}  // namespace

Reliability reliability_of(const std::vector<Stated>& stated, int bins) {
  Reliability result = binned(stated, bins);
  Random random(20261127, 0);
  std::vector<double> errors(columns_by_chance);
  std::vector<Stated> drawn = stated;
  for (double& error : errors) {
    for (Stated& s : drawn) s.right = random.uniform() < std::clamp(s.probability, 0.0, 1.0);
    error = binned(drawn, bins).error;
  }
  result.error_by_chance = stats::mean(errors);
  result.error_by_chance_95 = stats::quantile(errors, 0.95);
  return result;
}

report::Plot reliability_plot(const Reliability& r) {
  report::Plot plot;
  plot.title = "Stated probability against how often it was right";
  plot.caption = words_of(r) + " Bars: exact 95 % intervals. On the line, what is stated is what happens.";
  plot.x_label = "stated probability";
  plot.y_label = "share right";
  plot.x_range = plot.y_range = {0, 1};
  plot.series.push_back({.kind = report::Series::Kind::line, .name = "as stated", .x = {0, 1}, .y = {0, 1}});
  report::Series points{.kind = report::Series::Kind::points, .name = "measured"};
  for (const ReliabilityBin& bin : r.bins) {
    points.x.push_back(bin.mean);
    points.y.push_back(share_right(bin));
    const stats::Interval i = stats::share_interval(bin.right, bin.asked);
    plot.series.push_back(
        {.kind = report::Series::Kind::line, .x = {bin.mean, bin.mean}, .y = {i.lower, i.upper}, .style = 1});
  }
  points.style = 1;
  plot.series.push_back(points);
  return plot;
}

report::TableText reliability_table(const Reliability& r) {
  report::TableText table;
  table.caption = words_of(r);
  table.columns = {{"stated", "", false}, {"mean", "", true}, {"right", "", true}, {"share, 95 %", "", false}};
  for (const ReliabilityBin& bin : r.bins) {
    const stats::Interval i = stats::share_interval(bin.right, bin.asked);
    table.rows.push_back({format("%.1f to %.1f", bin.lower, bin.upper), format("%.3f", bin.mean),
                          format("%d/%d", bin.right, bin.asked),
                          format("%.2f (%.2f to %.2f)", share_right(bin), i.lower, i.upper)});
  }
  return table;
}

std::string reliability_text(const Reliability& r) {
  std::string text = "\nhow sure: " + words_of(r) + "\n";
  for (const std::vector<std::string>& row : reliability_table(r).rows)
    text +=
        format("  stated %s, mean %s: right %s, %s\n", row[0].c_str(), row[1].c_str(), row[2].c_str(), row[3].c_str());
  return text;
}

}  // namespace gonio::sealed
