// Pictures cut into cells: where there are few pictures, a cell is what can be left out and predicted from the rest.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace gonio::relighting {

// Into how many cells each of `pictures` pictures is cut where fewer than `enough` of them are too few; 1: not at all.
// Some twelve in all.
std::size_t cells_each(std::size_t pictures, std::size_t enough);

// Places in `pixels` (x, y), cell by cell: columns of about as many pixels, each cut across. At most `cells`, none of
// them with fewer than `least` pixels, but where there is one alone; within a cell from the top, then from the left.
std::vector<std::vector<std::size_t>> cells_of(std::span<const std::array<int, 2>> pixels, std::size_t cells,
                                               std::size_t least = 40);

}  // namespace gonio::relighting
