#include "cli/roff.h"

#include <algorithm>
#include <sstream>

namespace gonio::cli {
namespace {

// As it stands, also where a terminal has typographic signs for ^ ~ -; in `code`, for quotes as well.
void escape(char c, bool code, std::string& out) {
  switch (c) {
    case '\\': out += "\\(rs"; break;
    case '-': out += "\\-"; break;
    case '^': out += "\\(ha"; break;
    case '~': out += "\\(ti"; break;
    case '\'': out += code ? "\\(aq" : "'"; break;
    case '`': out += code ? "\\(ga" : "`"; break;
    default: out += c;
  }
}

bool is_word(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c & 0x80) != 0;
}

// Does `mark` ("*", "**") at `at` open what a later one closes? It stands before a word and not behind one; what closes
// stands behind something and not before a word. Every other star is a product, a pattern, ...
bool opens(std::string_view text, std::size_t at, std::string_view mark) {
  const std::size_t first = at + mark.size();
  if (text.substr(at, mark.size()) != mark || first >= text.size()) return false;
  if (at > 0 && (is_word(text[at - 1]) || text[at - 1] == '*')) return false;
  if (mark.size() == 1 ? !is_word(text[first]) : text[first] == ' ') return false;
  for (std::size_t end = text.find(mark, first); end != std::string_view::npos; end = text.find(mark, end + 1)) {
    const std::size_t behind = end + mark.size();
    if (end > first && text[end - 1] != ' ' && (behind == text.size() || !is_word(text[behind]))) return true;
  }
  return false;
}

// As the argument of .SH or .SS.
std::string argument(std::string_view heading) {
  std::string out = "\"";
  for (const char c : heading)
    if (c == '"')
      out += "\\(dq";
    else
      escape(c, true, out);
  return out + "\"";
}

// Split at "|"; "\\|" is a bar within a cell.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (std::size_t i = 1; i < line.size(); ++i) {
    if (line[i] == '|')
      cells.emplace_back();
    else if (line[i] == '\\' && i + 1 < line.size() && line[i + 1] == '|')
      cells.back() += line[++i];
    else
      cells.back() += line[i];
  }
  for (std::string& cell : cells) {
    const auto first = cell.find_first_not_of(' '), last = cell.find_last_not_of(' ');
    cell = first == std::string::npos ? "" : cell.substr(first, last - first + 1);
  }
  if (!cells.empty() && cells.back().empty()) cells.pop_back();
  return cells;
}

// tbl(1) source: first row bold, last column wrapped.
void print_table(const std::vector<std::vector<std::string>>& rows, std::string& out) {
  if (rows.empty()) return;
  out += ".TS\nallbox tab(\t);\n";
  for (std::size_t pass = 0; pass < 2; ++pass) {
    for (std::size_t c = 0; c < rows[0].size(); ++c)
      out += std::string(c == 0 ? "" : " ") + (pass == 0 ? "lb" : "l") + (c + 1 == rows[0].size() ? "x" : "");
    out += pass == 0 ? "\n" : ".\n";
  }
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c)
      out += std::string(c == 0 ? "" : "\t") + "T{\n" + roff_text(row[c]) + "\nT}";
    out += '\n';
  }
  out += ".TE\n.PP\n";
}

// visit(line, is it a "# HEADING"?): within fenced code a line that starts with # is none.
template <class Visit>
void each_line(std::string_view text, const Visit& visit) {
  std::istringstream in{std::string(text)};
  bool code = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("```")) code = !code;
    visit(line, !code && line.starts_with("# "));
  }
}

}  // namespace

std::string roff_text(std::string_view text) {
  std::string out;
  bool bold = false, code = false, emphasis = false;
  if (text.starts_with('.') || text.starts_with('\'')) out += "\\&";
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '`') {
      code = !code;
      out += code ? "\\fB" : "\\fR";
    } else if (!code && (bold ? text.substr(i, 2) == "**" : opens(text, i, "**"))) {
      bold = !bold;
      out += bold ? "\\fB" : "\\fR";
      ++i;
    } else if (!code && (emphasis ? text[i] == '*' && text[i - 1] != ' ' : opens(text, i, "*"))) {
      emphasis = !emphasis;
      out += emphasis ? "\\fI" : "\\fR";
    } else {
      escape(text[i], code, out);
    }
  }
  return out;
}

std::string roff_from_markdown(std::string_view text) {
  std::istringstream in{std::string(text)};
  std::string out;
  bool code = false, paragraph = false;
  std::vector<std::vector<std::string>> table;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("```")) {
      code = !code;
      out += code ? ".PP\n.RS 4\n.nf\n" : ".fi\n.RE\n";
      paragraph = false;
      continue;
    }
    if (code) {
      if (line.starts_with('.')) out += "\\&";
      for (const char c : line) escape(c, true, out);
      out += '\n';
      continue;
    }
    if (line.starts_with('|')) {
      if (line.find_first_not_of("|- :") != std::string::npos) table.push_back(cells_of(line));
      continue;
    }
    print_table(table, out);
    table.clear();
    if (line.empty()) {
      paragraph = false;
    } else if (line.starts_with("# ")) {
      out += ".SH " + argument(line.substr(2)) + "\n";
      paragraph = true;
    } else if (line.starts_with("## ")) {
      out += ".SS " + argument(line.substr(3)) + "\n";
      paragraph = true;
    } else if (line.starts_with("- ")) {
      out += ".IP \\(bu 2\n" + roff_text(line.substr(2)) + "\n";
      paragraph = true;
    } else {
      if (!paragraph) out += ".PP\n";
      out += roff_text(line.substr(line.find_first_not_of(' '))) + "\n";
      paragraph = true;
    }
  }
  print_table(table, out);
  return out;
}

std::string section_of(std::string_view text, std::string_view name) {
  std::string out;
  bool inside = false;
  each_line(text, [&](const std::string& line, bool heading) {
    if (heading)
      inside = std::string_view(line).substr(2) == name;
    else if (inside)
      out += line + "\n";
  });
  return out;
}

std::vector<std::string> headings_of(std::string_view text) {
  std::vector<std::string> names;
  each_line(text, [&](const std::string& line, bool heading) {
    if (heading) names.push_back(line.substr(2));
  });
  return names;
}

std::string contents_of(std::string_view text, std::size_t fewest) {
  std::string out;
  std::size_t parts = 0;
  bool first = true;
  each_line(text, [&](const std::string& line, bool heading) {
    if (heading) {
      out += "\n- **" + line.substr(2) + "**";
      first = true;
    } else if (line.starts_with("## ")) {
      out += (first ? ": " : ", ") + line.substr(3);
      first = false;
      ++parts;
    }
  });
  constexpr std::ptrdiff_t long_text = 400;  // lines
  const bool short_text = std::ranges::count(text, '\n') < long_text;
  return parts < fewest && short_text ? "" : "# CONTENTS" + out + "\n\n";
}

}  // namespace gonio::cli
