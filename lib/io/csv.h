// Tables of numbers and names as comma-separated values, RFC 4180: a header line, fields that may stand in quotes with
// "" for a quote, line ends LF or CRLF. A byte order mark, lines that begin with # before the header, and empty lines
// are passed over. Blanks around fields without quotes do not count.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::io {

struct Csv {
  std::string name;  // of the file, for messages
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  // as many fields as the header has
  std::vector<std::size_t> line;               // where each row begins, from 1
  std::string place(std::size_t row) const;    // "scan.csv:17"
};

// Error(data) at the line for rows of another length, text behind a closing quote, a quote that is never closed, a name
// that the header has twice or leaves empty; for a file without rows.
Csv parse_csv(std::string_view text, const std::string& name);
Csv read_csv(const std::filesystem::path& path);

// The number in `text`, whole. Error(data) at `place`; infinities and NaN are refused.
double csv_number(const std::string& text, const std::string& place);

}  // namespace gonio::io
