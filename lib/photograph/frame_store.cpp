// See frame_store.h.
#include "photograph/frame_store.h"

#include <algorithm>
#include <atomic>
#include <limits>

#include "base/parallel.h"

namespace gonio::photograph {

FrameStore::Kept FrameStore::packed(RawFrame frame) {
  constexpr float most = std::numeric_limits<std::uint16_t>::max();
  Kept kept;
  std::vector<float> codes = std::move(frame.codes);
  frame.codes.clear();
  kept.head = std::move(frame);
  if (codes.empty()) return kept;
  kept.least = *std::ranges::min_element(codes);
  kept.whole.resize(codes.size());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const float above = codes[i] - kept.least;
    const bool holds = above >= 0 && above <= most;  // not for what is no number
    kept.whole[i] = static_cast<std::uint16_t>(holds ? above : 0);
    if (!holds || kept.least + static_cast<float>(kept.whole[i]) != codes[i]) {
      kept.whole = {}, kept.other = std::move(codes);
      break;
    }
  }
  return kept;
}

FrameStore::FrameStore(std::vector<StoredFrame> frames, std::size_t most_bytes)
    : frames_(std::move(frames)), kept_(frames_.size()) {
  std::atomic<std::size_t> used = 0;
  parallel_for(0, frames_.size(), [&](std::size_t k) {
    Kept kept = packed(read_raw_frame(frames_[k].path, frames_[k].stated));
    const std::size_t bytes = kept.whole.size() * sizeof(std::uint16_t) + kept.other.size() * sizeof(float);
    if (used.fetch_add(bytes) + bytes > most_bytes) {
      used -= bytes;
      kept.whole = {}, kept.other = {};
    }
    kept_[k] = std::move(kept);
  });
}

std::vector<float> FrameStore::codes(std::size_t k) const {
  const Kept& kept = kept_[k];
  if (kept.whole.empty() && kept.other.empty()) return read_raw_frame(frames_[k].path, frames_[k].stated).codes;
  std::vector<float> codes;
  rows(k, 0, kept.head.height, codes);
  return codes;
}

bool FrameStore::holds_all() const {
  return std::ranges::none_of(kept_, [](const Kept& kept) { return kept.whole.empty() && kept.other.empty(); });
}

void FrameStore::rows(std::size_t k, int first, int count, std::vector<float>& into) const {
  const Kept& kept = kept_[k];
  const auto columns = static_cast<std::size_t>(kept.head.width), from = static_cast<std::size_t>(first) * columns;
  into.resize(static_cast<std::size_t>(count) * columns);
  if (kept.whole.empty()) {
    std::copy_n(kept.other.begin() + static_cast<std::ptrdiff_t>(from), into.size(), into.begin());
    return;
  }
  const std::uint16_t* whole = &kept.whole[from];
  float* codes = into.data();
  for (std::size_t i = 0; i < into.size(); ++i) codes[i] = kept.least + static_cast<float>(whole[i]);
}

}  // namespace gonio::photograph
