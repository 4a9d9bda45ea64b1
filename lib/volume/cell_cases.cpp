#include "volume/cell_cases.h"

#include <bit>

namespace gonio::volume {
namespace {

constexpr std::uint8_t no_edge = 255;

bool in_mask(int mask, int corner) {
  return (mask >> corner & 1) != 0;
}

// Corners of a face, counter-clockwise seen from outside the cell.
std::array<int, 4> corners_round(int face) {
  const int axis = face / 2, side = face % 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  const int base = side << axis;
  const std::array<int, 4> seen_from_above{base, base | 1 << u, base | 1 << u | 1 << v, base | 1 << v};
  if (side == 1) return seen_from_above;
  return {seen_from_above[0], seen_from_above[3], seen_from_above[2], seen_from_above[1]};
}

int edge_between(int a, int b) {
  return cell_edge(std::countr_zero(static_cast<unsigned>(a ^ b)), a & b);
}

// Segments run from the edge where a walk round the face enters a run of S to the one where it leaves it: seen from
// outside the cell S lies on their right. The neighbouring face passes the same edge the other way: what leaves here
// enters there, so that segments join head to tail.
void add_segments(CellCase& made, int mask, int face) {
  const std::array<int, 4> round = corners_round(face);
  int crossed = 0;
  for (unsigned n = 0; n < 4; ++n) {
    const int before = round[n], at = round[(n + 1) % 4];
    if (in_mask(mask, before) == in_mask(mask, at)) continue;
    ++crossed;
    if (!in_mask(mask, at)) continue;
    unsigned last = n + 1;
    while (in_mask(mask, round[(last + 1) % 4])) ++last;
    const auto entered = static_cast<unsigned>(edge_between(before, at));
    made.next[entered] = static_cast<std::uint8_t>(edge_between(round[last % 4], round[(last + 1) % 4]));
    made.next_face[entered] = static_cast<std::uint8_t>(face);
  }
  if (crossed == 4) made.ambiguous = static_cast<std::uint8_t>(made.ambiguous | 1 << face);
}

// The corners of S that are joined with `corner` along edges.
int component(int mask, int corner) {
  int found = 1 << corner;
  for (int before = 0; before != found;) {
    before = found;
    for (int c = 0; c < 8; ++c)
      for (int axis = 0; in_mask(found, c) && axis < 3; ++axis) found |= mask & 1 << (c ^ 1 << axis);
  }
  return found;
}

// plane . x = sum of the coordinates along `axes` counted from `corner`, minus a constant that goes into the bound.
void separate(Sheet& sheet, int corner, int axes, bool below) {
  int bound = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if ((axes >> axis & 1) == 0) continue;
    const bool flipped = in_mask(corner, axis);
    sheet.plane[static_cast<unsigned>(axis)] = flipped ? -1 : 1;
    if (flipped) --bound;
  }
  if (!below) {
    for (std::int8_t& p : sheet.plane) p = static_cast<std::int8_t>(-p);
    bound = -bound;
  }
  sheet.bound = static_cast<std::int8_t>(bound);
}

void separate(CellCase& made, const std::array<int, 4>& components) {
  int lone = -1;
  for (unsigned s = 0; s < made.sheets; ++s)
    if (std::has_single_bit(static_cast<unsigned>(components[s])))
      lone = std::countr_zero(static_cast<unsigned>(components[s]));
  for (unsigned s = 0; s < made.sheets; ++s) {
    const auto own = static_cast<unsigned>(components[s]);
    const int first = std::countr_zero(own);
    if (std::has_single_bit(own)) {
      separate(made.sheet[s], first, 7, true);
    } else if (lone >= 0) {
      separate(made.sheet[s], lone, 7, false);
    } else {
      const int along = first ^ std::countr_zero(own & (own - 1));  // of the pair's edge, as a mask of axes
      separate(made.sheet[s], first, 7 & ~along, true);
    }
  }
}

CellCase made_case(int mask) {
  CellCase made;
  made.next.fill(no_edge);
  for (int face = 0; face < 6; ++face) add_segments(made, mask, face);
  std::array<int, 4> components{};
  std::array<bool, 12> seen{};
  int all = 0;
  for (unsigned start = 0; start < 12; ++start) {
    if (made.next[start] == no_edge || seen[start]) continue;
    const int low = lower_corner(static_cast<int>(start));
    const int own = component(mask, in_mask(mask, low) ? low : upper_corner(static_cast<int>(start)));
    if ((all & own) != 0) {  // a second loop of one component
      made.tunnel = made.shared = made.marked = true;
      made.sheets = 0;
      return made;
    }
    all |= own;
    Sheet& sheet = made.sheet[made.sheets];
    for (unsigned edge = start; !seen[edge]; edge = made.next[edge]) {
      seen[edge] = true;
      made.sheet_of[edge] = made.sheets;
      sheet.edges[sheet.count++] = static_cast<std::uint8_t>(edge);
    }
    components[made.sheets++] = own;
  }
  made.shared = made.sheets > 1;
  made.marked = made.shared || made.ambiguous != 0;
  if (made.shared) separate(made, components);
  return made;
}

}  // namespace

const std::array<CellCase, 256>& cell_cases() {
  static const std::array<CellCase, 256> all = [] {
    std::array<CellCase, 256> made;
    for (unsigned mask = 0; mask < 256; ++mask) made[mask] = made_case(static_cast<int>(mask));
    return made;
  }();
  return all;
}

}  // namespace gonio::volume
