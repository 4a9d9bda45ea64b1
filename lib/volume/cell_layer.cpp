#include "volume/cell_layer.h"

#include <array>

#include "base/parallel.h"

namespace gonio::volume {
namespace {

// The four rows of bits round a row of cells, one word at a time; `shifted` has the next sample's bits.
struct WordsRound {
  std::array<std::uint64_t, 4> at{}, shifted{};
  // Bit i: the eight samples of cell i are not all on one side.
  std::uint64_t crossed() const {
    std::uint64_t any = 0, all = ~std::uint64_t{0};
    for (std::size_t n = 0; n < 4; ++n) {
      any |= at[n] | shifted[n];
      all &= at[n] & shifted[n];
    }
    return any & ~all;
  }
};

using FourRows = std::array<const std::uint64_t*, 4>;

WordsRound words_round(const FourRows& rows, std::size_t word, std::size_t words) {
  WordsRound round;
  for (std::size_t n = 0; n < 4; ++n) {
    round.at[n] = rows[n][word];
    round.shifted[n] = rows[n][word] >> 1 | (word + 1 < words ? rows[n][word + 1] << 63 : 0);
  }
  return round;
}

}  // namespace

void find_cells(const SampleWindow& window, std::size_t layer, std::uint8_t flip, CellLayer& found) {
  const std::size_t rows = found.rows(), words = window.words();
  const auto four = [&](std::size_t row) {
    return FourRows{window.bits(row, layer), window.bits(row + 1, layer), window.bits(row, layer + 1),
                    window.bits(row + 1, layer + 1)};
  };
  found.row_first[0] = 0;
  const auto count = [&](std::size_t row) {
    const FourRows round = four(row);
    int cells = 0;
    for (std::size_t w = 0; w < words; ++w) {
      if ((round[0][w] | round[1][w] | round[2][w] | round[3][w]) == 0 &&
          (w + 1 == words || ((round[0][w + 1] | round[1][w + 1] | round[2][w + 1] | round[3][w + 1]) & 1) == 0))
        continue;
      cells += std::popcount(words_round(round, w, words).crossed());
    }
    found.row_first[row + 1] = static_cast<std::uint32_t>(cells);
  };
  parallel_for(0, rows, count, rows_at_once);
  for (std::size_t row = 0; row < rows; ++row) found.row_first[row + 1] += found.row_first[row];
  found.cells.assign(found.row_first[rows], Cell{});
  const auto fill = [&](std::size_t row) {
    const FourRows round = four(row);
    std::uint32_t next = found.row_first[row];
    for (std::size_t w = 0; next < found.row_first[row + 1]; ++w) {
      const WordsRound here = words_round(round, w, words);
      for (std::uint64_t left = here.crossed(); left != 0; left &= left - 1) {
        const int bit = std::countr_zero(left);
        unsigned mask = 0;
        for (std::size_t n = 0; n < 4; ++n)
          mask |= static_cast<unsigned>((here.at[n] >> bit & 1) | (here.shifted[n] >> bit & 1) << 1) << (2 * n);
        const std::size_t column = 64 * w + static_cast<std::size_t>(bit);
        found.place[row * found.columns + column] = next;
        Cell& cell = found.cells[next++];
        cell.column = static_cast<std::uint16_t>(column);
        cell.mask = static_cast<std::uint8_t>(mask ^ flip);
      }
    }
  };
  if (!found.cells.empty()) parallel_for(0, rows, fill, rows_at_once);
}

}  // namespace gonio::volume
