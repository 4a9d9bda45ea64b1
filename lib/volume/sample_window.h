// The few slices of a volume that a step works on, with their samples above the threshold as bits. Slices are read
// once, in order, and ahead of the work where there is a second thread.
#pragma once
#include <cstddef>
#include <cstdint>
#include <future>
#include <vector>

#include "io/volume.h"

namespace gonio::volume {

// The largest float that is not above `threshold`: a float exceeds the one exactly where it exceeds the other.
float float_threshold(double threshold);

// Bit i + 1 of `bits` (words of 64) says values[i] > threshold, for 0 <= i < count; every other bit is zero.
void bits_above(const float* values, std::size_t count, float threshold, std::uint64_t* bits, std::size_t words);

class SampleWindow {
 public:
  // The last `kept` slices stay available.
  SampleWindow(io::VolumeSource& source, double threshold, std::size_t kept);
  ~SampleWindow();
  SampleWindow(const SampleWindow&) = delete;
  SampleWindow& operator=(const SampleWindow&) = delete;

  // Makes slices up to `last` available. Never backwards.
  void advance_to(std::size_t last);
  const float* row(std::size_t j, std::size_t k) const {
    return values_.data() + ((k % slots_) * height_ + j) * width_;
  }
  // Bits of row j of slice k, each counted from the ring of samples beyond the border (all zero): 0 <= j <= height + 1,
  // 0 <= k <= depth + 1, bits 0 <= i <= width + 1.
  const std::uint64_t* bits(std::size_t j, std::size_t k) const {
    if (j == 0 || j > height_ || k == 0 || k > depth_) return zeros_.data();
    return bits_.data() + (((k - 1) % slots_) * height_ + j - 1) * words_;
  }
  std::size_t words() const { return words_; }  // of a row; the last bit is zero

 private:
  void fetch(std::size_t last);

  io::VolumeSource& source_;
  float threshold_;
  std::size_t width_, height_, depth_, words_, batch_, slots_;
  std::size_t available_ = 0, fetched_ = 0;  // slices; those beyond `available_` are being read
  std::vector<float> values_;
  std::vector<std::uint64_t> bits_, zeros_;
  std::future<void> reading_;  // last: whatever it uses outlives it
};

}  // namespace gonio::volume
