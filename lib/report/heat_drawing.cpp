// See heat_drawing.h.
#include "report/heat_drawing.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "report/colour_map.h"
#include "report/page.h"

namespace gonio::report {
namespace {

constexpr double cell_width = 68, cell_height = 24, left = 96, top = 48, bottom = 26;

std::string words(double x, double y, const char* anchor, const std::string& text) {
  return format("<text x=\"%.0f\" y=\"%.0f\" text-anchor=\"%s\">", x, y, anchor) + escape(text) + "</text>";
}

std::string cell(const HeatStrip& strip, double limit, double x, double y, double value) {
  if (!std::isfinite(value)) return words(x + cell_width / 2, y + 16, "middle", "\u2013");
  const Colour colour = strip.diverging ? signed_colour(value / limit) : magnitude_colour(value / limit);
  const bool pale = is_dark(colour);
  return format("<rect x=\"%.0f\" y=\"%.0f\" width=\"%.0f\" height=\"%.0f\" fill=\"", x, y, cell_width, cell_height) +
         hex(colour) + "\"/>" + (pale ? "<g fill=\"#fff\">" : "<g>") +
         words(x + cell_width / 2, y + 16, "middle", cell_text(value, limit)) + "</g>";
}

}  // namespace

double full_colour(const HeatStrip& strip) {
  double limit = strip.limit;
  for (const double v : strip.values)
    if (strip.limit <= 0 && std::isfinite(v)) limit = std::max(limit, std::abs(v));
  return limit > 0 ? limit : 1;
}

std::string cell_text(double value, double full) {
  const int decimals = full > 0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(full))), 2, 6) : 2;
  std::string text = format("%.*f", decimals, value);
  if (text.find_first_not_of("-0.") == std::string::npos && text.front() == '-') text.erase(0, 1);
  return text;
}

std::string standalone_svg(const HeatStrip& strip) {
  const auto columns = static_cast<double>(strip.columns.size()), rows = static_cast<double>(strip.rows.size());
  const double width = std::max(left + columns * cell_width + 8, 420.0), height = top + rows * cell_height + bottom;
  std::string text = format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" ", width, height) +
                     "font-family=\"sans-serif\" font-size=\"11\" fill=\"#222\"><title>" + escape(strip.title) +
                     "</title>" + words(4, 16, "start", strip.title);
  for (std::size_t c = 0; c < strip.columns.size(); ++c)
    text += words(left + (static_cast<double>(c) + 0.5) * cell_width, top - 8, "middle", strip.columns[c]);
  const double limit = full_colour(strip);
  for (std::size_t r = 0; r < strip.rows.size(); ++r) {
    const double y = top + static_cast<double>(r) * cell_height;
    text += words(left - 8, y + 16, "end", strip.rows[r]);
    for (std::size_t c = 0; c < strip.columns.size(); ++c)
      text += cell(strip, limit, left + static_cast<double>(c) * cell_width, y,
                   strip.values.at(r * strip.columns.size() + c));
  }
  return text + words(4, height - 8, "start", strip.label) + "</svg>\n";
}

}  // namespace gonio::report
