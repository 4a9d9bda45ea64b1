// See pose_lines.h: poses as cameras' and robots' tools print them,
//
//   Rotation:                 Rotation matrix = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
//   0 -1 0                    Translation vector (mm) = [500; -250; 1500]
//   1  0 0
//   0  0 1                    each followed by the next pose; the two in either order, numbers beside the label
//   Translation:              or below it, in rows or in a column.
//   500 -250 1500
//
// Lines that are neither label nor numbers name the pose that follows: "Pose 7", "view_07.png".
#include <algorithm>
#include <cctype>
#include <iterator>
#include <set>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "robot/pose_lines.h"

namespace gonio::robot {
namespace {

enum class Part { rotation, translation };

struct Label {
  Part part = Part::rotation;
  std::string length;  // the unit that it states
  std::string rest;    // numbers beside it
};

std::string lower_text(std::string_view text) {
  std::string lowered(text);
  std::ranges::transform(lowered, lowered.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lowered;
}

// Words of letters, lower-case; digits and signs separate.
std::vector<std::string> words_of_label(std::string_view text) {
  std::vector<std::string> words;
  bool open = false;
  for (const char c : lower_text(text)) {
    const bool letter = std::isalpha(static_cast<unsigned char>(c)) != 0;
    if (letter && !open) words.emplace_back();
    if (letter) words.back() += c;
    open = letter;
  }
  return words;
}

std::string trimmed(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t\"'"), last = line.find_last_not_of(" \t\r\"':-=");
  return first == std::string::npos || last == std::string::npos || last < first ? ""
                                                                                 : line.substr(first, last + 1 - first);
}

// "Pose 7", "view_07.png" of "Image: view_07.png".
std::string name_in(const std::string& line) {
  const std::string text = trimmed(line);
  const std::size_t mark = text.find_last_of(":=");
  return mark == std::string::npos || text.find_first_of(" \t", mark) != mark + 1 ? text
                                                                                  : trimmed(text.substr(mark + 1));
}

std::size_t words_between_blanks(const std::string& text) {
  std::istringstream stream(text);
  return static_cast<std::size_t>(
      std::distance(std::istream_iterator<std::string>(stream), std::istream_iterator<std::string>()));
}

std::string without_comment(std::string_view line) {
  for (const std::string_view mark : {"#", "%", "//"}) line = line.substr(0, line.find(mark));
  return std::string(line);
}

// "Rotation", "rotation matrix:", "R =", "Translation vector (mm): 1 2 3"; none for everything else.
std::optional<Label> label_of(const std::string& line) {
  static const std::set<std::string> rotations{"rotation", "rot", "r"}, translations{"translation", "trans", "t"},
      further{"matrix", "vector", "part", "mat", "vec", "rotation", "translation"};
  const std::size_t mark = line.find_first_of(":=");
  const std::vector<std::string> words = words_of_label(line.substr(0, mark));
  if (words.empty()) return {};
  const bool rotation = rotations.contains(words[0]), translation = translations.contains(words[0]);
  if (!rotation && !translation) return {};
  const bool letter = words[0].size() == 1;  // "R:", but "R2: ..." is a name
  if (letter && (mark == std::string::npos || trimmed(line.substr(0, mark)).size() != 1)) return {};
  Label label{rotation ? Part::rotation : Part::translation, {}, {}};
  for (std::size_t i = 1; i < words.size(); ++i) {
    const bool unit = words[i] == "m" || words[i] == "cm" || words[i] == "mm";
    if (unit) label.length = words[i];
    if (!unit && mark == std::string::npos && !further.contains(words[i])) return {};  // a sentence
  }
  if (mark != std::string::npos) {
    label.rest = line.substr(mark + 1);
  } else if (const std::size_t digit = line.find_first_of("0123456789[-+."); digit != std::string::npos) {
    const std::string rest = line.substr(digit);
    if (words_between_blanks(rest) >= 3) label.rest = rest;  // else the number of the pose: "Rotation 7"
  }
  return label;
}

// A line of a list never begins like this: its first field is a name without a colon, or a number.
bool has_blocks(std::string_view text) {
  bool rotation = false, translation = false;
  while (!text.empty() && !(rotation && translation)) {
    const std::size_t end = text.find('\n');
    if (const auto label = label_of(without_comment(text.substr(0, end))))
      (label->part == Part::rotation ? rotation : translation) = true;
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return rotation || translation;
}

struct Block {
  Label label;
  std::vector<double> numbers;
  std::string place, name;  // name: of the pose, from the lines before it
  bool closed = false;      // by a line of words
  std::size_t most() const { return label.part == Part::rotation ? 9 : 3; }
};

void add_numbers(const std::string& text, const std::string& place, Block& block) {
  for (const std::string& field : fields_of_line(bare_line(text), place))
    block.numbers.push_back(finite_number(field, place));
}

std::vector<Block> blocks_of(std::string_view text, const std::string& file) {
  std::vector<Block> blocks;
  std::string name;
  int count = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string line = without_comment(text.substr(0, end)), place = file + ":" + std::to_string(++count);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (const std::optional<Label> label = label_of(line)) {
      blocks.push_back({*label, {}, place, std::exchange(name, {})});
      add_numbers(label->rest, place, blocks.back());
      continue;
    }
    const std::vector<std::string> fields = fields_of_line(bare_line(line), place);
    if (fields.empty()) continue;
    const bool begins = number_of_field(fields[0]).has_value(), open = !blocks.empty() && !blocks.back().closed;
    if (begins && open && blocks.back().numbers.size() < blocks.back().most()) {
      add_numbers(line, place, blocks.back());
    } else if (begins && fields.size() > 1) {
      throw Error(Exit::data, place, "numbers that belong to neither a rotation nor a translation",
                  "a rotation has three rows of three, a translation three numbers");
    } else {  // words, or the number of the pose
      name = name_in(line);
      if (open) blocks.back().closed = true;
    }
  }
  return blocks;
}

NumberLine line_of(const Block& rotation, const Block& translation, const Block& first) {
  const std::vector<double>&r = rotation.numbers, &t = translation.numbers;
  if (t.size() != 3)
    throw Error(Exit::data, translation.place, "a translation of " + std::to_string(t.size()) + " numbers",
                "it has three");
  if (r.size() != 9 && r.size() != 3 && r.size() != 4)
    throw Error(Exit::data, rotation.place, "a rotation of " + std::to_string(r.size()) + " numbers",
                "a matrix has nine, a quaternion four, angles and rotation vectors three");
  NumberLine line{{}, first.name, first.place, translation.label.length};
  if (r.size() == 9)
    line.numbers = {r[0], r[1], r[2], t[0], r[3], r[4], r[5], t[1], r[6], r[7], r[8], t[2], 0, 0, 0, 1};
  else
    line.numbers = {t[0], t[1], t[2]}, line.numbers.insert(line.numbers.end(), r.begin(), r.end());
  return line;
}

}  // namespace

std::vector<NumberLine> pose_lines(std::string_view text, const std::string& file) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // byte order mark
  if (!has_blocks(text)) return number_lines(text, file);
  const std::vector<Block> blocks = blocks_of(text, file);
  std::vector<NumberLine> lines;
  for (std::size_t i = 0; i < blocks.size(); i += 2) {
    const Block& first = blocks[i];
    const bool rotation_first = first.label.part == Part::rotation;
    if (i + 1 == blocks.size() || blocks[i + 1].label.part == first.label.part)
      throw Error(Exit::data, first.place,
                  rotation_first ? "a rotation without a translation" : "a translation without a rotation",
                  "copy the whole file");
    const Block& second = blocks[i + 1];
    lines.push_back(rotation_first ? line_of(first, second, first) : line_of(second, first, first));
  }
  return lines;
}

}  // namespace gonio::robot
