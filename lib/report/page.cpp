#include "report/page.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>

#include "report/mesh_style.h"
#include "report/motion_style.h"
#include "report/moving_view.h"
#include "report/page_style.h"

namespace gonio::report {
namespace {

// Width and height from the header chunk of a PNG (ISO/IEC 15948, 11.2.2); zero where it is none.
std::array<int, 2> png_size(const std::string& png) {
  if (png.size() < 24 || png.compare(12, 4, "IHDR") != 0) return {0, 0};
  const auto big_endian = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = (value << 8) | static_cast<unsigned char>(png[i]);
    return value;
  };
  return {big_endian(16), big_endian(20)};
}

// Small pictures are enlarged by a whole factor to about `target` pixels, so that a pixel stays a square.
int display_width(int width_px, int target) {
  return width_px > 0 ? width_px * std::max(1, target / width_px) : target;
}

int shown_width(const Figure& figure, int target) {
  return display_width(figure.width_px > 0 ? figure.width_px : png_size(figure.png)[0], target);
}

std::string image_tag(const Figure& figure, int target, const std::string& kind) {
  const auto size = png_size(figure.png);
  const int width = shown_width(figure, target);
  const int height = size[0] > 0 ? static_cast<int>(static_cast<std::int64_t>(width) * size[1] / size[0]) : 0;
  std::string tag = "<img" + kind + " width=\"" + std::to_string(width) + "\"";
  if (height > 0) tag += " height=\"" + std::to_string(height) + "\"";
  return tag + " alt=\"" + escape(figure.title) + "\" src=\"data:image/png;base64," + base64(figure.png) + "\">";
}

std::string caption_tag(const std::string& title, const std::string& caption) {
  if (title.empty() && caption.empty()) return {};
  return "<figcaption>" + (title.empty() ? std::string() : "<b>" + escape(title) + "</b>") + escape(caption) +
         "</figcaption>";
}

std::string tone_class(Tone tone) {
  return tone == Tone::good ? " class=\"good\"" : tone == Tone::bad ? " class=\"bad\"" : "";
}

std::string with_unit(const Column& column) {
  return escape(column.name) + (column.unit.empty() ? std::string() : " <small>/ " + escape(column.unit) + "</small>");
}

std::string plot_figure(const Plot& plot) {
  std::string html = "<figure class=\"plot\">";
  if (!plot.title.empty()) html += "<p class=\"title\">" + escape(plot.title) + "</p>";
  return html + legend(plot) + svg(plot) + caption_tag("", plot.caption) + "</figure>";
}

}  // namespace

std::string escape(std::string_view text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&': safe += "&amp;"; break;
      case '<': safe += "&lt;"; break;
      case '>': safe += "&gt;"; break;
      case '"': safe += "&quot;"; break;
      case '\'': safe += "&#39;"; break;
      default: safe += c;
    }
  }
  return safe;
}

std::string base64(std::string_view bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = (group << 8) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[(group >> (18 - 6 * k)) & 63u] : '=';
  }
  return text;
}

Page::Page(std::string_view title, std::string_view headline, std::string_view lead, Tone tone) : title_(title) {
  head_ =
      "<header><p class=\"eyebrow\">" + escape(title) + "</p><h1" + tone_class(tone) + ">" + escape(headline) + "</h1>";
  if (!lead.empty()) head_ += "<p class=\"lead\">" + escape(lead) + "</p>";
  head_ += "</header>\n";
}

void Page::section(std::string_view heading) {
  if (in_section_) body_ += "</section>\n";
  in_section_ = true;
  headings_.emplace_back(heading);
  body_ += "<section id=\"s" + std::to_string(headings_.size()) + "\"><h2>" + escape(heading) + "</h2>\n";
}

void Page::subsection(std::string_view heading) {
  body_ += "<h3>" + escape(heading) + "</h3>\n";
}

void Page::paragraph(std::string_view text) {
  body_ += "<p>" + escape(text) + "</p>\n";
}

void Page::note(std::string_view text) {
  body_ += "<p class=\"note\">" + escape(text) + "</p>\n";
}

void Page::list(const std::vector<std::string>& items) {
  body_ += "<ul>";
  for (const auto& item : items) body_ += "<li>" + escape(item) + "</li>";
  body_ += "</ul>\n";
}

void Page::key_numbers(const std::vector<KeyNumber>& numbers) {
  body_ += "<dl class=\"numbers\">";
  for (const auto& n : numbers) {
    const std::string tone = tone_class(n.tone);
    body_ += "<div" + tone + "><dt>" + escape(n.label) + "</dt><dd" + tone + ">" + escape(n.value);
    if (!n.unit.empty()) body_ += " <small>" + escape(n.unit) + "</small>";
    body_ += "</dd>";
    if (!n.note.empty()) body_ += "<dd class=\"under\">" + escape(n.note) + "</dd>";
    body_ += "</div>";
  }
  body_ += "</dl>\n";
}

void Page::score_bars(const std::vector<ScoreBar>& bars) {
  double longest = 0;
  for (const auto& bar : bars) longest = std::max(longest, bar.size);
  body_ += "<dl class=\"scores\">";
  for (const auto& bar : bars) {
    const double share = longest > 0 && bar.size > 0 ? bar.size / longest : 0;
    body_ += "<dt>" + escape(bar.label) + "</dt><dd" + tone_class(bar.tone) +
             " style=\"--share:" + std::to_string(static_cast<int>(75 * share + 0.5)) + "%\"><i></i>" +
             escape(bar.value) + "</dd>";
  }
  body_ += "</dl>\n";
}

void Page::table(const TableText& table) {
  body_ += "<div class=\"scroll\"><table>";
  if (!table.caption.empty()) body_ += "<caption>" + escape(table.caption) + "</caption>";
  body_ += "<thead><tr>";
  for (const auto& column : table.columns)
    body_ += std::string("<th scope=\"col\"") + (column.numeric ? " class=\"n\">" : ">") + with_unit(column) + "</th>";
  body_ += "</tr></thead><tbody>";
  for (const auto& row : table.rows) {
    body_ += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i)
      body_ += std::string("<td") + (i < table.columns.size() && table.columns[i].numeric ? " class=\"n\">" : ">") +
               escape(row[i]) + "</td>";
    body_ += "</tr>";
  }
  body_ += "</tbody></table></div>\n";
}

void Page::figures(const std::vector<Figure>& figures, int width_px) {
  const int drawing = std::max(480, width_px);
  body_ += "<div class=\"figures\">";
  for (const auto& figure : figures)
    body_ += "<figure style=\"width:" + std::to_string(figure.svg.empty() ? shown_width(figure, width_px) : drawing) +
             "px\">" + (figure.svg.empty() ? image_tag(figure, width_px, "") : figure.svg) +
             caption_tag(figure.title, figure.caption) + "</figure>";
  body_ += "</div>\n";
}

void Page::slider(const Figure& left, const Figure& right, std::string_view caption) {
  const std::string left_name = escape(left.title), right_name = escape(right.title);
  body_ += "<figure class=\"pair\"><div class=\"pair-frame\" style=\"width:" + std::to_string(shown_width(left, 720)) +
           "px\" data-left=\"" + left_name + "\">" + image_tag(left, 720, "") +
           image_tag(right, 720, " class=\"over\"") +
           "<input type=\"range\" min=\"0\" max=\"1000\" value=\"500\" step=\"5\" aria-label=\"Divider between " +
           left_name + " and " + right_name + "\"><span class=\"tag left\">" + left_name +
           "</span><span class=\"tag right\">" + right_name + "</span><span class=\"divider\"></span></div>" +
           caption_tag("", std::string(caption)) + "</figure>\n";
}

void Page::plot(const Plot& plot) {
  body_ += plot_figure(plot) + "\n";
}

void Page::plots(const std::vector<Plot>& plots) {
  body_ += "<div class=\"plots\">";
  for (const auto& plot : plots) body_ += plot_figure(plot);
  body_ += "</div>\n";
}

void Page::heat_strip(const HeatStrip& strip) {
  body_ += report::html(strip) + "\n";
}

void Page::colour_scale(const ColourScale& scale) {
  std::string ramp, ticks;
  for (const auto& colour : scale.colours) ramp += (ramp.empty() ? "" : ",") + escape(colour);
  for (const auto& tick : scale.ticks) ticks += "<span>" + escape(tick) + "</span>";
  body_ += "<div class=\"scale\">" + escape(scale.label) + (scale.unit.empty() ? "" : " / " + escape(scale.unit)) +
           "<div class=\"ramp\" style=\"background:linear-gradient(to right," + ramp +
           ")\"></div><div class=\"ticks\">" + ticks + "</div></div>\n";
}

void Page::open_details(std::string_view summary) {
  body_ += "<details><summary>" + escape(summary) + "</summary>\n";
}

void Page::close_details() {
  body_ += "</details>\n";
}

void Page::footer(std::string_view text) {
  footer_ += "<p>" + escape(text) + "</p>";
}

void Page::reload_every(int seconds) {
  reload_s_ = seconds;
}

std::string Page::html() const {
  const bool moving = body_.find("<div class=\"motion\"") != std::string::npos;
  const bool solid = body_.find("<div class=\"solid\"") != std::string::npos;
  const bool model = body_.find("class=\"model\"") != std::string::npos;
  std::string navigation;
  if (headings_.size() > 2) {
    for (std::size_t i = 0; i < headings_.size(); ++i)
      navigation += "<a href=\"#s" + std::to_string(i + 1) + "\">" + escape(headings_[i]) + "</a>";
    navigation = "<nav aria-label=\"Sections\"><div>" + navigation + "</div></nav>\n";
  }
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
         "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n" +
         (reload_s_ > 0 ? "<meta http-equiv=\"refresh\" content=\"" + std::to_string(reload_s_) + "\">\n" : "") +
         "<title>" + escape(title_) + "</title>\n<style>" + std::string(page_style) +
         (moving ? std::string(motion_style) : "") + (solid ? std::string(solid_style) : "") +
         "</style></head>\n<body>" + head_ + navigation + "<main>" + body_ + (in_section_ ? "</section>" : "") +
         "</main>\n" + (footer_.empty() ? std::string() : "<footer>" + footer_ + "</footer>\n") + "<script>" +
         std::string(page_script) + (moving ? std::string(motion_script) : "") +
         (model ? std::string(moving_script) : "") + (solid ? std::string(solid_script) : "") +
         "</script></body></html>\n";
}

}  // namespace gonio::report
