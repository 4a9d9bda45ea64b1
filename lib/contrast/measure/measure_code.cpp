// Reading a data matrix from the cells' brightness (contrast/measure/measure_code.h).
#include "contrast/measure/measure_code.h"

#include <algorithm>
#include <cmath>

#include "contrast/measure/matrix_code.h"

namespace gonio::contrast {
namespace {

Bits stood(const Bits& cells, Standing standing) {
  Bits modules = turned(cells, -standing.quarter_turns);
  if (standing.inverted)
    for (std::uint8_t& bit : modules.bits) bit = !bit;
  return modules;
}

Bits laid(const Bits& modules, Standing standing) {
  Bits cells = turned(modules, standing.quarter_turns);
  if (standing.inverted)
    for (std::uint8_t& bit : cells.bits) bit = !bit;
  return cells;
}

// By the finder: of the eight ways the one that shows most of its modules.
Standing standing_of(const Bits& cells) {
  Standing best;
  double most = -1;
  for (int turn = 0; turn < 4; ++turn)
    for (const bool inverted : {false, true}) {
      const double share = finder_share(stood(cells, {turn, inverted}));
      if (share <= most) continue;
      most = share;
      best = {turn, inverted};
    }
  return best;
}

// Where between the two classes a cell lies: -1 on that of bit 0, +1 on that of bit 1.
std::vector<double> side(const MeasuredView& view, const CellPattern& pattern) {
  std::vector<double> sides(pattern.cells(), 0);
  for (std::size_t cell = 0; cell < sides.size(); ++cell) {
    const double ratio = view.ratio[cell];
    if (!std::isfinite(ratio)) continue;
    const double one = view.bright.value, zero = view.dark.value;
    const double value = ratio * (pattern.bits[cell] == 1 ? one : zero);
    sides[cell] = std::clamp((2 * value - one - zero) / (one - zero), -2.0, 2.0);
  }
  return sides;
}

Bits bits_of(const CellPattern& pattern, const std::vector<double>& sides) {
  Bits bits{pattern.rows, pattern.columns, std::vector<std::uint8_t>(pattern.cells())};
  for (std::size_t cell = 0; cell < sides.size(); ++cell) bits.bits[cell] = sides[cell] > 0;
  return bits;
}

}  // namespace

void settle_code(CellPattern& pattern) {
  const Bits cells{pattern.rows, pattern.columns, pattern.bits};
  const Standing standing = standing_of(cells);
  const auto code = read_matrix(stood(cells, standing));
  // Solid modules are bit 1: what was taken for 1 only because it was the brighter one is turned over.
  if (code) pattern.bits = laid(code->modules, {standing.quarter_turns, false}).bits;
}

std::optional<MeasuredCode> measured_code(const Measured& result) {
  const CellPattern& pattern = result.pattern;
  const Standing standing = standing_of({pattern.rows, pattern.columns, pattern.bits});
  std::vector<double> sum(pattern.cells(), 0);
  int views_read = 0;
  std::optional<MatrixCode> first;
  for (const MeasuredView& view : result.views) {
    const auto sides = side(view, pattern);
    const double weight = std::pow(view.michelson.value / std::max(view.michelson.sigma, 1e-12), 2);
    for (std::size_t cell = 0; cell < sum.size(); ++cell) sum[cell] += weight * sides[cell];
    const auto alone = read_matrix(stood(bits_of(pattern, sides), standing));
    views_read += alone.has_value();
    if (alone && !first) first = alone;
  }
  const Bits observed = bits_of(pattern, sum);
  auto code = read_matrix(stood(observed, standing));
  if (!code) code = first;
  if (!code) return std::nullopt;
  const Bits right = laid(code->modules, standing);
  MeasuredCode measured{code->text, 0, standing.quarter_turns, standing.inverted, views_read};
  for (std::size_t cell = 0; cell < right.bits.size(); ++cell)
    measured.wrong_modules += right.bits[cell] != observed.bits[cell];
  return measured;
}

}  // namespace gonio::contrast
