// See csv.h.
#include "io/csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"

namespace gonio::io {
namespace {

constexpr std::string_view blanks = " \t";

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

class Reader {
 public:
  Reader(std::string_view text, const std::string& name) : text_(text), name_(name) {
    if (text_.starts_with("\xef\xbb\xbf")) text_.remove_prefix(3);
  }
  bool ended() const { return at_ >= text_.size(); }
  std::size_t line() const { return line_; }
  bool comment() const { return !ended() && text_[at_] == '#'; }
  void skip_line() {
    at_ = std::min(text_.find('\n', at_), text_.size() - 1) + 1;
    ++line_;
  }
  // One record, from the start of a line to behind its end.
  std::vector<std::string> record() {
    const std::size_t start = line_;
    std::vector<std::string> fields;
    do {
      fields.push_back(next_is_quoted() ? quoted_field(start) : plain_field());
    } while (!ended() && text_[at_++] == ',');
    ++line_;
    return fields;
  }

 private:
  bool next_is_quoted() const {
    const auto first = text_.find_first_not_of(blanks, at_);
    return first != std::string_view::npos && text_[first] == '"';
  }
  std::string plain_field() {
    const std::size_t end = std::min(text_.find_first_of(",\n", at_), text_.size());
    std::string field(text_.substr(at_, end - at_));
    at_ = end;
    if (field.ends_with('\r')) field.pop_back();
    return trimmed(field);
  }
  std::string quoted_field(std::size_t start) {
    std::string field;
    at_ = text_.find('"', at_) + 1;
    for (;; ++at_) {
      if (ended()) throw Error(Exit::data, place(start), "a quote is opened and never closed");
      if (text_[at_] == '\n') ++line_;
      if (text_[at_] != '"') {
        field += text_[at_];
      } else if (at_ + 1 < text_.size() && text_[at_ + 1] == '"') {
        field += text_[at_++];
      } else {
        break;
      }
    }
    const std::size_t behind = std::min(text_.find_first_not_of(" \t\r", at_ + 1), text_.size());
    if (behind < text_.size() && text_[behind] != ',' && text_[behind] != '\n')
      throw Error(Exit::data, place(line_), "has text behind a closing quote", "write a quote within a field twice");
    at_ = behind;
    return field;
  }
  std::string place(std::size_t line) const { return name_ + ":" + std::to_string(line); }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0, line_ = 1;
};

void check_header(const std::vector<std::string>& header, const std::string& place) {
  if (header.size() == 1 && header[0].find_first_of(";\t") != std::string::npos)
    throw Error(Exit::data, place, "has no comma", "separate the columns by commas and write decimal points");
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (header[i].empty())
      throw Error(Exit::data, place, "column " + std::to_string(i + 1) + " has no name",
                  "the first line names every column");
    if (std::find(header.begin(), header.begin() + static_cast<std::ptrdiff_t>(i), header[i]) !=
        header.begin() + static_cast<std::ptrdiff_t>(i))
      throw Error(Exit::data, place, "names column \"" + header[i] + "\" twice", "rename one of the two");
  }
}

}  // namespace

std::string Csv::place(std::size_t row) const {
  return name + ":" + std::to_string(line.at(row));
}

Csv parse_csv(std::string_view text, const std::string& name) {
  if (text.find('\0') != std::string_view::npos) throw Error(Exit::data, name, "is no text: it holds a zero byte");
  Csv csv{name, {}, {}, {}};
  Reader reader(text, csv.name);
  while (!reader.ended()) {
    const std::size_t line = reader.line();
    if (csv.header.empty() && reader.comment()) {
      reader.skip_line();
      continue;
    }
    std::vector<std::string> fields = reader.record();
    if (fields.size() == 1 && fields[0].empty()) continue;
    const std::string place = name + ":" + std::to_string(line);
    if (csv.header.empty()) {
      check_header(fields, place);
      csv.header = std::move(fields);
      continue;
    }
    if (fields.size() != csv.header.size())
      throw Error(
          Exit::data, place,
          "has " + std::to_string(fields.size()) + " fields, the header names " + std::to_string(csv.header.size()),
          "give every row one field for each column, separated by commas");
    csv.rows.push_back(std::move(fields));
    csv.line.push_back(line);
  }
  if (csv.header.empty()) throw Error(Exit::data, name, "is empty", "the first line names the columns");
  if (csv.rows.empty()) throw Error(Exit::data, name, "has a header and no rows");
  return csv;
}

Csv read_csv(const std::filesystem::path& path) {
  return parse_csv(read_file(path), path.filename().string());
}

double csv_number(const std::string& text, const std::string& place) {
  double value = 0;
  const char* first = text.data();
  if (text.starts_with('+')) ++first;
  const auto [end, failure] = std::from_chars(first, text.data() + text.size(), value);
  if (failure != std::errc() || end != text.data() + text.size() || text.empty())
    throw Error(Exit::data, place, "\"" + text + "\" is no number", "write decimal points, no units, no thousands");
  if (!std::isfinite(value)) throw Error(Exit::data, place, "\"" + text + "\" is not finite", "leave the row out");
  return value;
}

}  // namespace gonio::io
