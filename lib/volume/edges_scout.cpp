// What the edges of one volume share, from some of them: edge_profiles.h.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "stats/intervals.h"
#include "volume/edge_profiles.h"

namespace gonio::volume {
namespace {

constexpr double box_edge = 10;               // voxels
constexpr double least_count = 8;             // edges, weighted by how near their boxes are
constexpr double width_share = 0.04;          // by which the width varies over a volume
constexpr double least_plateau_share = 0.03;  // of the step: by which plateaus differ within a box

std::vector<Edge> fit_all(const std::vector<EdgeProfile>& profiles, const EdgeWish& wish, const EdgeCommon* common,
                          bool slopes) {
  std::vector<Edge> edges(profiles.size());
  parallel_for(
      0, profiles.size(),
      [&](std::size_t n) { edges[n] = fit_profile(profiles[n], wish, common, slopes && profiles[n].alone()); }, 64);
  return edges;
}

// Profiles of one kind, walls as thick and gaps as wide to a quarter of a voxel, added up where they stand on their
// contour. Fits to noisy profiles of thin walls have widths that are too small, one by one and in common: the model
// follows the noise best where it is sharper than the truth. The mean of a hundred profiles has little noise to follow;
// that contours stand within some hundredths of a voxel of the wall widens it by less than a hundredth.
class MeanProfile {
 public:
  void add(const EdgeProfile& p, double step) {
    for (std::size_t n = 0; n < p.s.size(); ++n) {
      const auto at = static_cast<std::size_t>(std::lround(p.s[n] / step) + middle);
      if (at < sum_.size()) sum_[at] += p.values[n], count_[at] += 1;
    }
    members_ += 1, curvature_ += p.mean_curvature;
    inner_ += p.inner.value_or(0), outer_ += p.outer.value_or(0);
    has_inner_ = p.inner.has_value(), has_outer_ = p.outer.has_value();
  }
  double members() const { return members_; }
  std::optional<double> width(double step, double noise) const {
    std::vector<double> s, v;
    for (std::size_t n = 0; n < sum_.size(); ++n)
      if (2 * count_[n] > members_)
        s.push_back((static_cast<double>(n) - static_cast<double>(middle)) * step), v.push_back(sum_[n] / count_[n]);
    ProfileWish wish;
    wish.noise = noise / std::sqrt(members_ / 4);  // neighbours share noise
    wish.mean_curvature = curvature_ / members_;
    if (has_inner_) wish.inner = inner_ / members_;
    if (has_outer_) wish.outer = outer_ / members_;
    const Edge e = fit_edge(s, v, wish);
    return e.good ? std::optional(e.width) : std::nullopt;
  }

 private:
  static constexpr std::size_t middle = 40;
  std::array<double, 2 * middle + 1> sum_{}, count_{};
  double members_ = 0, curvature_ = 0, inner_ = 0, outer_ = 0;
  bool has_inner_ = false, has_outer_ = false;
};

// The median over means of a hundred profiles; of edges that stand alone where there are enough.
// Whether a profile was fitted well is not asked: that goes with its width.
std::optional<double> common_width(const std::vector<EdgeProfile>& profiles, double step, double noise) {
  constexpr double members = 100, least_members = 20;
  std::vector<double> alone, all;
  std::map<std::array<long, 2>, MeanProfile> kinds;
  const auto conclude = [&](const std::array<long, 2>& kind, const MeanProfile& mean) {
    const auto width = mean.width(step, noise);
    if (!width) return;
    all.push_back(*width);
    if (kind == std::array<long, 2>{}) alone.push_back(*width);
  };
  for (std::size_t n = 0; n < profiles.size(); ++n) {
    if (profiles[n].s.size() < 6) continue;
    const std::array<long, 2> kind{std::lround(4 * profiles[n].inner.value_or(0)),
                                   std::lround(4 * profiles[n].outer.value_or(0))};
    MeanProfile& mean = kinds[kind];
    mean.add(profiles[n], step);
    if (mean.members() < members) continue;
    conclude(kind, mean);
    mean = {};
  }
  for (const auto& [kind, mean] : kinds)
    if (mean.members() >= least_members) conclude(kind, mean);
  if (all.empty()) return {};
  return stats::median(alone.size() >= 2 ? alone : all);
}

}  // namespace

EdgeNeighbours::Key EdgeNeighbours::key_of(const Place& place, Vec3 scale) {
  const Vec3 at = place.index * scale / box_edge, n = place.normal;
  const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  return {static_cast<int>(std::floor(at.x)), static_cast<int>(std::floor(at.y)), static_cast<int>(std::floor(at.z)),
          2 * axis + (n[axis] < 0 ? 1 : 0)};
}

void EdgeNeighbours::add(const EdgeProfile& profile, const Edge& edge, Vec3 scale) {
  if (!edge.good) return;
  Sums& s = boxes_[key_of(profile.place, scale)];
  // Not by their stated errors: those go with the values themselves, and would draw the mean.
  const double w = profile.alone() ? 1 : 0.1;
  s.count += 1, s.weight += w;
  s.air += w * edge.air, s.air2 += w * edge.air * edge.air, s.noise_air += w * edge.sigma_air * edge.sigma_air;
  s.object += w * edge.object, s.object2 += w * edge.object * edge.object;
  s.noise_object += w * edge.sigma_object * edge.sigma_object;
  if (profile.alone()) s.slopes += 1, s.slope += edge.slope;
}

std::optional<EdgeNeighbours::Plateaus> EdgeNeighbours::near(const Place& place, Vec3 scale) const {
  const Key key = key_of(place, scale);
  const Vec3 at = place.index * scale / box_edge;
  Sums sum;
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const auto found = boxes_.find({key[0] + dx, key[1] + dy, key[2] + dz, key[3]});
        if (found == boxes_.end()) continue;
        const auto tent = [](double x) { return std::max(0.0, 1 - std::abs(x) / 1.5); };
        const Sums& s = found->second;
        const double t =
            tent(key[0] + dx + 0.5 - at.x) * tent(key[1] + dy + 0.5 - at.y) * tent(key[2] + dz + 0.5 - at.z);
        sum.count += t * s.count, sum.weight += t * s.weight;
        sum.air += t * s.air, sum.air2 += t * s.air2, sum.noise_air += t * s.noise_air;
        sum.object += t * s.object, sum.object2 += t * s.object2, sum.noise_object += t * s.noise_object;
        sum.slopes += t * s.slopes, sum.slope += t * s.slope;
      }
  if (sum.count < least_count) return {};
  Plateaus p;
  p.air.mean = sum.air / sum.weight;
  p.object.mean = sum.object / sum.weight;
  const double least = least_plateau_share * (p.object.mean - p.air.mean);
  // What plateaus differ by beyond the errors of their fits.
  const auto spread = [&](double squares, double mean, double noise) {
    return std::sqrt(least * least + std::max(0.0, (squares - noise) / sum.weight - mean * mean));
  };
  p.air.sd = spread(sum.air2, p.air.mean, sum.noise_air);
  p.object.sd = spread(sum.object2, p.object.mean, sum.noise_object);
  if (sum.slopes >= least_count) p.slope = sum.slope / sum.slopes;
  return p;
}

Edge fit_profile(const EdgeProfile& profile, const EdgeWish& wish, const EdgeCommon* common, bool slope_is_free) {
  const std::size_t n = profile.s.size();
  if (n < 2) return {};
  const auto covariance = trilinear_covariance(profile.place.index + profile.place.along * profile.s.front(),
                                               profile.place.along * wish.step_voxels, n, wish.noise_correlation);
  ProfileWish known{wish.noise, covariance, profile.mean_curvature, profile.inner, profile.outer, wish.width};
  known.slope_is_free = slope_is_free;
  if (common) {
    known.noise = common->noise;
    known.width = common->width;
    known.width_share = width_share;
    if (const auto p = common->neighbours.near(profile.place, wish.scale)) {
      known.air = p->air;
      known.object = p->object;
      if (profile.alone() && !slope_is_free) known.slope = p->slope;
    }
  }
  Edge edge = fit_edge(profile.s, profile.values, known);
  edge.inward = profile.inward;
  edge.outward = profile.outward;
  return edge;
}

EdgeCommon common_of(const std::vector<EdgeProfile>& scouts, const EdgeWish& wish) {
  std::vector<Edge> edges = fit_all(scouts, wish, nullptr, false);
  std::vector<double> widths, excess;
  for (const Edge& e : edges)
    if (e.good) widths.push_back(e.width), excess.push_back(e.excess);
  EdgeCommon common;
  if (widths.empty()) return common;
  // The median of chi-square with the few degrees that a profile leaves is 0.85 of its mean.
  common.noise = wish.noise > 0 ? wish.noise : std::sqrt(stats::median(excess) / 0.85);
  common.width =
      wish.width ? *wish.width : common_width(scouts, wish.step_voxels, common.noise).value_or(stats::median(widths));
  EdgeWish told = wish;
  told.noise = common.noise;
  edges = fit_all(scouts, told, &common, true);
  for (std::size_t n = 0; n < scouts.size(); ++n) common.neighbours.add(scouts[n], edges[n], wish.scale);
  return common;
}

}  // namespace gonio::volume
