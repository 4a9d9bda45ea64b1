// Parts of one component told apart by what they are made of: what a scanned piece stands on is lighter than the piece,
// and joined to it wherever they touch.
//
// A voxel above the threshold belongs to a core where within `reach` steps over faces, all above the threshold, there
// is a value above `core`: that far an edge falls from the one value to the other. The rest is of something lighter.
// Either has components of its own, by runs as all others, of a volume in which the other is taken out.
#include <algorithm>

#include "base/parallel.h"
#include "volume/sample_window.h"
#include "volume/topology.h"

namespace gonio::volume {
namespace {

using Bytes = std::vector<std::uint8_t>;
enum : std::uint8_t { beside = 0, lighter = 1, of_core = 2 };

constexpr std::size_t slices_at_once = 16;

class OneKind : public io::VolumeSource {
 public:
  OneKind(io::VolumeSource& source, double threshold, const SplitWish& wish, std::uint8_t kind)
      : source_(source), threshold_(threshold), wish_(wish), kind_(kind) {
    head_ = source.head();
  }

  void read(std::size_t first, std::size_t count, std::span<float> to) override {
    const std::size_t slice = head_.size[0] * head_.size[1];
    for (std::size_t k = first; k < first + count; ++k) {
      if (k < begin_ || k >= end_) fill(k);
      const auto from = values_.begin() + static_cast<std::ptrdiff_t>((k - begin_) * slice);
      std::copy(from, from + static_cast<std::ptrdiff_t>(slice),
                to.begin() + static_cast<std::ptrdiff_t>((k - first) * slice));
    }
  }

 private:
  // Slices from k on; those that reach into them decide with them.
  void fill(std::size_t k) {
    const std::size_t slice = head_.size[0] * head_.size[1], last = head_.size[2];
    begin_ = k, end_ = std::min(k + slices_at_once, last);
    const std::size_t low = begin_ - std::min(begin_, wish_.reach), high = std::min(end_ + wish_.reach, last);
    values_.resize((high - low) * slice);
    source_.read(low, high - low, values_);
    Bytes kinds(values_.size());
    parallel_for(
        0, values_.size(),
        [&](std::size_t v) {
          const double value = values_[v];
          kinds[v] = value > threshold_ ? (value > wish_.core ? of_core : lighter) : beside;
        },
        std::size_t{1} << 16);
    for (std::size_t step = 0; step < wish_.reach; ++step) kinds = grown(kinds, high - low);
    const float outside = float_threshold(threshold_);  // not above it
    for (std::size_t v = 0; v < values_.size(); ++v)
      if (kinds[v] != kind_) values_[v] = std::min(values_[v], outside);
    const auto rim = values_.begin() + static_cast<std::ptrdiff_t>((begin_ - low) * slice);
    std::copy(rim, values_.end(), values_.begin());
  }

  // Cores one step larger.
  Bytes grown(const Bytes& kinds, std::size_t depth) const {
    const std::size_t w = head_.size[0], h = head_.size[1], slice = w * h;
    Bytes next = kinds;
    parallel_for(
        0, depth * h,
        [&](std::size_t row) {
          const std::size_t j = row % h, k = row / h;
          for (std::size_t i = 0, at = row * w; i < w; ++i, ++at)
            if (kinds[at] == lighter &&
                ((i > 0 && kinds[at - 1] == of_core) || (i + 1 < w && kinds[at + 1] == of_core) ||
                 (j > 0 && kinds[at - w] == of_core) || (j + 1 < h && kinds[at + w] == of_core) ||
                 (k > 0 && kinds[at - slice] == of_core) || (k + 1 < depth && kinds[at + slice] == of_core)))
              next[at] = of_core;
        },
        64);
    return next;
  }

  io::VolumeSource& source_;
  double threshold_;
  SplitWish wish_;
  std::uint8_t kind_;
  std::size_t begin_ = 0, end_ = 0;  // of `values_`, which may hold more
  std::vector<float> values_;
};

}  // namespace

Components split_components(io::VolumeSource& source, double threshold, Connectivity inside, const SplitWish& wish) {
  OneKind cores(source, threshold, wish, of_core), rest(source, threshold, wish, lighter);
  const Components heavy = components(cores, threshold, inside), light = components(rest, threshold, inside);
  struct Part {
    const Component* of;
    bool light;
  };
  std::vector<Part> order;
  for (const Component& one : heavy.list) order.push_back({&one, false});
  for (const Component& one : light.list) order.push_back({&one, true});
  std::stable_sort(order.begin(), order.end(),
                   [](const Part& a, const Part& b) { return a.of->voxels > b.of->voxels; });
  Components all;
  all.size = heavy.size;
  std::vector<std::uint32_t> heavy_id(heavy.list.size() + 1), light_id(light.list.size() + 1);
  for (const Part& part : order) {
    (part.light ? light_id : heavy_id)[part.of->id] = static_cast<std::uint32_t>(all.list.size() + 1);
    all.list.push_back(*part.of);
    all.list.back().id = static_cast<std::uint32_t>(all.list.size());
    all.list.back().light = part.light;
  }
  all.row_starts.reserve(heavy.row_starts.size());
  all.row_starts.push_back(0);
  for (std::size_t row = 0; row + 1 < heavy.row_starts.size(); ++row) {
    for (std::size_t n = heavy.row_starts[row]; n < heavy.row_starts[row + 1]; ++n)
      all.runs.push_back({heavy.runs[n].first, heavy.runs[n].last, heavy_id[heavy.runs[n].id]});
    for (std::size_t n = light.row_starts[row]; n < light.row_starts[row + 1]; ++n)
      all.runs.push_back({light.runs[n].first, light.runs[n].last, light_id[light.runs[n].id]});
    std::sort(all.runs.begin() + static_cast<std::ptrdiff_t>(all.row_starts.back()), all.runs.end(),
              [](const Components::Run& a, const Components::Run& b) { return a.first < b.first; });
    all.row_starts.push_back(all.runs.size());
  }
  return all;
}

}  // namespace gonio::volume
