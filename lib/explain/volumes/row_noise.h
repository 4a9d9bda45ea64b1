// Noise of readings from their neighbours, and groups of readings that have no neighbours in common. Private to
// volumes/.
#pragma once
#include <utility>
#include <vector>

#include "explain/volumes/observed.h"

namespace gonio::explain::volumes {

// Scales the sigma of each kind of reading, so that it is that of the difference from six neighbours; takes out what
// lies beyond six such widths of its neighbours' median, and returns its number.
std::size_t settle_row_noise(std::vector<Row>& rows, double voxel_m);
// Sixteen blocks of space with as many readings each, within them cells of eight voxels; sorts the rows by group.
std::pair<std::size_t, std::size_t> group_rows(std::vector<Row>& rows, double voxel_m);

}  // namespace gonio::explain::volumes
