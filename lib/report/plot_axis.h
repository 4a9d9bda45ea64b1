// One axis of a plot: the range, linear or logarithmic, and its place on the drawing. Private to plot.cpp.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "report/plot.h"

namespace gonio::report {

class PlotAxis {
 public:
  // `begin`, `end`: where `range` lies on the drawing; end < begin for an axis that points up.
  PlotAxis(std::pair<double, double> range, bool logarithmic, double begin, double end);
  bool shows(double v) const;  // finite, and positive on a logarithmic axis
  double place(double v) const;
  std::vector<double> ticks(int most) const;
  std::string label(double tick) const;  // as content of an SVG <text>
  std::pair<double, double> range() const { return range_; }

 private:
  std::pair<double, double> range_;
  bool logarithmic_;
  double begin_, end_, step_ = 0;
};

// The range of all data that the axes of `plot` show, padded; never empty.
struct PlotRanges {
  std::pair<double, double> x, y;
};
PlotRanges ranges(const Plot& plot);

}  // namespace gonio::report
