#include "report/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "report/colour_map.h"
#include "report/heat_drawing.h"
#include "report/page.h"
#include "report/plot_axis.h"

namespace gonio::report {
namespace {

constexpr double width = 560, top = 28, left = 58, right = 16, bottom = 44, plain_height = 300;
constexpr int colours = 6;
constexpr std::array<const char*, 4> dashes{"", " stroke-dasharray=\"7 4\"", " stroke-dasharray=\"2 4\"",
                                            " stroke-dasharray=\"9 3 2 3\""};

[[gnu::format(printf, 1, 2)]] std::string print(const char* format, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

std::size_t style(const Plot& plot, std::size_t series) {
  return plot.series[series].style < 0 ? series : static_cast<std::size_t>(plot.series[series].style);
}
std::string colour_class(std::size_t series) {
  return print("c%d", static_cast<int>(series) % colours);
}
const char* dash(std::size_t series) {
  return dashes[series % dashes.size()];
}

// Circle, square, diamond, triangle: told apart without colour.
std::string marker(std::size_t series, double x, double y, double r) {
  switch (series % 4) {
    case 0: return print("<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\"/>", x, y, r);
    case 1: return print("<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\"/>", x - r, y - r, 2 * r, 2 * r);
    case 2:
      return print("<path d=\"M%.2f %.2fl%.2f %.2fl%.2f %.2fl%.2f %.2fz\"/>", x, y - 1.3 * r, 1.3 * r, 1.3 * r,
                   -1.3 * r, 1.3 * r, -1.3 * r, -1.3 * r);
    default: return print("<path d=\"M%.2f %.2fl%.2f %.2fl%.2f 0z\"/>", x, y - 1.3 * r, 1.25 * r, 2.2 * r, -2.5 * r);
  }
}

struct Drawing {
  PlotAxis x, y;
  double height;
};

std::string frame(const Plot& plot, const Drawing& d) {
  const double floor = d.height - bottom;
  std::string grid, labels;
  for (const double tick : d.y.ticks(5)) {
    const double at = d.y.place(tick);
    grid += print("M%.0f %.2fH%.0f", left, at, width - right);
    labels += print("<text x=\"%.0f\" y=\"%.2f\" text-anchor=\"end\">", left - 8, at + 4) + d.y.label(tick) + "</text>";
  }
  std::string axis = print("M%.0f %.2fH%.0f", left, floor, width - right);
  for (const double tick : d.x.ticks(7)) {
    const double at = d.x.place(tick);
    axis += print("M%.2f %.2fv5", at, floor);
    labels +=
        print("<text x=\"%.2f\" y=\"%.2f\" text-anchor=\"middle\">", at, floor + 19) + d.x.label(tick) + "</text>";
  }
  labels += print("<text x=\"%.0f\" y=\"14\">", 0.0) + escape(plot.y_label) + "</text>";
  labels += print("<text x=\"%.0f\" y=\"%.2f\" text-anchor=\"end\">", width - right, floor + 38) +
            escape(plot.x_label) + "</text>";
  return "<path class=\"grid\" d=\"" + grid + "\"/><path class=\"axis\" d=\"" + axis + "\"/>" + labels;
}

std::string line(const Series& s, std::size_t n, const Drawing& d) {
  std::string path;
  bool pen_down = false;
  for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
    const bool shown = d.x.shows(s.x[i]) && d.y.shows(s.y[i]);
    if (shown) path += print("%s%.2f %.2f", pen_down ? "L" : "M", d.x.place(s.x[i]), d.y.place(s.y[i]));
    pen_down = shown;
  }
  return "<path class=\"line " + colour_class(n) + "\"" + dash(n) + " d=\"" + path + "\"/>";
}

std::string points(const Series& s, std::size_t n, const Drawing& d) {
  std::string dots, errors;
  const std::size_t count = std::min(s.x.size(), s.y.size());
  const double r = count > 2000 ? 1.2 : count > 200 ? 1.8 : 3.0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!d.x.shows(s.x[i]) || !d.y.shows(s.y[i])) continue;
    const double x = d.x.place(s.x[i]);
    dots += marker(n, x, d.y.place(s.y[i]), r);
    if (i >= s.sigma.size() || !(s.sigma[i] > 0)) continue;
    const double low = d.y.shows(s.y[i] - s.sigma[i]) ? d.y.place(s.y[i] - s.sigma[i]) : d.height - bottom;
    errors += print("M%.2f %.2fV%.2f", x, low, d.y.place(s.y[i] + s.sigma[i]));
  }
  const std::string colour = colour_class(n);
  return "<path class=\"error " + colour + "\" d=\"" + errors + "\"/><g class=\"" + colour + "\" stroke=\"none\">" +
         dots + "</g>";
}

std::string bars(const Series& s, std::size_t n, const Drawing& d) {
  std::string path;
  const double floor = d.height - bottom;
  const double zero = d.y.shows(0) ? std::min(d.y.place(0), floor) : floor;
  for (std::size_t i = 0; i < s.y.size() && i + 1 < s.edges.size(); ++i) {
    if (!d.y.shows(s.y[i]) || s.y[i] == 0 || !d.x.shows(s.edges[i]) || !d.x.shows(s.edges[i + 1])) continue;
    path += print("M%.2f %.2fV%.2fH%.2fV%.2fz", d.x.place(s.edges[i]), zero, d.y.place(s.y[i]),
                  d.x.place(s.edges[i + 1]), zero);
  }
  return "<path class=\"bars " + colour_class(n) + "\" d=\"" + path + "\"/>";
}

std::string band(const Series& s, std::size_t n, const Drawing& d) {
  std::string forth, back;
  for (std::size_t i = 0; i < std::min({s.x.size(), s.y.size(), s.sigma.size()}); ++i) {
    const double low = s.y[i] - s.sigma[i], high = s.y[i] + s.sigma[i];
    if (!d.x.shows(s.x[i]) || !d.y.shows(low) || !d.y.shows(high)) continue;
    const double x = d.x.place(s.x[i]);
    forth += print("%s%.2f %.2f", forth.empty() ? "M" : "L", x, d.y.place(high));
    back = print("L%.2f %.2f", x, d.y.place(low)) + back;
  }
  return "<path class=\"band " + colour_class(n) + "\" d=\"" + forth + back + (forth.empty() ? "" : "z") + "\"/>";
}

std::string draw(const Series& s, std::size_t n, const Drawing& d) {
  switch (s.kind) {
    case Series::Kind::line: return line(s, n, d);
    case Series::Kind::points: return points(s, n, d);
    case Series::Kind::bars: return bars(s, n, d);
    case Series::Kind::band: return band(s, n, d);
  }
  return {};
}

std::string draw(const Mark& mark, const Drawing& d) {
  const bool on_x = mark.axis == Mark::Axis::x;
  if (!(on_x ? d.x : d.y).shows(mark.at)) return {};
  const double at = on_x ? d.x.place(mark.at) : d.y.place(mark.at);
  if (on_x) {
    const bool crowded = at > width - right - 90;
    return print("<path class=\"mark\" d=\"M%.2f %.0fV%.2f\"/><text class=\"mark-name\" x=\"%.2f\" y=\"%.0f\"%s>", at,
                 top, d.height - bottom, crowded ? at - 5 : at + 5, top + 10, crowded ? " text-anchor=\"end\"" : "") +
           escape(mark.name) + "</text>";
  }
  return print(
             "<path class=\"mark\" d=\"M%.0f %.2fH%.0f\"/><text class=\"mark-name\" x=\"%.0f\" y=\"%.2f\" "
             "text-anchor=\"end\">",
             left, at, width - right, width - right, at - 5) +
         escape(mark.name) + "</text>";
}

std::string draw(const Shade& shade, const Drawing& d) {
  const auto [lower, upper] = d.x.range();
  const double from = std::max(shade.from, lower), to = std::min(shade.to, upper);
  if (!(to > from) || !d.x.shows(from)) return {};
  const double at = d.x.place(from);
  return print("<rect class=\"shade\" x=\"%.2f\" y=\"%.0f\" width=\"%.2f\" height=\"%.2f\"/>", at, top,
               d.x.place(to) - at, d.height - bottom - top);
}

}  // namespace

std::string svg(const Plot& plot) {
  const PlotRanges range = ranges(plot);
  const double inner_width = width - left - right;
  const double height =
      plot.equal_scales
          ? top + bottom + inner_width * (range.y.second - range.y.first) / (range.x.second - range.x.first)
          : plain_height;
  const double floor = height - bottom;
  const Drawing d{
      PlotAxis(range.x, plot.log_x, left, width - right),
      plot.equal_scales ? PlotAxis(range.y, plot.log_y, top, floor) : PlotAxis(range.y, plot.log_y, floor, top),
      height};
  std::string text = print("<svg viewBox=\"0 0 %.0f %.0f\" role=\"img\" ", width, height) +
                     (plot.over_time ? print("data-time=\"%.9g %.9g %.0f %.0f %.0f %.0f\" ", range.x.first,
                                             range.x.second, left, width - right, top, floor)
                                     : std::string()) +
                     "aria-label=\"" + escape(plot.title) + "\">";
  for (const auto& shade : plot.shades) text += draw(shade, d);
  text += frame(plot, d);
  for (std::size_t n = 0; n < plot.series.size(); ++n) text += draw(plot.series[n], style(plot, n), d);
  for (const auto& mark : plot.marks) text += draw(mark, d);
  return text + "</svg>";
}

std::string legend(const Plot& plot) {
  std::string text;
  for (std::size_t place = 0; place < plot.series.size(); ++place) {
    const Series& s = plot.series[place];
    if (s.name.empty()) continue;
    const std::size_t n = style(plot, place);
    std::string sample;
    const std::string colour = colour_class(n);
    if (s.kind == Series::Kind::line)
      sample = "<path class=\"line " + colour + "\"" + dash(n) + " d=\"M0 6H26\"/>";
    else if (s.kind == Series::Kind::points)
      sample = "<g class=\"" + colour + "\" stroke=\"none\">" + marker(n, 13, 6, 4) + "</g>";
    else
      sample = std::string("<path class=\"") + (s.kind == Series::Kind::band ? "band " : "bars ") + colour +
               "\" d=\"M4 0H22V12H4z\"/>";
    text += "<span><svg viewBox=\"0 0 26 12\" aria-hidden=\"true\">" + sample + "</svg>" + escape(s.name) + "</span>";
  }
  for (const Shade& shade : plot.shades)
    if (!shade.name.empty())
      text +=
          "<span><svg viewBox=\"0 0 26 12\" aria-hidden=\"true\"><path class=\"shade\" d=\"M4 0H22V12H4z\"/></svg>" +
          escape(shade.name) + "</span>";
  return text.empty() ? text : "<div class=\"legend\">" + text + "</div>";
}

std::string html(const HeatStrip& strip) {
  const double limit = full_colour(strip);
  std::string text = "<figure>";
  if (!strip.title.empty()) text += "<p class=\"title\"><b>" + escape(strip.title) + "</b></p>";
  text += "<div class=\"scroll\"><table class=\"heat\"><thead><tr><th></th>";
  for (const auto& column : strip.columns) text += "<th scope=\"col\">" + escape(column) + "</th>";
  text += "</tr></thead><tbody>";
  for (std::size_t r = 0; r < strip.rows.size(); ++r) {
    text += "<tr><th scope=\"row\">" + escape(strip.rows[r]) + "</th>";
    for (std::size_t c = 0; c < strip.columns.size(); ++c) {
      const double v = strip.values.at(r * strip.columns.size() + c);
      const Colour colour = strip.diverging ? signed_colour(v / limit) : magnitude_colour(v / limit);
      const bool pale = is_dark(colour);
      text += std::isfinite(v) ? std::string("<td") + (pale ? " class=\"pale\"" : "") +
                                     " style=\"background:" + hex(colour) + "\">" + cell_text(v, limit) + "</td>"
                               : "<td>\u2013</td>";
    }
    text += "</tr>";
  }
  text +=
      "</tbody></table></div><figcaption>" + escape(strip.label + (strip.caption.empty() ? "" : ". " + strip.caption));
  return text + "</figcaption></figure>";
}

}  // namespace gonio::report
