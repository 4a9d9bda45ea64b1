// Box plots and interaction plots with named levels, as SVG that the page's style colours: a row for each level, errors
// to the right. Boxes as Tukey's: quartiles (linear between order statistics), median, whiskers to the farthest results
// within 1.5 times the box, circles beyond.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "nrsfm/evaluate/analysis.h"
#include "report/page.h"
#include "report/plot.h"
#include "stats/intervals.h"

namespace gonio::nrsfm {
namespace {

constexpr double width = 560, right = 16, top = 8, row_height = 24, bottom = 44;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

class Drawing {
 public:
  Drawing(const std::vector<std::string>& rows, double lower, double upper) : rows_(rows) {
    std::size_t longest = 0;
    for (const std::string& r : rows) longest = std::max(longest, r.size());
    left_ = std::clamp(16 + 6.6 * static_cast<double>(longest), 60.0, 240.0);
    const double pad = upper > lower ? 0.03 * (upper - lower) : std::max(0.5, 0.1 * std::abs(upper));
    lower_ = lower - pad;
    upper_ = upper + pad;
  }
  double x(double v) const { return left_ + (v - lower_) / (upper_ - lower_) * (width - right - left_); }
  double y(std::size_t row) const { return top + row_height * (static_cast<double>(row) + 0.5); }
  double floor() const { return top + row_height * static_cast<double>(rows_.size()); }

  std::string svg(const std::string& content, const std::string& axis) const {
    std::string grid, labels;
    for (const double tick : report::tick_positions(lower_, upper_, 6)) {
      grid += format("M%.2f %.0fV%.2f", x(tick), top, floor());
      labels += format("<text x=\"%.2f\" y=\"%.2f\" text-anchor=\"middle\">%g</text>", x(tick), floor() + 18, tick);
    }
    for (std::size_t r = 0; r < rows_.size(); ++r)
      labels += format("<text x=\"%.2f\" y=\"%.2f\" text-anchor=\"end\">", left_ - 8, y(r) + 4) +
                report::escape(rows_[r]) + "</text>";
    labels += format("<text x=\"%.0f\" y=\"%.2f\" text-anchor=\"end\">", width - right, floor() + 37) +
              report::escape(axis) + "</text>";
    return format("<svg viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" role=\"img\">", width, floor() + bottom, width) +
           "<path class=\"grid\" d=\"" + grid + "\"/>" +
           format("<path class=\"axis\" d=\"M%.2f %.2fH%.0f\"/>", left_, floor(), width - right) + labels + content +
           "</svg>";
  }

 private:
  std::vector<std::string> rows_;
  double left_ = 0, lower_ = 0, upper_ = 1;
};

std::string box(const Drawing& d, std::size_t row, std::vector<double> v) {
  std::sort(v.begin(), v.end());
  const double first = stats::quantile(v, 0.25), median = stats::quantile(v, 0.5), third = stats::quantile(v, 0.75);
  const double reach = 1.5 * (third - first), y = d.y(row), half = 0.32 * row_height;
  double low = first, high = third;
  std::string outside;
  for (const double e : v) {
    if (e < first - reach || e > third + reach) {
      outside += format("<circle cx=\"%.2f\" cy=\"%.2f\" r=\"2\"/>", d.x(e), y);
    } else {
      low = std::min(low, e);
      high = std::max(high, e);
    }
  }
  const double x1 = d.x(first), x3 = d.x(third);
  const std::string body = format("M%.2f %.2fH%.2fV%.2fH%.2fz", x1, y - half, x3, y + half, x1);
  return "<path class=\"band c0\" d=\"" + body + "\"/><path class=\"error c0\" d=\"" + body +
         format("M%.2f %.2fV%.2fM%.2f %.2fH%.2fM%.2f %.2fH%.2f", d.x(median), y - half, y + half, x1, y, d.x(low), x3,
                y, d.x(high)) +
         "\"/><g class=\"c0\" stroke=\"none\">" + outside + "</g>";
}

}  // namespace

std::string box_plot(const stats::Design& design, int factor, const std::string& axis) {
  const stats::Factor& f = design.factors[at(factor)];
  struct Group {
    std::string name;
    std::vector<double> errors;
  };
  std::vector<Group> groups;
  for (const std::string& level : f.levels) groups.push_back({level, {}});
  for (std::size_t i = 0; i < design.y.size(); ++i)
    groups[at(design.level[at(factor)][i])].errors.push_back(design.y[i]);
  std::stable_sort(groups.begin(), groups.end(),
                   [](const Group& a, const Group& b) { return stats::median(a.errors) < stats::median(b.errors); });
  std::vector<std::string> names;
  for (const Group& g : groups) names.push_back(g.name);
  const auto [low, high] = std::minmax_element(design.y.begin(), design.y.end());
  const Drawing drawing(names, *low, *high);
  std::string content;
  for (std::size_t g = 0; g < groups.size(); ++g) content += box(drawing, g, groups[g].errors);
  return drawing.svg(content, axis);
}

// Rows: the factor with more levels; a line for each level of the other.
std::string interaction_plot(const stats::Design& design, const MeansTable& table, const std::string& axis) {
  constexpr std::array<const char*, 4> dashes{"", " stroke-dasharray=\"7 4\"", " stroke-dasharray=\"2 4\"",
                                              " stroke-dasharray=\"9 3 2 3\""};  // as report's plots have them
  const auto count = [&](std::size_t i) { return design.factors[at(table.term[i])].levels.size(); };
  const std::size_t on_rows = count(0) >= count(1) ? 0 : 1, on_lines = 1 - on_rows;
  std::vector<int> order;  // of the rows, as the table has them
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const stats::MarginalMean& m : table.means) {
    if (std::find(order.begin(), order.end(), m.levels[on_rows]) == order.end()) order.push_back(m.levels[on_rows]);
    if (!m.estimable) continue;
    low = std::min(low, m.value);
    high = std::max(high, m.value);
  }
  if (!(low <= high)) return {};
  std::vector<std::string> names;
  for (const int l : order) names.push_back(design.factors[at(table.term[on_rows])].levels[at(l)]);
  const Drawing drawing(names, low, high);
  std::string content;
  report::Plot key;
  for (std::size_t line = 0; line < count(on_lines); ++line) {
    key.series.push_back({report::Series::Kind::line, design.factors[at(table.term[on_lines])].levels[line]});
    std::string path, dots;
    bool pen_down = false;
    for (std::size_t row = 0; row < order.size(); ++row)
      for (const stats::MarginalMean& m : table.means) {
        if (m.levels[on_rows] != order[row] || m.levels[on_lines] != static_cast<int>(line)) continue;
        if (m.estimable) {
          path += format("%s%.2f %.2f", pen_down ? "L" : "M", drawing.x(m.value), drawing.y(row));
          dots += format("<circle cx=\"%.2f\" cy=\"%.2f\" r=\"2.5\"/>", drawing.x(m.value), drawing.y(row));
        }
        pen_down = m.estimable;
      }
    content += format("<path class=\"line c%zu\"%s d=\"", line % 6, dashes[line % 4]) + path +
               format("\"/><g class=\"c%zu\" stroke=\"none\">", line % 6) + dots + "</g>";
  }
  return report::legend(key) + drawing.svg(content, axis);
}

}  // namespace gonio::nrsfm
