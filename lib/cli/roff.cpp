#include "cli/roff.h"

#include <sstream>

namespace gonio::cli {
namespace {

void escape(char c, std::string& out) {
  if (c == '\\')
    out += "\\e";
  else if (c == '-')
    out += "\\-";
  else
    out += c;
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
    } else if (!code && text.substr(i, 2) == "**") {
      bold = !bold;
      out += bold ? "\\fB" : "\\fR";
      ++i;
    } else if (!code && text[i] == '*' && (emphasis || (i + 1 < text.size() && text[i + 1] != ' '))) {
      emphasis = !emphasis;
      out += emphasis ? "\\fI" : "\\fR";
    } else {
      escape(text[i], out);
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
      if (line.starts_with('.') || line.starts_with('\'')) out += "\\&";
      for (const char c : line) escape(c, out);
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
      out += ".SH \"" + line.substr(2) + "\"\n";
      paragraph = true;
    } else if (line.starts_with("## ")) {
      out += ".SS \"" + line.substr(3) + "\"\n";
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

}  // namespace gonio::cli
