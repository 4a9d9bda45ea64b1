// Raw frames of one view, decoded side by side and kept, so that passes over them need not decode again: in two bytes a
// sample where that loses nothing (whole codes), else in four. What does not fit into the bytes that are granted is
// decoded at every reading. What is read is the same either way.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "photograph/raw_frame.h"

namespace gonio::photograph {

struct StoredFrame {
  std::filesystem::path path;
  RawStated stated;
};

class FrameStore {
 public:
  FrameStore() = default;
  // Decodes all. Errors as read_raw_frame; of several the first frame's.
  FrameStore(std::vector<StoredFrame> frames, std::size_t most_bytes);

  std::size_t size() const { return frames_.size(); }
  const RawFrame& head(std::size_t k) const { return kept_[k].head; }  // without its codes
  const std::filesystem::path& path(std::size_t k) const { return frames_[k].path; }
  std::vector<float> codes(std::size_t k) const;  // black taken off, row by row
  bool holds_all() const;
  // Of frames that are held: codes of some rows.
  void rows(std::size_t k, int first, int count, std::vector<float>& into) const;

 private:
  struct Kept {
    RawFrame head;
    float least = 0;                   // code that stands for 0 in `whole`
    std::vector<std::uint16_t> whole;  // both empty: not kept
    std::vector<float> other;
  };
  static Kept packed(RawFrame frame);

  std::vector<StoredFrame> frames_;
  std::vector<Kept> kept_;
};

}  // namespace gonio::photograph
