// See cell_memo.h.
#include "explain/images/cell_memo.h"

#include <algorithm>

namespace gonio::explain::images {

std::shared_ptr<const CellMemo::Values> CellMemo::of(std::span<const double> values,
                                                     std::span<const std::size_t> columns, std::size_t image,
                                                     const std::function<Values()>& made) const {
  constexpr std::size_t most = 6;  // folds that are fitted at once, and a little more
  const auto is_it = [&](const Entry& e) {
    return e.image == image && std::ranges::equal(e.columns, columns) && std::ranges::equal(e.values, values);
  };
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = std::ranges::find_if(entries_, is_it); known != entries_.end()) {
      entries_.splice(entries_.begin(), entries_, known);
      return known->result;
    }
  }
  auto result = std::make_shared<const Values>(made());
  const std::lock_guard lock(mutex_);
  entries_.push_front({{values.begin(), values.end()}, {columns.begin(), columns.end()}, image, result});
  if (entries_.size() > most) entries_.pop_back();
  return result;
}

}  // namespace gonio::explain::images
