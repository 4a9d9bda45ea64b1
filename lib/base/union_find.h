// What is joined to what: items numbered from 0, in groups that only grow (Tarjan 1975; paths are halved on the way). A
// group's name is its smallest item, whatever the order of the joins.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace gonio {

class UnionFind {
 public:
  explicit UnionFind(std::size_t items = 0) : parent_(items) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t make() {  // one more item, a group of its own
    parent_.push_back(static_cast<std::uint32_t>(parent_.size()));
    return parent_.back();
  }
  std::uint32_t group(std::uint32_t item) {
    while (parent_[item] != item) item = parent_[item] = parent_[parent_[item]];
    return item;
  }
  bool join(std::uint32_t a, std::uint32_t b) {  // were they apart?
    a = group(a);
    b = group(b);
    parent_[std::max(a, b)] = std::min(a, b);
    return a != b;
  }
  std::size_t size() const { return parent_.size(); }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace gonio
