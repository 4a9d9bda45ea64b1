// Components by runs of voxels and union-find (Wu, Otoo & Suzuki 2009 do it for pictures): one pass over the volume.
// The outside is labelled beside the inside, with the complementary connectivity, but only two slices of it are kept:
// it says which components the outside that reaches the border touches. Those that it does not touch are enclosed.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "base/error.h"
#include "base/union_find.h"
#include "volume/sample_window.h"
#include "volume/topology.h"

namespace gonio::volume {
namespace {

using Run = Components::Run;  // while they are gathered, id is a label

std::uint32_t new_label(UnionFind& labels) {
  if (labels.size() > std::numeric_limits<std::uint32_t>::max() - 1)
    throw Error(Exit::data, "volume", "more than 4294967294 labels", "choose a threshold outside the noise");
  return labels.make();
}

// Calls body(a, b) for every run a of one row and run b of another that come within `reach` voxels along the row.
template <class Body>
void each_touching(std::span<Run> row, std::span<const Run> other, std::uint32_t reach, const Body& body) {
  std::size_t first = 0;
  for (Run& run : row) {
    while (first < other.size() && other[first].last + reach < run.first) ++first;
    for (std::size_t n = first; n < other.size() && other[n].first <= run.last + reach; ++n) body(run, other[n]);
  }
}

// The runs of a row: of the inside, and what lies between them.
struct RowRuns {
  std::vector<Run> inside, outside;
};
void find_runs(const std::uint64_t* bits, std::size_t words, std::uint32_t width, RowRuns& runs) {
  runs.inside.clear();
  runs.outside.clear();
  std::uint64_t before = 0;
  std::uint32_t start = 0;
  bool in = false;
  const auto end_run = [&](std::uint32_t end) {
    if (end > start) (in ? runs.inside : runs.outside).push_back({start, end - 1, 0});
    start = end;
    in = !in;
  };
  for (std::size_t w = 0; w < words; ++w) {
    const std::uint64_t changes = bits[w] ^ (bits[w] << 1 | before);
    before = bits[w] >> 63;
    for (std::uint64_t left = changes; left != 0; left &= left - 1)  // bit i + 1 is voxel i
      end_run(static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(std::countr_zero(left)) - 1);
  }
  if (start < width) end_run(width);
}

struct Sums {
  std::uint64_t voxels = 0;
  std::array<std::size_t, 3> low{}, high{};
  std::array<double, 3> index{};
  double value = 0, square = 0;  // of value - threshold
  bool border = false;
  void add(const Sums& o) {
    if (voxels == 0) {
      *this = o;
      return;
    }
    voxels += o.voxels;
    for (std::size_t n = 0; n < 3; ++n) {
      low[n] = std::min(low[n], o.low[n]);
      high[n] = std::max(high[n], o.high[n]);
      index[n] += o.index[n];
    }
    value += o.value;
    square += o.square;
    border = border || o.border;
  }
};

class Gathering {
 public:
  Gathering(io::VolumeSource& source, double threshold, Connectivity inside)
      : size_(source.head().size),
        threshold_(threshold),
        reach_(inside == Connectivity::twenty_six ? 1 : 0),
        window_(source, threshold, 1) {
    outside_here_.resize(size_[1]);
    outside_below_.resize(size_[1]);
  }

  Components run() {
    found_.size = size_;
    found_.row_starts.reserve(size_[1] * size_[2] + 1);
    for (std::size_t k = 0; k < size_[2]; ++k) {
      window_.advance_to(k);
      for (std::size_t j = 0; j < size_[1]; ++j) add_row(j, k);
      std::swap(outside_here_, outside_below_);
    }
    found_.row_starts.push_back(found_.runs.size());
    name();
    return std::move(found_);
  }

 private:
  std::span<const Run> inside_row(std::size_t j, std::size_t k) const {
    const std::size_t row = k * size_[1] + j, first = found_.row_starts[row];
    const std::size_t last = row + 1 < found_.row_starts.size() ? found_.row_starts[row + 1] : found_.runs.size();
    return std::span(found_.runs).subspan(first, last - first);
  }

  // The rows before (j, k) that touch it where neighbours may differ in `reach` coordinates besides one.
  template <class Body>
  void each_row_before(std::size_t j, std::size_t k, bool diagonally, const Body& body) {
    if (j > 0) body(j - 1, k);
    if (k == 0) return;
    if (diagonally && j > 0) body(j - 1, k - 1);
    body(j, k - 1);
    if (diagonally && j + 1 < size_[1]) body(j + 1, k - 1);
  }
  const std::vector<Run>& outside_row(std::size_t j, bool same_slice) const {
    return same_slice ? outside_here_[j] : outside_below_[j];
  }

  void add_row(std::size_t j, std::size_t k) {
    found_.row_starts.push_back(found_.runs.size());
    find_runs(window_.bits(j + 1, k + 1), window_.words(), static_cast<std::uint32_t>(size_[0]), row_);
    constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
    for (Run& run : row_.inside) run.id = none;
    for (Run& run : row_.outside) run.id = none;
    const auto join = [](UnionFind& labels) {
      return [&labels](Run& run, const Run& other) {
        if (run.id == none)
          run.id = other.id;
        else if (run.id != other.id)
          labels.join(run.id, other.id);
      };
    };
    const std::uint32_t outside_reach = 1 - reach_;
    each_row_before(j, k, reach_ == 1, [&](std::size_t jj, std::size_t kk) {
      each_touching(row_.inside, inside_row(jj, kk), reach_, join(inside_));
    });
    each_row_before(j, k, reach_ == 0, [&](std::size_t jj, std::size_t kk) {
      each_touching(row_.outside, outside_row(jj, kk == k), outside_reach, join(outside_));
    });
    const bool border_row = j == 0 || j + 1 == size_[1] || k == 0 || k + 1 == size_[2];
    for (Run& run : row_.inside) {
      if (run.id == none) run.id = new_label(inside_), sums_.emplace_back();
      add_sums(run, j, k, border_row);
    }
    for (Run& run : row_.outside) {
      if (run.id == none) run.id = new_label(outside_), open_.push_back(false);
      if (border_row || run.first == 0 || run.last + 1 == size_[0]) open_[run.id] = true;
    }
    note_contacts(j, k);
    found_.runs.insert(found_.runs.end(), row_.inside.begin(), row_.inside.end());
    outside_here_[j].assign(row_.outside.begin(), row_.outside.end());
  }

  void add_sums(const Run& run, std::size_t j, std::size_t k, bool border_row) {
    Sums more;
    const double count = run.last - run.first + 1.0;
    more.voxels = run.last - run.first + 1;
    more.low = {run.first, j, k};
    more.high = {run.last, j, k};
    more.index = {count * (static_cast<double>(run.first) + run.last) / 2, count * static_cast<double>(j),
                  count * static_cast<double>(k)};
    const float* values = window_.row(j, k);
    for (std::uint32_t i = run.first; i <= run.last; ++i) {
      const double value = static_cast<double>(values[i]) - threshold_;
      more.value += value;
      more.square += value * value;
    }
    more.border = border_row || run.first == 0 || run.last + 1 == size_[0];
    sums_[run.id].add(more);
  }

  // Which labels of the inside share a face with which of the outside.
  void note_contacts(std::size_t j, std::size_t k) {
    const auto note = [this](std::uint32_t in, std::uint32_t out) {
      const std::uint64_t pair = std::uint64_t{in} << 32 | out;
      if (!contacts_.empty() && contacts_.back() == pair) return;
      contacts_.push_back(pair);
      if (contacts_.size() > contact_limit_) thin_contacts();
    };
    each_touching(row_.inside, row_.outside, 1, [&](Run& in, const Run& out) { note(in.id, out.id); });
    each_row_before(j, k, false, [&](std::size_t jj, std::size_t kk) {
      each_touching(row_.inside, outside_row(jj, kk == k), 0, [&](Run& in, const Run& out) { note(in.id, out.id); });
      each_touching(row_.outside, inside_row(jj, kk), 0, [&](Run& out, const Run& in) { note(in.id, out.id); });
    });
  }

  void thin_contacts() {
    for (std::uint64_t& pair : contacts_)
      pair = std::uint64_t{inside_.group(static_cast<std::uint32_t>(pair >> 32))} << 32 |
             outside_.group(static_cast<std::uint32_t>(pair));
    std::sort(contacts_.begin(), contacts_.end());
    contacts_.erase(std::unique(contacts_.begin(), contacts_.end()), contacts_.end());
    contact_limit_ = std::max(contact_limit_, 2 * contacts_.size());
  }

  void name() {
    thin_contacts();
    std::vector<bool> open(outside_.size());
    for (std::uint32_t label = 0; label < outside_.size(); ++label)
      if (open_[label]) open[outside_.group(label)] = true;
    std::vector<bool> reached(inside_.size());
    for (const std::uint64_t pair : contacts_)
      if (open[static_cast<std::uint32_t>(pair)]) reached[static_cast<std::uint32_t>(pair >> 32)] = true;
    for (std::uint32_t label = 0; label < inside_.size(); ++label)
      if (const std::uint32_t root = inside_.group(label); root != label) sums_[root].add(sums_[label]);
    std::vector<std::uint32_t> roots;
    for (std::uint32_t label = 0; label < inside_.size(); ++label)
      if (inside_.group(label) == label) roots.push_back(label);
    std::stable_sort(roots.begin(), roots.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return sums_[a].voxels > sums_[b].voxels; });
    std::vector<std::uint32_t> id(inside_.size());
    for (const std::uint32_t root : roots) {
      found_.list.push_back(component_of(sums_[root]));
      found_.list.back().id = id[root] = static_cast<std::uint32_t>(found_.list.size());
      found_.list.back().enclosed = !reached[root] && !sums_[root].border;
    }
    for (Run& run : found_.runs) run.id = id[inside_.group(run.id)];
  }

  Component component_of(const Sums& sums) const {
    const auto count = static_cast<double>(sums.voxels);
    Component made;
    made.voxels = sums.voxels;
    made.low = sums.low;
    made.high = sums.high;
    made.centroid = Vec3{sums.index[0], sums.index[1], sums.index[2]} / count;
    made.mean_value = threshold_ + sums.value / count;
    made.sd_value = std::sqrt(std::max(0.0, sums.square / count - sums.value / count * (sums.value / count)));
    made.touches_border = sums.border;
    return made;
  }

  std::array<std::size_t, 3> size_;
  double threshold_;
  std::uint32_t reach_;  // of the inside along rows; the outside's is the other of 0 and 1
  SampleWindow window_;
  Components found_;
  RowRuns row_;
  std::vector<std::vector<Run>> outside_here_, outside_below_;  // by row
  UnionFind inside_, outside_;                                  // labels that turned out to be one
  std::vector<Sums> sums_;
  std::vector<bool> open_;
  std::vector<std::uint64_t> contacts_;
  std::size_t contact_limit_ = std::size_t{1} << 20;
};

}  // namespace

Components components(io::VolumeSource& source, double threshold, Connectivity inside) {
  return Gathering(source, threshold, inside).run();
}

std::uint32_t Components::at(std::size_t i, std::size_t j, std::size_t k) const {
  const std::size_t row = k * size[1] + j;
  const auto first = runs.begin() + static_cast<std::ptrdiff_t>(row_starts[row]);
  const auto last = runs.begin() + static_cast<std::ptrdiff_t>(row_starts[row + 1]);
  const auto after = std::upper_bound(first, last, i, [](std::size_t at, const Run& run) { return at < run.first; });
  return after != first && std::prev(after)->last >= i ? std::prev(after)->id : 0;
}

}  // namespace gonio::volume
