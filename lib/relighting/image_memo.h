// The last few values of every image that were computed at a key and for certain pixels: fits ask for one state several
// times over. Safe for several threads.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace gonio::relighting {

template <class Value>
class ImageMemo {
 public:
  explicit ImageMemo(std::size_t images) : of_image_(images) {}
  // Null where it is not among the last few. Keys agree by their bits: a NaN equals itself.
  std::shared_ptr<const Value> find(std::size_t image, const std::vector<double>& key,
                                    std::span<const std::uint32_t> picked) const {
    const std::lock_guard lock(mutex_);
    for (const Entry& e : of_image_[image])
      if (e.key.size() == key.size() && std::memcmp(e.key.data(), key.data(), key.size() * sizeof(double)) == 0 &&
          std::ranges::equal(e.picked, picked))
        return e.value;
    return nullptr;
  }
  void keep(std::size_t image, std::vector<double> key, std::span<const std::uint32_t> picked,
            std::shared_ptr<const Value> value) {
    const std::lock_guard lock(mutex_);
    std::vector<Entry>& entries = of_image_[image];
    entries.insert(entries.begin(), {std::move(key), {picked.begin(), picked.end()}, std::move(value)});
    if (entries.size() > kept) entries.pop_back();
  }

 private:
  static constexpr std::size_t kept = 3;  // of an image
  struct Entry {
    std::vector<double> key;
    std::vector<std::uint32_t> picked;
    std::shared_ptr<const Value> value;
  };
  std::vector<std::vector<Entry>> of_image_;  // the last one first
  mutable std::mutex mutex_;
};

}  // namespace gonio::relighting
