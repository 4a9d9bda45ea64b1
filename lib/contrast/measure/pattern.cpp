// Patterns of cells, and reading of their bits (contrast/measure/pattern.h).
#include "contrast/measure/pattern.h"

#include <algorithm>
#include <sstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/picture.h"

namespace gonio::contrast {

Vec2 CellPattern::corner_m(int k) const {
  const Vec2 size = size_m();
  return {k == 1 || k == 2 ? size.x : 0.0, k >= 2 ? size.y : 0.0};
}

Vec2 CellPattern::middle_m(std::size_t cell) const {
  const auto wide = static_cast<std::size_t>(columns);
  return {(static_cast<double>(cell % wide) + 0.5) * cell_m.x, (static_cast<double>(cell / wide) + 0.5) * cell_m.y};
}

Vec2 CellPattern::place(std::size_t cell) const {
  const Vec2 at = middle_m(cell), size = size_m();
  return {2 * at.x / size.x - 1, 2 * at.y / size.y - 1};
}

Bits parse_bits(const std::string& text, const std::string& name) {
  Bits read;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (line.starts_with('%')) continue;
    const std::string place = name + ":" + std::to_string(number);
    std::vector<std::uint8_t> row;
    for (const char c : line) {
      if (std::string(" \t\r,;").find(c) != std::string::npos) continue;
      const bool one = std::string("1#X").find(c) != std::string::npos;
      if (!one && std::string("0._").find(c) == std::string::npos)
        throw Error(Exit::data, place, std::string("has the character '") + c + "' in a pattern",
                    "1, # and X are cells of bit 1; 0, . and _ of bit 0");
      row.push_back(one);
    }
    if (row.empty()) continue;
    if (read.rows > 0 && static_cast<int>(row.size()) != read.columns)
      throw Error(Exit::data, place,
                  "has " + std::to_string(row.size()) + " cells, the rows above have " + std::to_string(read.columns),
                  "give every row of the pattern as many cells");
    read.columns = static_cast<int>(row.size());
    ++read.rows;
    read.bits.insert(read.bits.end(), row.begin(), row.end());
  }
  if (read.rows == 0)
    throw Error(Exit::data, name, "holds no pattern", "write one line of 0 and 1 for each row of cells");
  return read;
}

Bits read_bits(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension.empty() || extension == ".txt" || extension == ".csv")
    return parse_bits(read_file(path, 1 << 24), path.string());
  const io::Image picture = io::read_picture(path);
  Bits read{picture.height, picture.width, std::vector<std::uint8_t>(picture.pixels())};
  for (std::size_t i = 0; i < read.bits.size(); ++i) read.bits[i] = picture.data[i * picture.channels.size()] > 0.5f;
  return read;
}

Bits turned(const Bits& bits, int quarter_turns) {
  Bits from = bits;
  for (int turn = 0; turn < ((quarter_turns % 4) + 4) % 4; ++turn) {
    Bits to{from.columns, from.rows, std::vector<std::uint8_t>(from.bits.size())};
    for (int row = 0; row < to.rows; ++row)  // what stood at the left stands at the top
      for (int column = 0; column < to.columns; ++column)
        to.bits[static_cast<std::size_t>(row * to.columns + column)] =
            from.bits[static_cast<std::size_t>((from.rows - 1 - column) * from.columns + row)];
    from = std::move(to);
  }
  return from;
}

}  // namespace gonio::contrast
