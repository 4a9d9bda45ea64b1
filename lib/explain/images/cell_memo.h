// Cells of one picture are simulated together: what one of them asked for, the others take from here.
#pragma once
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace gonio::explain::images {

class CellMemo {
 public:
  using Values = std::vector<double>;
  // What `made` gives for these values, columns and image: made anew where it is not remembered. Several threads may
  // ask at once; two that ask for the same at the same moment both make it.
  std::shared_ptr<const Values> of(std::span<const double> values, std::span<const std::size_t> columns,
                                   std::size_t image, const std::function<Values()>& made) const;

 private:
  struct Entry {
    std::vector<double> values;
    std::vector<std::size_t> columns;
    std::size_t image = 0;
    std::shared_ptr<const Values> result;
  };
  mutable std::mutex mutex_;
  mutable std::list<Entry> entries_;  // the latest first
};

}  // namespace gonio::explain::images
