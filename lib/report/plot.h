// Plots as inline SVG: lines, points with error bars, histograms, bands, and strips of heat, with axes, ticks and a
// legend.
//
// Coordinates are the data's; labels carry quantity and unit ("image radius / px"). Colours are classes of the page's
// style (page_style.cpp), so that a plot follows light and dark; series also differ by dash and by the shape of the
// marker, so that they stay distinct without colour. NaN and infinities are gaps. The text of a drawing depends on the
// data alone.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace gonio::report {

struct Series {
  enum class Kind { line, points, bars, band };
  Kind kind = Kind::line;
  std::string name{};  // in the legend; empty: not in the legend
  std::vector<double> x{}, y{};
  std::vector<double> sigma{};  // points: bars of one sigma; band: half width; empty: none
  std::vector<double> edges{};  // bars: one more than y
  int style = -1;  // colour, dash and marker; series that belong together share one; -1: by place in the list
};
struct Mark {  // a reference line with a word beside it
  enum class Axis { x, y };
  Axis axis = Axis::x;
  double at = 0;
  std::string name;
};
struct Shade {  // a range of x that the reader should look at
  double from = 0, to = 0;
  std::string name{};  // in the legend; empty: not in the legend
};
struct Plot {
  std::string title{}, caption{};
  std::string x_label{}, y_label{};
  std::vector<Series> series{};
  std::vector<Mark> marks{};
  std::vector<Shade> shades{};
  bool log_x = false, log_y = false;        // values <= 0 are gaps
  bool zero_y = false;                      // the y axis includes zero
  bool over_time = false;                   // x is the time of the page's model (mesh_view.h), which marks itself here
  bool equal_scales = false;                // one unit is as long on x as on y, and y points down: an image plane
  std::pair<double, double> x_range{0, 0};  // equal: from the data
  std::pair<double, double> y_range{0, 0};
};
// A row of cells, one per named thing: share of an effect, correlation between hypotheses, residual per recording.
struct HeatStrip {
  std::string title, caption, label;  // label: what the colour means, with its unit
  std::vector<std::string> columns, rows;
  std::vector<double> values;  // rows x columns, row-major
  bool diverging = false;      // colours centred on zero
  double limit = 0;            // full colour; 0: the largest magnitude
};

std::string svg(const Plot& plot);     // <svg ...>...</svg>
std::string legend(const Plot& plot);  // HTML, empty where no series has a name
std::string html(const HeatStrip& strip);

// Steps of 1, 2 or 5 times a power of ten that cut [lower, upper] into at most `most` pieces: the tick positions inside
// it.
std::vector<double> tick_positions(double lower, double upper, int most);
std::vector<double> log_tick_positions(double lower, double upper, int most);

}  // namespace gonio::report
