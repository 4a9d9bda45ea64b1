// Candidates for markers: RANSAC over oriented points, local by an octree (Schnabel, Wahl & Klein 2007).
//
// A marker's vertices lie together, so that pairs are drawn within one cell of an octree, at each of its levels: a
// sphere of radius R is found in cells of R/2 to R. Of two points with unit normals that lie on one sphere p_1 - R n_1
// = p_2 - R n_2, and the least squares of it are
//   R = (p_1 - p_2) . (n_1 - n_2) / |n_1 - n_2|^2,   c = mean(p - R n).
// The best of some draws is refitted to its inliers in the cell, then to the surface all round, largest cover first.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "base/random.h"
#include "linear/solve.h"
#include "stats/intervals.h"
#include "volume/contour_shape.h"
#include "volume/markers_parts.h"

namespace gonio::volume::marker {
namespace {

constexpr int draws = 16;
constexpr std::size_t patch_points = 64;
constexpr double aligned = 0.88;  // cosine between a normal and the radius: noise of 28 degrees
constexpr std::size_t coarse_directions = 48, fine_directions = 192;

double inlier_band(double radius) {
  return std::max(0.6, 0.04 * std::abs(radius));
}
bool supports(const Candidate& c, Vec3 p, Vec3 n, double band) {
  const Vec3 d = p - c.centre;
  const double r = norm(d), sign = c.radius < 0 ? -1 : 1;
  return std::abs(r - std::abs(c.radius)) < band && sign * dot(n, d) > aligned * r;
}

// c and R of p = c + R n, least squares over points.
struct Moments {
  double count = 0, pn = 0, nn = 0;
  Vec3 p{}, n{};
  void add(Vec3 place, Vec3 normal) {
    count += 1, p += place, n += normal, pn += dot(place, normal), nn += dot(normal, normal);
  }
  Candidate sphere() const {
    const double spread = nn - dot(n, n) / count;
    const double radius = spread > 1e-9 ? (pn - dot(p, n) / count) / spread : 0;
    return {(p - n * radius) / count, radius};
  }
};

bool plausible(const Candidate& c, const MarkerWish& wish, double slack) {
  const double r = std::abs(c.radius);
  if (wish.radius) return std::abs(r - *wish.radius) <= (wish.radius_tolerance + slack) * *wish.radius;
  return r >= wish.smallest * (1 - slack) && r <= wish.largest * (1 + slack);
}

// The best sphere of a cell's points; radius 0: none.
Candidate of_patch(const Cloud& cloud, const std::vector<std::uint32_t>& points, const MarkerWish& wish, double edge,
                   Random& random) {
  constexpr double slack = 0.3;
  Candidate best;
  std::size_t most = 0;
  std::vector<Vec3> p, n;
  for (const std::uint32_t v : points) p.push_back(cloud.place(v)), n.push_back(cloud.normal(v));
  const auto count = static_cast<std::uint32_t>(points.size());
  const auto fits = [&](const Candidate& c) {
    return plausible(c, wish, slack) && std::abs(c.radius) > 0.3 * edge && std::abs(c.radius) < 4 * edge;
  };
  for (int draw = 0; draw < draws; ++draw) {
    const std::uint32_t a = random.below(count), b = random.below(count);
    if (dot(n[a] - n[b], n[a] - n[b]) < 0.02) continue;
    Moments two;
    two.add(p[a], n[a]), two.add(p[b], n[b]);
    const Candidate c = two.sphere();
    if (!fits(c)) continue;
    std::size_t inliers = 0;
    for (std::uint32_t i = 0; i < count; ++i) inliers += supports(c, p[i], n[i], inlier_band(c.radius)) ? 1 : 0;
    if (inliers > most) most = inliers, best = c;
  }
  for (int round = 0; round < 2 && most > 0; ++round) {
    Moments all;
    for (std::uint32_t i = 0; i < count; ++i)
      if (supports(best, p[i], n[i], inlier_band(best.radius))) all.add(p[i], n[i]);
    if (all.count < 8 || all.count < 0.25 * count) return {};
    best = all.sphere();
    if (!fits(best)) return {};
  }
  return most > 0 ? best : Candidate{};
}

// For each direction the vertex nearest to the sphere, within `band` of it and looking the right way.
struct Seen {
  double cover = 0;
  std::vector<std::uint32_t> vertices{};
};
Seen seen_round(const Cloud& cloud, const Candidate& c, const std::vector<Vec3>& directions, double band) {
  Seen seen;
  const double radius = std::abs(c.radius);
  // Vertices are up to a voxel apart, and directions that are further apart than that see each its own.
  const double beside = std::max(1.2, 0.6 * radius * std::sqrt(4 * pi / static_cast<double>(directions.size())));
  for (const Vec3 d : directions) {
    const Vec3 near = c.centre + d * (radius - band), far = c.centre + d * (radius + band);
    const Vec3 low{std::min(near.x, far.x) - 1, std::min(near.y, far.y) - 1, std::min(near.z, far.z) - 1},
        high{std::max(near.x, far.x) + 1, std::max(near.y, far.y) + 1, std::max(near.z, far.z) + 1};
    double least = HUGE_VAL;
    std::uint32_t best = 0;
    cloud.for_each_near(low, high, [&](std::uint32_t v) {
      const Vec3 p = cloud.place(v), from = p - c.centre;
      const double along = dot(from, d), aside = norm(from - d * along);
      if (along < 0 || aside > beside || !supports(c, p, cloud.normal(v), band)) return;
      const double off = std::abs(norm(from) - radius) + 0.05 * aside;
      if (off < least) least = off, best = v;
    });
    if (std::isfinite(least)) seen.vertices.push_back(best);
  }
  seen.cover = static_cast<double>(seen.vertices.size()) / static_cast<double>(directions.size());
  return seen;
}

// Gauss-Newton on |p - c| - R over the vertices that are seen, twice as far as is likely counting no more.
Candidate fitted_round(const Cloud& cloud, Candidate c, const std::vector<std::uint32_t>& vertices) {
  const double sign = c.radius < 0 ? -1 : 1;
  double radius = std::abs(c.radius);
  for (int round = 0; round < 5; ++round) {
    Eigen::Matrix4d h = Eigen::Matrix4d::Zero();
    Eigen::Vector4d g = Eigen::Vector4d::Zero();
    std::vector<double> off;
    for (const std::uint32_t v : vertices) off.push_back(std::abs(norm(cloud.place(v) - c.centre) - radius));
    const double limit = std::max(0.15, 3 * stats::median(off));
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const Vec3 d = cloud.place(vertices[i]) - c.centre;
      const double r = norm(d), w = off[i] <= limit ? 1 : limit / off[i];
      const Eigen::Vector4d j(d.x / r, d.y / r, d.z / r, 1);
      h += w * j * j.transpose();
      g += w * j * (r - radius);
    }
    const Eigen::Vector4d step = linear::solve_ldlt(h, g);
    if (!step.allFinite() || step.norm() > radius) break;
    c.centre += Vec3{step[0], step[1], step[2]};
    radius += step[3];
    if (step.norm() < 1e-3) break;
  }
  c.radius = sign * radius;
  return c;
}

bool alike(const Candidate& a, const Candidate& b) {
  const double r = std::abs(b.radius);
  return norm(a.centre - b.centre) < 0.2 * r && std::abs(a.radius - b.radius) < 0.2 * r;
}
// Two bodies cannot be in one place; a bubble may lie in a body.
bool overlap(const Candidate& a, const Candidate& b) {
  if ((a.radius < 0) != (b.radius < 0)) return false;
  return norm(a.centre - b.centre) < 0.75 * (std::abs(a.radius) + std::abs(b.radius));
}

std::vector<Candidate> drawn(const Cloud& cloud, const MarkerWish& wish) {
  const double smallest = wish.radius.value_or(wish.smallest), largest = wish.radius.value_or(wish.largest);
  const std::vector<Vec3> directions = even_directions(coarse_directions);
  std::vector<Candidate> all;
  int level = 0;
  for (double edge = Cloud::cell; edge / 2 <= std::max(largest, Cloud::cell); edge *= 2, ++level) {
    if (4 * edge < smallest) continue;
    const auto patches = cloud.patches(edge, patch_points, wish.seed + static_cast<std::uint64_t>(level));
    std::vector<Candidate> found(patches.size());
    parallel_for(
        0, patches.size(),
        [&](std::size_t n) {
          if (patches[n].size() < 8) return;
          Random random(wish.seed, 1000003 * static_cast<std::uint64_t>(level + 1) + n);
          Candidate c = of_patch(cloud, patches[n], wish, edge, random);
          if (c.radius == 0) return;
          c.cover = seen_round(cloud, c, directions, std::max(1.0, 0.15 * std::abs(c.radius))).cover;
          found[n] = c;
        },
        64);
    for (const Candidate& c : found)
      if (c.radius != 0 && c.cover > 0.6 * wish.least_cover) all.push_back(c);
  }
  std::ranges::stable_sort(all, [](const Candidate& a, const Candidate& b) { return a.cover > b.cover; });
  return all;
}

}  // namespace

std::vector<Vec3> even_directions(std::size_t count) {
  std::vector<Vec3> d;
  for (std::size_t n = 0; n < count; ++n) {
    const double z = 1 - (2 * static_cast<double>(n) + 1) / static_cast<double>(count);
    const double phi = static_cast<double>(n) * pi * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
    d.push_back({r * std::cos(phi), r * std::sin(phi), z});
  }
  return d;
}

std::vector<Candidate> candidates(const Cloud& cloud, const MarkerWish& wish) {
  const std::vector<Vec3> directions = even_directions(fine_directions);
  std::vector<Candidate> tried, accepted;
  for (const Candidate& start : drawn(cloud, wish)) {
    if (std::ranges::any_of(tried, [&](const Candidate& t) { return alike(start, t); })) continue;
    Candidate c = start;
    Seen seen;
    for (const double band : {0.15, 0.1, 0.05}) {
      seen = seen_round(cloud, c, directions, std::max(0.8, band * std::abs(c.radius)));
      if (seen.vertices.size() < 8) break;
      c = fitted_round(cloud, c, seen.vertices);
    }
    tried.push_back(start);
    if (seen.vertices.size() < 8 || !plausible(c, wish, 0.1)) continue;
    c.cover = seen_round(cloud, c, directions, std::max(0.6, 0.03 * std::abs(c.radius))).cover;
    tried.push_back(c);
    if (c.cover > 0.6 * wish.least_cover) accepted.push_back(c);
  }
  std::ranges::stable_sort(accepted, [](const Candidate& a, const Candidate& b) { return a.cover > b.cover; });
  std::vector<Candidate> kept;
  for (const Candidate& c : accepted)
    if (std::ranges::none_of(kept, [&](const Candidate& k) { return overlap(c, k); })) kept.push_back(c);
  return kept;
}

Cloud::Cloud(const Contour& surface, Vec3 scale) : surface_(surface), scale_(scale) {
  const std::size_t n = surface.positions.size();
  low_ = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high_ = -low_;
  for (std::uint32_t v = 0; v < n; ++v) {
    const Vec3 p = place(v);
    low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y), std::min(low_.z, p.z)};
    high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y), std::max(high_.z, p.z)};
  }
  for (int a = 0; a < 3; ++a)
    cells_[static_cast<std::size_t>(a)] = static_cast<std::size_t>((high_[a] - low_[a]) / cell) + 1;
  const auto cell_of = [&](std::uint32_t v) {
    const Vec3 d = (place(v) - low_) / cell;
    const auto at = [&](double x, std::size_t limit) { return std::min(static_cast<std::size_t>(x), limit - 1); };
    return (at(d.z, cells_[2]) * cells_[1] + at(d.y, cells_[1])) * cells_[0] + at(d.x, cells_[0]);
  };
  starts_.assign(cells_[0] * cells_[1] * cells_[2] + 1, 0);
  for (std::uint32_t v = 0; v < n; ++v) ++starts_[cell_of(v) + 1];
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  order_.resize(n);
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::uint32_t v = 0; v < n; ++v) order_[next[cell_of(v)]++] = v;
}

Vec3 Cloud::place(std::uint32_t v) const {
  return vector_of(surface_.positions[v]) * scale_;
}
Vec3 Cloud::normal(std::uint32_t v) const {
  return normal_of(surface_, v, scale_);
}

std::vector<std::vector<std::uint32_t>> Cloud::patches(double edge, std::size_t at_most, std::uint64_t seed) const {
  const auto side = static_cast<std::size_t>(std::lround(edge / cell));
  std::array<std::size_t, 3> count{};
  for (std::size_t a = 0; a < 3; ++a) count[a] = (cells_[a] + side - 1) / side;
  std::vector<std::vector<std::uint32_t>> result;
  for (std::size_t k = 0; k < count[2]; ++k)
    for (std::size_t j = 0; j < count[1]; ++j)
      for (std::size_t i = 0; i < count[0]; ++i) {
        std::vector<std::uint32_t> points;
        std::size_t seen = 0;
        Random random(seed, (k * count[1] + j) * count[0] + i);
        for (std::size_t z = k * side; z < std::min(cells_[2], (k + 1) * side); ++z)
          for (std::size_t y = j * side; y < std::min(cells_[1], (j + 1) * side); ++y) {
            const std::size_t row = (z * cells_[1] + y) * cells_[0];
            const std::uint32_t last = starts_[row + std::min(cells_[0], (i + 1) * side)];
            for (std::uint32_t n = starts_[row + i * side]; n < last; ++n, ++seen) {  // a reservoir
              if (points.size() < at_most) {
                points.push_back(order_[n]);
              } else if (const std::uint32_t at = random.below(static_cast<std::uint32_t>(seen + 1)); at < at_most) {
                points[at] = order_[n];
              }
            }
          }
        if (!points.empty()) result.push_back(std::move(points));
      }
  return result;
}

}  // namespace gonio::volume::marker
