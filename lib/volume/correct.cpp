// Corrections, read through block by block: correct.h.
#include "volume/correct.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "stats/intervals.h"
#include "volume/correct_parts.h"
#include "volume/look_parts.h"

namespace gonio::volume {
namespace {

constexpr std::size_t block_slices = 16;
constexpr std::size_t most_compared_edges = 1500;

class CorrectedVolume final : public io::VolumeSource {
 public:
  CorrectedVolume(io::VolumeSource& source, const CorrectWish& wish) : source_(source), wish_(wish) {
    head_ = source.head();
    if (wish.cupping != nullptr) cupping_ = *wish.cupping, wish_.cupping = &cupping_;
    if (wish.rings != nullptr) rings_ = *wish.rings, wish_.rings = &rings_;
    if (wish.denoise != Denoise::none && !(wish.noise > 0))
      throw Error(Exit::usage, "denoise", "the noise is " + std::to_string(wish.noise) + " (above 0 is needed)",
                  "state it, or measure it in air first");
  }

  void read(std::size_t first, std::size_t count, std::span<float> to) override {
    if (count == 0) return;
    if (wish_.denoise == Denoise::none) {
      source_.read(first, count, to);
      correct_slices(first, to);
      return;
    }
    // Block by block; the last one is kept, as the next slices begin within it more often than not.
    const std::size_t slice = head_.size[0] * head_.size[1];
    for (std::size_t k = first; k < first + count;) {
      const std::size_t block = k / block_slices, begin = block * block_slices;
      if (block != done_block_ || done_.empty()) denoise(block);
      const std::size_t end = std::min(first + count, begin + done_.size() / slice);
      std::copy_n(done_.begin() + static_cast<std::ptrdiff_t>((k - begin) * slice), (end - k) * slice,
                  to.begin() + static_cast<std::ptrdiff_t>((k - first) * slice));
      k = end;
    }
  }

 private:
  void correct_slices(std::size_t first, std::span<float> slices) const {
    const std::size_t w = head_.size[0], h = head_.size[1];
    parallel_for(0, slices.size() / (w * h), [&](std::size_t k) {
      const std::span<float> slice = slices.subspan(k * w * h, w * h);
      if (wish_.cupping != nullptr)
        for (std::size_t j = 0; j < h; ++j)
          for (std::size_t i = 0; i < w; ++i) {
            const double g =
                cupping_.at(head_.size, static_cast<double>(i), static_cast<double>(j), static_cast<double>(first + k));
            float& v = slice[j * w + i];
            v = static_cast<float>(cupping_.air + (v - cupping_.air) / g);
          }
      if (wish_.rings != nullptr) take_off_rings(slice, w, h, rings_);
    });
  }

  // Slices begin .. end - 1, corrected but not denoised; what a former call left of them is not read again.
  void fill_window(std::size_t begin, std::size_t end) {
    const std::size_t slice = head_.size[0] * head_.size[1];
    std::vector<float> window((end - begin) * slice);
    std::size_t from = begin;
    if (begin >= window_first_ && begin < window_first_ + window_.size() / slice) {
      const std::size_t held = std::min(end, window_first_ + window_.size() / slice) - begin;
      std::copy_n(window_.begin() + static_cast<std::ptrdiff_t>((begin - window_first_) * slice), held * slice,
                  window.begin());
      from += held;
    }
    if (from < end) {
      const std::span<float> fresh{window.data() + (from - begin) * slice, (end - from) * slice};
      source_.read(from, end - from, fresh);
      correct_slices(from, fresh);
    }
    window_ = std::move(window), window_first_ = begin;
  }

  // One block into done_; each is made of its own slices and their margins alone.
  void denoise(std::size_t block) {
    const std::size_t w = head_.size[0], h = head_.size[1], slice = w * h;
    const std::size_t begin = block * block_slices, end = std::min(begin + block_slices, head_.size[2]);
    const std::size_t low = begin - std::min(begin, denoise_reach), high = std::min(end + denoise_reach, head_.size[2]);
    fill_window(low, high);
    // Strips of rows go to different threads, with margins as well.
    constexpr std::size_t rows = 48;
    std::vector<float> result((end - begin) * slice);
    parallel_for(0, (h + rows - 1) / rows, [&](std::size_t strip) {
      const std::size_t j0 = strip * rows, j1 = std::min(j0 + rows, h);
      const std::size_t top = j0 - std::min(j0, denoise_reach), bottom = std::min(j1 + denoise_reach, h);
      const std::size_t deep = high - low, tall = bottom - top;
      std::vector<float> part(deep * tall * w);
      for (std::size_t k = 0; k < deep; ++k)
        std::copy_n(window_.begin() + static_cast<std::ptrdiff_t>(k * slice + top * w), tall * w,
                    part.begin() + static_cast<std::ptrdiff_t>(k * tall * w));
      denoise_block(part, w, tall, deep, wish_);
      for (std::size_t k = begin; k < end; ++k)
        std::copy_n(part.begin() + static_cast<std::ptrdiff_t>(((k - low) * tall + (j0 - top)) * w), (j1 - j0) * w,
                    result.begin() + static_cast<std::ptrdiff_t>((k - begin) * slice + j0 * w));
    });
    done_ = std::move(result), done_block_ = block;
  }

  io::VolumeSource& source_;
  CorrectWish wish_;
  CuppingField cupping_;
  RingWish rings_;
  std::vector<float> window_, done_;
  std::size_t window_first_ = 0, done_block_ = 0;
};

}  // namespace

std::unique_ptr<io::VolumeSource> corrected(io::VolumeSource& source, const CorrectWish& wish) {
  return std::make_unique<CorrectedVolume>(source, wish);
}

EdgeChange edge_change(io::VolumeSource& before, io::VolumeSource& after, double air, double object, double noise) {
  if (before.head().size != after.head().size)
    throw Error(Exit::data, "volume", "two volumes of different sizes have no edges in common");
  const Sides sides{air, object};
  ProbeWish wish;
  wish.outside = static_cast<float>(air);
  Thinned<PatchPoint> taken(most_compared_edges);
  for_each_probe(before, wish, [&](const Slab& slab) { take_patches(slab, sides, taken); });
  const std::vector<PatchPoint>& old = taken.all();
  std::vector<PatchPoint> fresh = old;
  for_each_probe(after, wish, [&](const Slab& slab) {
    const auto first = static_cast<double>(slab.first), last = first + static_cast<double>(slab.count);
    for (PatchPoint& patch : fresh)
      if (patch.at.z >= first && patch.at.z < last) refill(slab, patch);
  });
  const std::vector<PatchFit> a = all_fitted(old, sides, noise), b = all_fitted(fresh, sides, noise);
  EdgeChange change;
  std::vector<double> widths_before, widths_after;
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!a[k].good || !b[k].good) continue;
    const double shift = b[k].position - a[k].position;
    sum += shift, squares += shift * shift, ++change.edges;
    widths_before.push_back(a[k].width), widths_after.push_back(b[k].width);
  }
  if (change.edges == 0) return change;
  const auto n = static_cast<double>(change.edges);
  change.width_before_voxels = stats::median(widths_before), change.width_after_voxels = stats::median(widths_after);
  change.mean_shift_voxels = sum / n, change.rms_shift_voxels = std::sqrt(squares / n);
  change.sigma_mean_shift = std::sqrt(std::max(0.0, squares / n - sum * sum / n / n) / n);
  return change;
}

}  // namespace gonio::volume
