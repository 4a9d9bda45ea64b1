// Text files of numbers in columns, before anybody knows what the columns mean: names, fields, and where they stand.
//
// Separators: commas (RFC 4180, io/csv.h), semicolons, tabs or blanks, whichever the first line of numbers has. Names:
// the first line where that is no line of numbers, else the last comment above the numbers that has as many words as
// they have columns, else none. A file with a line "VARS name,name,..." is one after ASTM E1392: the lines above are
// keywords, of which NUM_POINTS is checked. Comments begin with #, %, ! or //.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace gonio::goniometry {

struct TextTable {
  std::string name;                  // of the file, for messages
  std::vector<std::string> heading;  // one per column; empty texts where the file names none
  std::size_t heading_line = 0;      // from 1; 0: none
  std::vector<std::vector<std::string>> rows;
  std::vector<std::size_t> line;
  std::string place(std::size_t row) const { return name + ":" + std::to_string(line.at(row)); }
  std::string heading_place() const { return heading_line == 0 ? name : name + ":" + std::to_string(heading_line); }
};
// Error(data) for rows of another length, a name that stands twice, a file without numbers, fewer rows than announced.
TextTable parse_text_table(std::string_view text, const std::string& name);

}  // namespace gonio::goniometry
