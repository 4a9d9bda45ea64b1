// Groups of the image domain: images, or cells of one or two images.
#include "relighting/cells.h"

#include <algorithm>

#include "base/text.h"
#include "explain/images/images_problem.h"

namespace gonio::explain::images {
namespace {

constexpr std::size_t enough_images = 3;  // of fewer, one cannot be left out and predicted from others

}  // namespace

// Pixels of a cell follow each other in the view's cache.
std::vector<std::array<int, 2>> ImagesProblem::in_cells(std::size_t view,
                                                        const std::vector<std::array<int, 2>>& chosen) {
  const std::size_t cells = relighting::cells_each(recordings_.images.size(), enough_images);
  if (cells == 1) return chosen;
  cell_of_.resize(recordings_.views.size());
  std::vector<std::array<int, 2>> in_order;
  std::uint32_t number = 0;
  for (const std::vector<std::size_t>& cell : relighting::cells_of(chosen, cells)) {
    for (const std::size_t p : cell) in_order.push_back(chosen[p]), cell_of_[view].push_back(number);
    ++number;
  }
  return in_order;
}

// Groups of an image whose pixels are picked, and where their rows will begin.
void ImagesProblem::open_groups(std::size_t image) {
  const Recording& recording = recordings_.images[image];
  const std::vector<std::uint32_t>& mine = picked_[image];
  const std::size_t before = groups_.size();
  if (cell_of_.empty()) {
    groups_.push_back({image, 0, 3 * mine.size(), true});
  } else {
    const std::vector<std::uint32_t>& cells = cell_of_[recording.view];
    for (std::size_t i = 0; i < mine.size(); ++i) {
      if (i == 0 || cells[mine[i]] != cells[mine[i - 1]]) groups_.push_back({image, 3 * i, 3 * i, false});
      groups_.back().end = 3 * (i + 1);
    }
  }
  for (std::size_t g = before; g < groups_.size(); ++g) {
    observations_.first.push_back(observations_.first.back() + groups_[g].end - groups_[g].first);
    observations_.group.push_back(groups_[g].whole ? recording.id
                                                   : recording.id + format(", part %zu", g - before + 1));
  }
}

// What was bound to images acts on all their cells.
void ImagesProblem::numbers_act_on_cells() {
  if (cell_of_.empty()) return;
  for (Parameter& p : parameters_) {
    if (p.groups.empty()) continue;
    std::vector<std::size_t> cells;
    for (std::size_t g = 0; g < groups_.size(); ++g)
      if (std::ranges::binary_search(p.groups, groups_[g].image)) cells.push_back(g);
    p.groups = std::move(cells);
  }
}

}  // namespace gonio::explain::images
