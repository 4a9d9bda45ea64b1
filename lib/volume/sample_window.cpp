#include "volume/sample_window.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace gonio::volume {
namespace {

// Of 64 samples.
std::uint64_t word_above(const float* values, float threshold) {
  std::uint64_t word = 0;
#if defined(__SSE2__)
  const __m128 limit = _mm_set1_ps(threshold);
  for (int n = 0; n < 16; ++n) {
    const int four = _mm_movemask_ps(_mm_cmpgt_ps(_mm_loadu_ps(values + 4 * n), limit));
    word |= static_cast<std::uint64_t>(static_cast<unsigned>(four)) << (4 * n);
  }
#else
  for (int n = 0; n < 64; ++n) word |= static_cast<std::uint64_t>(values[n] > threshold) << n;
#endif
  return word;
}

constexpr std::size_t batch_bytes = std::size_t{32} << 20;  // read ahead

}  // namespace

float float_threshold(double threshold) {
  const auto nearest = static_cast<float>(threshold);
  if (static_cast<double>(nearest) <= threshold) return nearest;
  return std::nextafter(nearest, -std::numeric_limits<float>::infinity());
}

void bits_above(const float* values, std::size_t count, float threshold, std::uint64_t* bits, std::size_t words) {
  std::uint64_t carry = 0;
  for (std::size_t w = 0; w < words; ++w) {
    const std::size_t first = 64 * w;
    std::uint64_t word = 0;
    if (first + 64 <= count) {
      word = word_above(values + first, threshold);
    } else {
      for (std::size_t i = first; i < count; ++i)
        word |= static_cast<std::uint64_t>(values[i] > threshold) << (i - first);
    }
    bits[w] = word << 1 | carry;
    carry = word >> 63;
  }
}

SampleWindow::SampleWindow(io::VolumeSource& source, double threshold, std::size_t kept)
    : source_(source),
      threshold_(float_threshold(threshold)),
      width_(source.head().size[0]),
      height_(source.head().size[1]),
      depth_(source.head().size[2]),
      words_((width_ + 2) / 64 + 1) {
  const std::size_t slice_bytes = std::max<std::size_t>(1, width_ * height_ * sizeof(float));
  batch_ = std::clamp<std::size_t>(batch_bytes / slice_bytes, 1, 16);
  slots_ = std::min(kept + 2 * batch_, std::max<std::size_t>(depth_, 1));
  values_.resize(slots_ * height_ * width_);
  bits_.resize(slots_ * height_ * words_);
  zeros_.resize(words_);
}

SampleWindow::~SampleWindow() {
  if (reading_.valid()) reading_.wait();
}

void SampleWindow::fetch(std::size_t last) {
  const std::size_t first = fetched_;
  fetched_ = last;
  reading_ = std::async(threads() > 1 ? std::launch::async : std::launch::deferred, [this, first, last] {
    for (std::size_t k = first; k < last; ++k) {
      float* slice = values_.data() + (k % slots_) * height_ * width_;
      source_.read(k, 1, {slice, height_ * width_});
      std::uint64_t* bits = bits_.data() + (k % slots_) * height_ * words_;
      for (std::size_t j = 0; j < height_; ++j)
        bits_above(slice + j * width_, width_, threshold_, bits + j * words_, words_);
    }
  });
}

// While one batch is worked on the next is read: into slots that neither that batch nor the slices kept before it use.
void SampleWindow::advance_to(std::size_t last) {
  while (available_ <= last) {
    if (fetched_ == available_) fetch(std::min(depth_, available_ + batch_));
    reading_.get();
    available_ = fetched_;
    if (fetched_ < depth_) fetch(std::min(depth_, fetched_ + batch_));
  }
}

}  // namespace gonio::volume
