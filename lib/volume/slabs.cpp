#include "volume/slabs.h"

#include <algorithm>

namespace gonio::volume {

void for_each_slab(io::VolumeSource& source, const SlabWish& wish, const std::function<void(const Slab&)>& body) {
  const auto& size = source.head().size;
  const std::size_t depth = size[2], slice = size[0] * size[1], margin = wish.margin;
  const std::size_t count = std::max<std::size_t>(1, std::min(wish.count, depth));
  Slab slab{size[0], size[1], 0, count, margin, {}};
  slab.values.assign((count + 2 * margin) * slice, wish.outside);
  // Slice k of the volume lies at position k + margin - first; `held` of them are there already.
  std::size_t held = margin, read = 0;
  for (; slab.first < depth; slab.first += count) {
    slab.count = std::min(count, depth - slab.first);
    const std::size_t wanted = slab.count + 2 * margin;
    slab.values.resize(wanted * slice);
    const std::size_t fresh = std::min(wanted - std::min(wanted, held), depth - read);
    if (fresh > 0) source.read(read, fresh, {slab.values.data() + held * slice, fresh * slice});
    read += fresh;
    held += fresh;
    if (held < wanted)
      std::fill(slab.values.begin() + static_cast<std::ptrdiff_t>(held * slice), slab.values.end(), wish.outside);
    body(slab);
    // What the next slab begins with: the last 2 margin slices of this one.
    held = 2 * margin;
    std::copy(slab.values.end() - static_cast<std::ptrdiff_t>(held * slice), slab.values.end(), slab.values.begin());
  }
}

}  // namespace gonio::volume
