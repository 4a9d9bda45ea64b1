// Bundles: which outlines of different views show one marker.
//
// Every pair of outlines of two views whose rays meet (Sampson's distance first, then the point by least squares) is a
// seed; a seed grows by the outline of a further view that agrees with it best, one at a time. Bundles of many views go
// first and take their outlines away from the others; what is left of those is met anew. Outlines that no bundle of
// three views has may belong to several bundles of two: the epipolar constraint alone cannot tell these rivals apart,
// the layout of the markers can.
#include <algorithm>
#include <map>
#include <queue>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "linear/geom_matrices.h"
#include "reassembly/bundle_fate.h"
#include "reassembly/bundle_sight.h"
#include "stats/distributions.h"

namespace gonio::reassembly {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Grown {
  std::vector<Sighting> sightings;  // ascending
  Meeting meeting;
  double p = 1;
};
// Most views first; among equals the one that agrees best. Ties by place, so that no order of input shows.
bool worse_bundle(const Grown& a, const Grown& b) {
  if (a.sightings.size() != b.sightings.size()) return a.sightings.size() < b.sightings.size();
  if (a.p != b.p) return a.p < b.p;
  return a.meeting.centre.x() < b.meeting.centre.x();
}
struct WorseBundle {
  bool operator()(const Grown& a, const Grown& b) const { return worse_bundle(a, b); }
};

class BundleGrower {
 public:
  BundleGrower(std::span<const View> views, const PlaceWish& wish) : radius_(wish.radius_m) {
    for (std::size_t v = 0; v < views.size(); ++v) {
      auto& sights = sights_.emplace_back();
      for (std::size_t i = 0; i < views[v].outlines.size(); ++i)
        sights.push_back(
            sight_of(views[v], views[v].outlines[i], format("%s, outline %zu", views[v].image.c_str(), i)));
    }
  }

  std::vector<Grown> all() {
    std::vector<std::pair<double, std::array<std::size_t, 2>>> pairs;
    for (std::size_t a = 0; a < sights_.size(); ++a)
      for (std::size_t b = a + 1; b < sights_.size(); ++b)
        if (!sights_[a].empty() && !sights_[b].empty())
          pairs.push_back({-(sights_[a][0].origin - sights_[b][0].origin).norm(), {a, b}});
    std::ranges::sort(pairs);  // wide baselines first: their points are the surest
    std::vector<Grown> out;
    for (const auto& [baseline, ab] : pairs) seeds_of(ab[0], ab[1], out);
    return out;
  }

  std::optional<Grown> met(std::vector<Sighting> sightings) const {
    std::ranges::sort(sightings, {}, &Sighting::view);
    std::vector<const Sight*> sights;
    for (const Sighting& s : sightings) sights.push_back(&at(s));
    const auto meeting = meet(sights, radius_);
    if (!meeting) return {};
    return Grown{std::move(sightings), *meeting, stats::chi2_upper(meeting->chi_square, std::max(1, meeting->degrees))};
  }
  const std::vector<std::vector<Sight>>& sights() const { return sights_; }

 private:
  const Sight& at(const Sighting& s) const { return sights_[s.view][s.outline]; }

  // Whether the ray of b passes that of a within what both may be off, roughly: what is left is then met properly.
  static bool near_epipolar(const Sight& a, const Sight& b) {
    const Vector3d base = b.origin - a.origin, n = linear::cross_matrix(base) * a.axis;
    const double length = n.norm(), baseline = base.norm();
    if (!(length > 1e-6 * baseline)) return baseline > 0;
    const auto spread = [&](const Sight& s) {
      const double turn = s.firm ? 0 : s.pose.topLeftCorner<3, 3>().trace();
      const double shift = s.firm ? 0 : s.pose.bottomRightCorner<3, 3>().trace() / (baseline * baseline);
      return std::sqrt(s.covariance(0, 0) + s.covariance(1, 1) + turn + 4 * shift);
    };
    return std::abs(n.dot(b.axis)) < 6 * length * (2 * spread(a) * baseline / length + spread(b));
  }

  void seeds_of(std::size_t a, std::size_t b, std::vector<Grown>& out) {
    for (std::size_t i = 0; i < sights_[a].size(); ++i)
      for (std::size_t j = 0; j < sights_[b].size(); ++j) {
        if (!near_epipolar(sights_[a][i], sights_[b][j])) continue;
        const std::array<Sighting, 2> both{Sighting{a, i}, Sighting{b, j}};
        if (settled_.contains(key(both[0], both[1]))) continue;
        auto grown = met({both[0], both[1]});
        if (!grown || grown->p < least_p) continue;
        grow(*grown);
        if (grown->sightings.size() > 3)
          for (std::size_t k = 0; k < grown->sightings.size(); ++k)
            for (std::size_t l = k + 1; l < grown->sightings.size(); ++l)
              settled_.insert(key(grown->sightings[k], grown->sightings[l]));
        out.push_back(std::move(*grown));
      }
  }

  void grow(Grown& grown) const {
    std::vector<bool> closed(sights_.size());
    for (const Sighting& s : grown.sightings) closed[s.view] = true;
    for (;;) {
      std::optional<Sighting> best;
      double least = 0;
      for (std::size_t v = 0; v < sights_.size(); ++v)
        if (!closed[v]) nearest_in(v, grown.meeting, best, least);
      if (!best) return;
      closed[best->view] = true;
      auto sightings = grown.sightings;
      sightings.push_back(*best);
      auto larger = met(std::move(sightings));
      if (larger && larger->p > least_p) grown = std::move(*larger);
    }
  }

  // The outline of a view that agrees with the point, if it does so better than `least`.
  void nearest_in(std::size_t v, const Meeting& meeting, std::optional<Sighting>& best, double& least) const {
    static const double gate = stats::chi2_quantile(1 - 1e-4, 2);
    if (sights_[v].empty()) return;
    const Vector3d p = meeting.centre - sights_[v][0].origin;
    const double d = p.norm(), off = std::sqrt(meeting.covariance.trace()) / d;
    for (std::size_t i = 0; i < sights_[v].size(); ++i) {
      const Sight& s = sights_[v][i];
      const double turn = s.firm ? 0 : s.pose.topLeftCorner<3, 3>().trace();
      const double shift = s.firm ? 0 : s.pose.bottomRightCorner<3, 3>().trace() / (d * d);
      const double reach = 5 * (off + std::sqrt(s.covariance(0, 0) + s.covariance(1, 1) + turn + shift));
      if (s.axis.dot(p) < d * std::cos(std::min(reach, 1.5))) continue;
      Misfit m;
      if (!misfit(s, meeting.centre, meeting.radius, m)) continue;
      Matrix3d c = s.covariance + m.by_point * meeting.covariance * m.by_point.transpose();
      if (!s.firm) c += m.by_pose * s.pose * m.by_pose.transpose();
      c(2, 2) += m.by_radius[2] * m.by_radius[2] * meeting.radius_variance;
      const Vector3d r = lower_inverse(lower_root(c)) * m.r;
      if (r.head<2>().squaredNorm() > gate || (s.sized && meeting.sized && std::abs(r[2]) > 4)) continue;
      const double square = r.head<2>().squaredNorm() + (s.sized && meeting.sized ? size_cost(r[2]) : 0);
      if (!best || square < least) best = Sighting{v, i}, least = square;
    }
  }

  static std::array<std::size_t, 4> key(const Sighting& a, const Sighting& b) {
    return {a.view, a.outline, b.view, b.outline};
  }

  static constexpr double least_p = 1e-4;  // of a bundle's chi-square
  std::optional<double> radius_;
  std::vector<std::vector<Sight>> sights_;
  std::set<std::array<std::size_t, 4>> settled_;
};

// Every outline goes to the best bundle that asks for it.
std::vector<Grown> selected(const BundleGrower& grower, const std::vector<Grown>& all,
                            std::vector<std::vector<std::size_t>>& owner_size) {
  std::priority_queue<Grown, std::vector<Grown>, WorseBundle> queue(WorseBundle{}, all);
  std::vector<Grown> out;
  while (!queue.empty()) {
    Grown top = queue.top();
    queue.pop();
    std::vector<Sighting> free;
    for (const Sighting& s : top.sightings)
      if (owner_size[s.view][s.outline] == 0) free.push_back(s);
    if (free.size() == top.sightings.size()) {
      for (const Sighting& s : top.sightings) owner_size[s.view][s.outline] = free.size();
      out.push_back(std::move(top));
    } else if (free.size() >= 2) {
      if (auto less = grower.met(std::move(free)); less && less->p > 1e-4) queue.push(std::move(*less));
    }
  }
  return out;
}

// Bundles of two views that lost to another one of two views by chance alone.
void add_rivals(const std::vector<Grown>& all, const std::vector<std::vector<std::size_t>>& owner_size,
                std::vector<Grown>& chosen) {
  constexpr std::size_t most = 240;
  std::set<std::array<std::size_t, 4>> known;
  const auto key = [](const Grown& g) {
    return std::array{g.sightings[0].view, g.sightings[0].outline, g.sightings[1].view, g.sightings[1].outline};
  };
  for (const Grown& g : chosen)
    if (g.sightings.size() == 2) known.insert(key(g));
  std::vector<const Grown*> rivals;
  for (const Grown& g : all)
    if (g.sightings.size() == 2 &&
        std::ranges::all_of(g.sightings, [&](const Sighting& s) { return owner_size[s.view][s.outline] == 2; }) &&
        known.insert(key(g)).second)
      rivals.push_back(&g);
  std::ranges::sort(rivals, [](const Grown* a, const Grown* b) { return worse_bundle(*b, *a); });
  for (const Grown* g : rivals)
    if (chosen.size() < most) chosen.push_back(*g);
}

}  // namespace

Bundles bundles(std::span<const View> views, const PlaceWish& wish) {
  if (wish.radius_m && !(*wish.radius_m > 0))
    throw Error(Exit::data, "radius of the markers", format("%g m is not above 0", *wish.radius_m),
                "give the spheres' radius, or leave it out");
  BundleGrower grower(views, wish);
  const std::vector<Grown> all = grower.all();
  std::vector<std::vector<std::size_t>> owner_size;
  for (const View& v : views) owner_size.emplace_back(v.outlines.size(), 0);
  std::vector<Grown> chosen = selected(grower, all, owner_size);
  if (views.size() <= 4) add_rivals(all, owner_size, chosen);
  Bundles out;
  for (const Grown& g : chosen) {
    const Meeting& m = g.meeting;
    Bundle b{g.sightings, {m.centre.x(), m.centre.y(), m.centre.z()}, linear::mat3_of(m.covariance), {}, m.chi_square,
             m.degrees};
    if (m.sized) b.radius_m = m.radius;
    out.found.push_back(std::move(b));
  }
  out.fate = fates(grower.sights(), out.found);
  return out;
}

}  // namespace gonio::reassembly
