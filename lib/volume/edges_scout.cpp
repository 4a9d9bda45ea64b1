// What the edges of one volume share, from some of them: edge_profiles.h.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "stats/intervals.h"
#include "volume/edge_profiles.h"

namespace gonio::volume {
namespace {

constexpr double box_edge = 10;              // voxels
constexpr double least_count = 8;            // edges, weighted by how near their boxes are
constexpr double least_width_share = 0.015;  // by which the width varies over a volume
constexpr double told_width_share = 0.03;    // sd of a width that was told
constexpr std::size_t enough_for_medians = 4000;
constexpr double lack_sd = 0.03;              // voxels: what an edge is off by, whatever its noise
constexpr double least_plateau_share = 0.03;  // of the step: by which plateaus differ within a box

std::vector<Edge> fit_all(const std::vector<EdgeProfile>& profiles, const EdgeWish& wish, const EdgeCommon* common,
                          bool slopes, std::size_t every = 1) {
  std::vector<Edge> edges((profiles.size() + every - 1) / every);
  parallel_for(
      0, edges.size(),
      [&](std::size_t n) {
        const EdgeProfile& profile = profiles[n * every];
        edges[n] = fit_profile(profile, wish, common, slopes && profile.alone());
      },
      64);
  return edges;
}

// Profiles of one kind, walls as thick and gaps as wide to a quarter of a voxel and as steep against the axis, added up
// where they stand on their contour. Fits to noisy profiles of thin walls have widths that are too small, one by one
// and in common: the model follows the noise best where it is sharper than the truth. The mean of a hundred profiles
// has little noise to follow; that contours stand within some hundredths of a voxel of the wall widens it by less than
// a hundredth.
class MeanProfile {
 public:
  void add(const EdgeProfile& p) {
    for (std::size_t n = 0; n < p.s.size(); ++n) {
      const auto at = static_cast<std::size_t>(std::lround(p.s[n] / pool_step) + middle);
      if (at >= bins_.size()) continue;
      Bin& bin = bins_[at];
      bin.s += p.voxels[n] * p.s[n], bin.v += p.voxels[n] * p.values[n], bin.voxels += p.voxels[n], bin.profiles += 1;
    }
    members_ += 1, sharpest_ += p.sharpest, curvature_ += p.mean_curvature,
        axis2_ += p.place.normal.z * p.place.normal.z;
    inner_ += p.inner.value_or(0), outer_ += p.outer.value_or(0);
    has_inner_ = p.inner.has_value(), has_outer_ = p.outer.has_value();
  }
  double members() const { return members_; }
  double sharpest() const { return sharpest_ / members_; }
  double axis2() const { return axis2_ / members_; }
  Edge fitted(double noise, const ProfileWish& known) const {
    std::vector<double> s, v, weights;
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (const Bin& bin : bins_) {
      if (bin.voxels < members_ || s.size() == 64) continue;
      s.push_back(bin.s / bin.voxels), v.push_back(bin.v / bin.voxels), weights.push_back(bin.voxels);
      least = std::min(least, v.back()), most = std::max(most, v.back());
    }
    // What the noise leaves, and what no model is without.
    const double lack = model_share * (most - least);
    for (double& w : weights) w = noise * noise / (noise * noise * sharing / w + lack * lack);
    ProfileWish wish = known;
    wish.noise = noise;
    wish.weights = weights;
    wish.mean_curvature = curvature_ / members_;
    if (has_inner_) wish.inner = inner_ / members_;
    if (has_outer_) wish.outer = outer_ / members_;
    return fit_edge(s, v, wish);
  }

 private:
  struct Bin {
    double s = 0, v = 0, voxels = 0, profiles = 0;
  };
  static constexpr std::size_t middle = 40;
  static constexpr double sharing = 10;         // profiles that have the same voxel
  static constexpr double model_share = 0.005;  // of the step
  std::array<Bin, 2 * middle + 1> bins_{};
  double members_ = 0, curvature_ = 0, sharpest_ = 0, inner_ = 0, outer_ = 0, axis2_ = 0;
  bool has_inner_ = false, has_outer_ = false;
};

struct SeenWidth {
  double square = 0, sigma = 0, axis2 = 0;  // of the width's square
};

EdgeSpread spread_of(const std::vector<SeenWidth>& seen) {
  constexpr double anisotropy = 0.08;  // sd of along^2 / across^2 - 1, before anything is seen
  std::vector<double> robust(seen.size(), 1.0);
  double a = 0, b = 0, variance = 0;
  for (int round = 0; round < 10; ++round) {
    double h00 = 0, h01 = 0, h11 = 0, r0 = 0, r1 = 0;
    for (std::size_t n = 0; n < seen.size(); ++n) {
      const double w = robust[n] / (seen[n].sigma * seen[n].sigma), z = seen[n].axis2;
      h00 += w, h01 += w * z, h11 += w * z * z, r0 += w * seen[n].square, r1 += w * z * seen[n].square;
    }
    const double prior = anisotropy * (a > 0 ? a : r0 / h00);
    h11 += 1 / (prior * prior);
    const double det = h00 * h11 - h01 * h01;
    a = (h11 * r0 - h01 * r1) / det, b = (h00 * r1 - h01 * r0) / det, variance = h11 / det;
    for (std::size_t n = 0; n < seen.size(); ++n) {
      const double r = std::abs(seen[n].square - a - b * seen[n].axis2) / seen[n].sigma;
      robust[n] = r > 1.5 ? 1.5 / r : 1;
    }
  }
  a = std::max(a, 0.01);
  EdgeSpread spread{a, std::max(0.01, a + b)};
  // What the model lacks is the same in all kinds: together they are no better than the best.
  double best = HUGE_VAL;
  for (const SeenWidth& one : seen) best = std::min(best, 0.5 * one.sigma / one.square);
  spread.share = std::clamp(std::max(best, 0.5 * std::sqrt(variance) / a), least_width_share, 0.1);
  return spread;
}

// w^2 = across^2 + (along^2 - across^2) n_z^2 over the means of all kinds, by their errors: a thin wall hardly tells
// its width, an edge that stands alone does, and a rim less than it seems to. Whether a single profile was fitted well
// is not asked: that goes with its width.
std::optional<EdgeSpread> common_spread(const std::vector<EdgeProfile>& profiles, double noise) {
  constexpr double least_members = 20;
  constexpr double lack_of_curved = 0.3;  // share of the width by which curvatures, 1 / voxel, make it uncertain
  std::map<std::array<long, 4>, MeanProfile> kinds;
  for (const EdgeProfile& profile : profiles) {
    if (profile.s.size() < 6) continue;
    kinds[{std::lround(4 * profile.inner.value_or(0)), std::lround(4 * profile.outer.value_or(0)),
           std::lround(3 * profile.place.normal.z * profile.place.normal.z), std::lround(8 * profile.sharpest)}]
        .add(profile);
  }
  std::vector<SeenWidth> seen;
  for (const auto& [kind, mean] : kinds) {
    if (mean.members() < least_members) continue;
    const Edge e = mean.fitted(noise, {});
    const double own = e.sigma_width * std::sqrt(std::max(1.0, e.excess)), lack = lack_of_curved * mean.sharpest();
    if (e.good && own < e.width)
      seen.push_back({e.width * e.width, 2 * e.width * std::hypot(own, lack * e.width), mean.axis2()});
  }
  if (seen.empty()) return {};
  return spread_of(seen);
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
  ProfileWish known{wish.noise, profile.covariance, profile.mean_curvature, profile.inner, profile.outer, wish.width};
  known.weights = profile.voxels;
  known.slope_is_free = slope_is_free;
  if (common) {
    known.noise = common->noise;
    known.width = common->spread.width(profile.place.normal);
    known.width_share = common->spread.share;
    if (const auto p = common->neighbours.near(profile.place, wish.scale)) {
      known.air = p->air;
      known.object = p->object;
      if (profile.alone() && !slope_is_free) known.slope = p->slope;
    }
  }
  Edge edge = fit_edge(profile.s, profile.values, known);
  // Misfit beyond the noise is the model's lack, which fit_edge counts for half; some of it no residual shows.
  if (common)
    edge.sigma =
        std::hypot(edge.sigma * std::sqrt(std::max(1.0, edge.excess) / std::max(1.0, edge.excess / 2)), lack_sd);
  edge.inward = profile.inward;
  edge.outward = profile.outward;
  return edge;
}

EdgeCommon common_of(const std::vector<EdgeProfile>& scouts, const EdgeWish& wish) {
  const std::size_t every = std::max<std::size_t>(1, scouts.size() / enough_for_medians);
  std::vector<Edge> edges = fit_all(scouts, wish, nullptr, false, every);
  std::vector<double> widths, excess;
  for (const Edge& e : edges)
    if (e.good) widths.push_back(e.width), excess.push_back(e.excess);
  EdgeCommon common;
  if (widths.empty()) return common;
  // The median of chi-square with the few degrees that a profile leaves is 0.85 of its mean.
  common.noise = wish.noise > 0 ? wish.noise : std::sqrt(stats::median(excess) / 0.85);
  const auto alike = [](double width) { return EdgeSpread{width * width, width * width, told_width_share}; };
  common.spread =
      wish.width ? alike(*wish.width) : common_spread(scouts, common.noise).value_or(alike(stats::median(widths)));
  EdgeWish told = wish;
  told.noise = common.noise;
  edges = fit_all(scouts, told, &common, true);
  for (std::size_t n = 0; n < scouts.size(); ++n) common.neighbours.add(scouts[n], edges[n], wish.scale);
  return common;
}

}  // namespace gonio::volume
