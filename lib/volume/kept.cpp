// Components that stay, and the volume without the others.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "volume/topology.h"

namespace gonio::volume {
namespace {

constexpr double nearly_enclosed = 0.9;
constexpr std::size_t most_surrounded = 1000;  // the largest: specks are told by their size
constexpr int directions = 200;

std::string figure(double value) {
  return format("%.6g", value);
}

// By position in the list: has a voxel whose centre lies in the box.
std::vector<bool> in_box(const Components& all, const std::array<std::array<double, 3>, 2>& box) {
  std::vector<bool> touched(all.list.size());
  for (std::size_t k = 0; k < all.size[2]; ++k)
    for (std::size_t j = 0; j < all.size[1]; ++j) {
      const auto y = static_cast<double>(j), z = static_cast<double>(k);
      if (y < box[0][1] || y > box[1][1] || z < box[0][2] || z > box[1][2]) continue;
      const std::size_t row = k * all.size[1] + j;
      for (std::size_t n = all.row_starts[row]; n < all.row_starts[row + 1]; ++n) {
        const auto& run = all.runs[n];
        // The first centre at or beyond the box's lower side, or the run's own first.
        const double first = std::max<double>(run.first, std::ceil(box[0][0]));
        if (first <= std::min<double>(run.last, box[1][0])) touched[run.id - 1] = true;
      }
    }
  return touched;
}

// Why a component goes; empty where it stays.
std::string reason_to_drop(const Component& one, const KeepRule& rule, bool touches_box, bool surrounded) {
  const std::string voxels = std::to_string(one.voxels);
  if (rule.largest > 0 && one.id > rule.largest)
    return voxels + " voxels, not among the largest " + std::to_string(rule.largest);
  if (one.voxels < rule.at_least_voxels) return voxels + " voxels, fewer than " + std::to_string(rule.at_least_voxels);
  if (rule.above_mean && !(one.mean_value > *rule.above_mean))
    return "mean " + figure(one.mean_value) + ", not above " + figure(*rule.above_mean);
  if (rule.below_mean && !(one.mean_value < *rule.below_mean))
    return "mean " + figure(one.mean_value) + ", not below " + figure(*rule.below_mean);
  if (!touches_box) return "no voxel in the box";
  if (rule.drop_enclosed && one.enclosed) return "enclosed by another";
  if (rule.drop_enclosed && surrounded) return "surrounded by another";
  if (rule.drop_touching_border && one.touches_border) return "touches the volume's border";
  return {};
}

class OnlyKept : public io::VolumeSource {
 public:
  OnlyKept(io::VolumeSource& source, const Components& all, const Kept& kept, float outside)
      : source_(source), runs_(all.runs), row_starts_(all.row_starts), keep_(kept.keep), outside_(outside) {
    head_ = source.head();
    if (keep_.size() < all.list.size()) keep_.resize(all.list.size(), false);
    dropped_.resize(head_.size[0]);
    kept_.resize(head_.size[0]);
  }

  void read(std::size_t first, std::size_t count, std::span<float> to) override {
    source_.read(first, count, to);
    const auto& size = head_.size;
    for (std::size_t k = first; k < first + count; ++k)
      for (std::size_t j = 0; j < size[1]; ++j)
        clear_row(j, k, to.subspan(((k - first) * size[1] + j) * size[0], size[0]));
  }

 private:
  void clear_row(std::size_t j, std::size_t k, std::span<float> values) {
    bool any = false;
    std::fill(dropped_.begin(), dropped_.end(), char{0});
    std::fill(kept_.begin(), kept_.end(), char{0});
    const std::size_t rows = head_.size[1], slices = head_.size[2], last = head_.size[0] - 1;
    for (std::size_t kk = k > 0 ? k - 1 : 0; kk <= std::min(k + 1, slices - 1); ++kk)
      for (std::size_t jj = j > 0 ? j - 1 : 0; jj <= std::min(j + 1, rows - 1); ++jj) {
        const std::size_t row = kk * rows + jj;
        for (std::size_t n = row_starts_[row]; n < row_starts_[row + 1]; ++n) {
          const auto& run = runs_[n];
          const bool stays = keep_[run.id - 1];
          any = any || !stays;
          std::vector<char>& near = stays ? kept_ : dropped_;
          const std::size_t from = run.first > 0 ? run.first - 1 : 0, until = std::min<std::size_t>(run.last + 1, last);
          std::fill(near.begin() + static_cast<std::ptrdiff_t>(from),
                    near.begin() + static_cast<std::ptrdiff_t>(until + 1), char{1});
        }
      }
    if (!any) return;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (dropped_[i] != 0 && kept_[i] == 0) values[i] = outside_;
    const std::size_t row = k * rows + j;
    for (std::size_t n = row_starts_[row]; n < row_starts_[row + 1]; ++n)
      if (!keep_[runs_[n].id - 1])
        std::fill(values.begin() + runs_[n].first, values.begin() + runs_[n].last + 1, outside_);
  }

  io::VolumeSource& source_;
  std::vector<Components::Run> runs_;
  std::vector<std::size_t> row_starts_;
  std::vector<bool> keep_;
  float outside_;
  std::vector<char> dropped_, kept_;  // of one row: next to a voxel of such a component, or of it
};

}  // namespace

double surrounded_share(const Components& all, const Component& one) {
  const auto at = [&](Vec3 p) {
    return all.at(static_cast<std::size_t>(p.x), static_cast<std::size_t>(p.y), static_cast<std::size_t>(p.z));
  };
  const std::uint32_t middle = at(one.centroid + Vec3{0.5, 0.5, 0.5});
  if (middle != 0 && middle != one.id) return 0;  // it surrounds rather
  const double golden = pi * (3 - std::sqrt(5.0));
  int crossed = 0;
  for (int n = 0; n < directions; ++n) {
    const double z = 1 - (2 * n + 1.0) / directions, r = std::sqrt(1 - z * z), turn = golden * n;
    const Vec3 step = Vec3{r * std::cos(turn), r * std::sin(turn), z} * 0.5;
    for (Vec3 p = one.centroid;; p += step) {
      const Vec3 voxel = p + Vec3{0.5, 0.5, 0.5};
      if (!(voxel.x >= 0 && voxel.y >= 0 && voxel.z >= 0 && voxel.x < static_cast<double>(all.size[0]) &&
            voxel.y < static_cast<double>(all.size[1]) && voxel.z < static_cast<double>(all.size[2])))
        break;
      const std::uint32_t id = at(voxel);
      if (id == 0 || id == one.id) continue;
      ++crossed;
      break;
    }
  }
  return static_cast<double>(crossed) / directions;
}

Kept chosen(const Components& all, const KeepRule& rule) {
  const std::vector<bool> touched =
      rule.touching_box ? in_box(all, *rule.touching_box) : std::vector<bool>(all.list.size(), true);
  Kept kept;
  for (std::size_t n = 0; n < all.list.size(); ++n) {
    const bool asked = rule.drop_enclosed && n < most_surrounded && !all.list[n].enclosed;
    const bool surrounded = asked && surrounded_share(all, all.list[n]) > nearly_enclosed;
    const std::string why = reason_to_drop(all.list[n], rule, touched[n], surrounded);
    kept.keep.push_back(why.empty());
    if (!why.empty())
      kept.reason.push_back("dropped: " + why);
    else if (rule.largest > 0)
      kept.reason.push_back(rule.largest == 1 ? "kept: largest"
                                              : "kept: among the largest " + std::to_string(rule.largest));
    else
      kept.reason.push_back("kept");
  }
  return kept;
}

std::unique_ptr<io::VolumeSource> only(io::VolumeSource& source, const Components& all, const Kept& kept,
                                       float outside) {
  return std::make_unique<OnlyKept>(source, all, kept, outside);
}

}  // namespace gonio::volume
