// One self-contained HTML page: a report that opens from a single file, without a network, on paper and on a telephone.
//
// Everything is embedded: style, script, pictures (PNG as base64), drawings (inline SVG). A content security policy in
// the page's head forbids it to load anything else. Text is given plain and escaped here; pictures are given as the
// bytes of a PNG. Light and dark follow the reader's system; printing uses the light colours and unfolds what is
// folded.
//
// The page is written from top to bottom in the order of the calls. It does not lay out mathematics and knows nothing
// of comparisons or explanations: those are composed by tools/compare/page.h and by explain's report.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "report/plot.h"

namespace gonio::report {

enum class Tone { neutral, good, bad };

struct KeyNumber {  // a large figure with its name
  std::string label, value, unit, note;
  Tone tone = Tone::neutral;
};
struct Column {
  std::string name{}, unit{};
  bool numeric = true;  // numbers are aligned right, text left
};
struct ScoreBar {  // a length beside its number, for a few scores to be compared at a glance
  std::string label, value;
  double size = 0;  // the longest bar of the list fills the width
  Tone tone = Tone::neutral;
};
struct TableText {
  std::string caption{};
  std::vector<Column> columns{};
  std::vector<std::vector<std::string>> rows{};
};
struct Figure {
  std::string png{};  // bytes of a PNG, or
  std::string svg{};  // an inline drawing made by the program itself: not escaped
  std::string title{}, caption{};
  int width_px = 0;  // of the picture: small ones are enlarged by a whole factor, pixels left square; 0: from the PNG
};
struct ColourScale {  // the key of a false-colour picture: colours from left to right, labels at equal distances
  std::string label, unit;
  std::vector<std::string> colours;  // "#rrggbb"
  std::vector<std::string> ticks;
};

class Page {
 public:
  // `title` names the window, `headline` is the one sentence that a reader takes away, `lead` says what was looked at.
  Page(std::string_view title, std::string_view headline, std::string_view lead, Tone tone = Tone::neutral);

  void section(std::string_view heading);  // gets an entry in the navigation
  void subsection(std::string_view heading);
  void paragraph(std::string_view text);
  void note(std::string_view text);  // small print
  void list(const std::vector<std::string>& items);
  void key_numbers(const std::vector<KeyNumber>& numbers);
  void score_bars(const std::vector<ScoreBar>& bars);
  void table(const TableText& table);
  // Beside each other where there is room; `width_px`: about which pictures are shown.
  void figures(const std::vector<Figure>& figures, int width_px = 340);
  // Two pictures of the same size under one movable divider: `left` shows left of it, `right` right of it.
  void slider(const Figure& left, const Figure& right, std::string_view caption);
  void plot(const Plot& plot);
  void plots(const std::vector<Plot>& plots);  // beside each other where there is room
  void heat_strip(const HeatStrip& strip);
  void colour_scale(const ColourScale& scale);
  void open_details(std::string_view summary);  // folded until the reader opens it
  void close_details();
  void footer(std::string_view text);
  void reload_every(int seconds);  // for a page that is written again while something goes on

  std::string html() const;

 private:
  std::string title_, head_, body_, footer_;
  std::vector<std::string> headings_;
  bool in_section_ = false;
  int reload_s_ = 0;  // 0: never
};

std::string escape(std::string_view text);  // & < > " ' for element content and attribute values
std::string base64(std::string_view bytes);

}  // namespace gonio::report
