// See sites.h.
#include "explain/volumes/sites.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "mesh/curvature.h"
#include "stats/intervals.h"
#include "volume/sampling.h"

namespace gonio::explain::volumes {
namespace {

constexpr double smooth_cosine = 0.97;  // between a triangle's normal and its vertices': more, and the mesh has an edge
constexpr double flat_voxels = 2.5, off_wall_voxels = 1.5;

// Distance along `direction` from `at` to where the body's share passes one half.
double to_next_wall(const Body& body, Vec3 at, Vec3 direction, double voxel_m) {
  const double step = 0.25;
  const bool inside = body.at(at + direction * (off_wall_voxels * voxel_m)) > 0.5;
  for (double s = off_wall_voxels; s < far_voxels; s += step)
    if ((body.at(at + direction * (s * voxel_m)) > 0.5) != inside) return s - step / 2;
  return far_voxels;
}

bool is_wall(const Body& body, const Site& site, double voxel_m) {
  const Basis basis(site.normal);
  const double reach = std::max(voxel_m, max_component(body.cell_m));
  for (int k = -1; k < 8; ++k) {
    const double angle = k * pi / 4, radius = k < 0 ? 0 : flat_voxels * reach;
    const Vec3 at = site.at_m + basis.t * (radius * std::cos(angle)) + basis.b * (radius * std::sin(angle));
    if (!(body.at(at - site.normal * (off_wall_voxels * reach)) > 0.7)) return false;
    if (!(body.at(at + site.normal * (off_wall_voxels * reach)) < 0.3)) return false;
  }
  return true;
}

// Points on triangles: cumulative areas, and what is interpolated there.
class Surface {
 public:
  explicit Surface(const mesh::Mesh& mesh)
      : mesh_(mesh),
        normals_(mesh::averaged_normals(mesh.positions_m, mesh.triangles)),
        curvature_(mesh::mean_curvature_per_m(mesh)) {
    double sum = 0;
    for (const auto& t : mesh.triangles)
      cumulative_.push_back(sum += 0.5 * norm(cross(mesh.positions_m[t[1]] - mesh.positions_m[t[0]],
                                                    mesh.positions_m[t[2]] - mesh.positions_m[t[0]])));
  }
  double area() const { return cumulative_.back(); }
  Site drawn(Random& random, double voxel_m) const {
    const double place = random.uniform() * area();
    const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), place);
    const auto& t =
        mesh_.triangles[std::min(static_cast<std::size_t>(found - cumulative_.begin()), cumulative_.size() - 1)];
    const double root = std::sqrt(random.uniform()), v = random.uniform();
    const std::array<double, 3> w{1 - root, root * (1 - v), root * v};
    Site site;
    Vec3 normal{};
    double curvature = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      site.at_m += mesh_.positions_m[t[k]] * w[k];
      normal += normals_[t[k]] * w[k];
      curvature += w[k] * static_cast<double>(curvature_[t[k]]);
    }
    const Vec3 own = normalized(
        cross(mesh_.positions_m[t[1]] - mesh_.positions_m[t[0]], mesh_.positions_m[t[2]] - mesh_.positions_m[t[0]]));
    const bool smooth = std::ranges::all_of(t, [&](std::uint32_t k) { return dot(normals_[k], own) > smooth_cosine; });
    site.normal = smooth ? normalized(normal) : own;
    site.curvature = smooth ? -curvature * voxel_m : 0;
    return site;
  }

 private:
  const mesh::Mesh& mesh_;
  std::vector<Vec3> normals_;
  std::vector<float> curvature_;
  std::vector<double> cumulative_;
};

// Accepted places, none of which has another within `least`.
class Spread {
 public:
  explicit Spread(double least) : least_(least) {}
  bool takes(Vec3 p) {
    const std::array<long, 3> own = cell(p);
    for (long k = own[2] - 1; k <= own[2] + 1; ++k)
      for (long j = own[1] - 1; j <= own[1] + 1; ++j)
        for (long i = own[0] - 1; i <= own[0] + 1; ++i) {
          const auto found = cells_.find(key({i, j, k}));
          if (found == cells_.end()) continue;
          for (const Vec3& other : found->second)
            if (norm(other - p) < least_) return false;
        }
    cells_[key(own)].push_back(p);
    return true;
  }

 private:
  std::array<long, 3> cell(Vec3 p) const {
    return {std::lround(std::floor(p.x / least_)), std::lround(std::floor(p.y / least_)),
            std::lround(std::floor(p.z / least_))};
  }
  static std::uint64_t key(const std::array<long, 3>& c) {
    std::uint64_t h = 0;
    for (const long v : c) h = split_mix(h ^ static_cast<std::uint64_t>(v));
    return h;
  }
  double least_;
  std::unordered_map<std::uint64_t, std::vector<Vec3>> cells_;
};

}  // namespace

// Dart throwing: with places no nearer than 0.7 of the side of their share of the surface, it holds them all.
std::vector<Site> sites_of(const mesh::Mesh& mesh, const Body& body, double voxel_m, std::size_t count) {
  const Surface surface(mesh);
  const double side = std::sqrt(surface.area() / static_cast<double>(count));
  Spread spread(std::max(0.7 * side, 1.5 * voxel_m));
  Random random(1, 0x766f6c75);
  std::vector<Site> sites;
  for (std::size_t tries = 0; tries < 8 * count && sites.size() < count; ++tries) {
    const Site site = surface.drawn(random, voxel_m);
    if (spread.takes(site.at_m)) sites.push_back(site);
  }
  std::vector<char> walls(sites.size());
  parallel_for(
      0, sites.size(),
      [&](std::size_t s) {
        walls[s] = is_wall(body, sites[s], voxel_m);
        if (!walls[s]) return;
        sites[s].behind = to_next_wall(body, sites[s].at_m, -sites[s].normal, voxel_m);
        sites[s].before = to_next_wall(body, sites[s].at_m, sites[s].normal, voxel_m);
      },
      64);
  std::vector<Site> kept;
  for (std::size_t s = 0; s < sites.size(); ++s)
    if (walls[s]) kept.push_back(sites[s]);
  return kept;
}

mesh::Mesh moved(mesh::Mesh mesh, Vec3 turn_rad, Vec3 shift_m) {
  const Mat3 turn = matrix_of(quaternion_of_rotation_vector(turn_rad));
  for (Vec3& p : mesh.positions_m) p = turn * p + shift_m;
  for (Vec3& n : mesh.normals) n = turn * n;
  return mesh;
}

Sampled::Sampled(const VolumesInput& input) : volume_(input.volume), spacing_m_(input.spacing_m) {
  const auto& n = volume_.head.size;
  const Vec3 size{static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])};
  middle_ = (size - Vec3{1, 1, 1}) * 0.5;
  extent_m_ = size * spacing_m_;
  voxel_m_ = std::min({spacing_m_.x, spacing_m_.y, spacing_m_.z});
  field_m_ = 0.5 * std::min(extent_m_.x, extent_m_.y);
}
Vec3 Sampled::index_of(Vec3 p) const {
  return {p.x / spacing_m_.x + middle_.x, p.y / spacing_m_.y + middle_.y, p.z / spacing_m_.z + middle_.z};
}
Vec3 Sampled::place_of(Vec3 index) const {
  return (index - middle_) * spacing_m_;
}
double Sampled::at(Vec3 p) const {
  const auto& n = volume_.head.size;
  const volume::Block block{volume_.values.data(), n, {0, 0, 0}, {0, 0, 0}, middle_ * 2};
  return block.at(index_of(p));
}
bool Sampled::within(Vec3 p, double margin) const {
  const Vec3 index = index_of(p), last = middle_ * 2;
  for (int a = 0; a < 3; ++a)
    if (index[a] < margin || index[a] > last[a] - margin) return false;
  return std::hypot(p.x, p.y) < field_m_ - margin * voxel_m_;
}

Values values_of(const Sampled& sampled, const Body& body, const std::string& place) {
  const auto& n = sampled.volume().head.size;
  std::vector<double> inside, outside, differences;
  Random random(1, 0x76616c75);
  for (int k = 0; k < 200000; ++k) {
    const std::array<std::size_t, 3> i{random.below(static_cast<std::uint32_t>(n[0])),
                                       random.below(static_cast<std::uint32_t>(n[1])),
                                       random.below(static_cast<std::uint32_t>(n[2]))};
    if (i[0] + 2 >= n[0]) continue;
    const Vec3 at =
        sampled.place_of({static_cast<double>(i[0]) + 1, static_cast<double>(i[1]), static_cast<double>(i[2])});
    if (!sampled.within(at, 3)) continue;
    double least = 1, most = 0;
    for (const Vec3 way :
         {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
      const double share = body.at(at + way * (3 * sampled.voxel_m()));
      least = std::min(least, share), most = std::max(most, share);
    }
    if (least < 0.999 && most > 0.001) continue;
    const double a = sampled.volume().at(i[0], i[1], i[2]), b = sampled.volume().at(i[0] + 2, i[1], i[2]);
    (most > 0.5 ? inside : outside).push_back(a);
    differences.push_back((a - b) / std::sqrt(2.0));
  }
  if (inside.size() < 100 || outside.size() < 100)
    throw Error(Exit::data, place,
                "has " + std::to_string(inside.size()) +
                    " of 200000 voxels deep in the believed shape "
                    "and " +
                    std::to_string(outside.size()) + " outside of it (at least 100 each)",
                "its walls are thinner than six voxels, or the shape's pose or unit is another");
  const Values values{stats::median(outside), stats::median(inside), stats::robust_sigma(differences)};
  if (!(std::abs(values.material - values.air) > 3 * values.noise))
    throw Error(Exit::data, place,
                "does not show the believed shape: voxels in it and outside of it differ by less than "
                "three widths of the noise",
                "give the object's pose in the volume");
  return values;
}

volume::Edge edge_at(const Sampled& sampled, const Site& site, const Values& values, double reach) {
  constexpr double step = 0.5, thinnest = 2;
  if (site.behind < thinnest || site.before < thinnest) return {};
  volume::ProfileWish wish;
  wish.noise = values.noise;
  wish.mean_curvature = site.curvature;
  double low = -reach, high = reach;
  if (site.behind < 2 * reach) wish.inner = -site.behind, low = -std::min(2 * reach, site.behind + reach);
  if (site.before < 2 * reach) wish.outer = site.before, high = std::min(2 * reach, site.before + reach);
  std::vector<double> s, v;
  for (double x = low; x <= high + 1e-9; x += step) {
    s.push_back(x);
    v.push_back(sampled.at(site.at_m + site.normal * (x * sampled.voxel_m())));
    if (!std::isfinite(v.back())) return {};
  }
  return volume::fit_edge(s, v, wish);
}

}  // namespace gonio::explain::volumes
