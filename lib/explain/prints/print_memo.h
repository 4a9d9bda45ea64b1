// Simulated surfaces that were asked for lately: every patch of a print asks for the same one.
#pragma once
#include <algorithm>
#include <deque>
#include <future>
#include <memory>
#include <mutex>
#include <vector>

#include "explain/prints/printed_field.h"

namespace gonio::explain::prints {

// From a key to what `make` makes of it. From several threads at once; each value is made once while it is kept.
template <class Value>
class Memo {
 public:
  explicit Memo(std::size_t most) : most_(most) {}
  template <class Make>
  std::shared_ptr<const Value> at(const std::vector<double>& key, const Make& make) const {
    std::promise<std::shared_ptr<const Value>> promise;
    std::shared_future<std::shared_ptr<const Value>> future;
    {
      const std::lock_guard lock(mutex_);
      const auto found = std::ranges::find(kept_, key, &Kept::first);
      if (found != kept_.end()) {
        future = found->second;
        std::rotate(kept_.begin(), found, found + 1);
      } else {
        kept_.emplace_front(key, promise.get_future().share());
        if (kept_.size() > most_) kept_.pop_back();
      }
    }
    if (future.valid()) return future.get();
    try {
      auto value = std::make_shared<const Value>(make());
      promise.set_value(value);
      return value;
    } catch (...) {
      promise.set_exception(std::current_exception());
      throw;
    }
  }

 private:
  std::size_t most_;
  mutable std::mutex mutex_;
  using Kept = std::pair<std::vector<double>, std::shared_future<std::shared_ptr<const Value>>>;
  mutable std::deque<Kept> kept_;  // the latest first
};

}  // namespace gonio::explain::prints
