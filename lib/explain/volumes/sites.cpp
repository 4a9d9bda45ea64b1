// See sites.h.
#include "explain/volumes/sites.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "base/parallel.h"
#include "base/random.h"
#include "mesh/curvature.h"
#include "volume/sampling.h"

namespace gonio::explain::volumes {
namespace {

constexpr double smooth_cosine = 0.97;  // between a triangle's normal and its vertices': more, and the mesh has an edge
constexpr double flat_voxels = 2.5, off_wall_voxels = 1.5;

// Distance along `direction` to the next wall, voxels.
double to_next_wall(const mesh::TriangleTree& tree, Vec3 at, Vec3 direction, double voxel_m) {
  const auto hit = tree.first_hit(at, direction, 0.05 * voxel_m);
  return hit ? std::min(far_voxels, hit->t / voxel_m) : far_voxels;
}

// The surface round the place is met within off_wall_voxels of its plane, and has material behind it.
bool is_wall(const mesh::TriangleTree& tree, const Site& site, double voxel_m) {
  if (site.behind < thinnest_voxels || site.before < thinnest_voxels) return false;
  const Basis basis(site.normal);
  const double off = std::min(off_wall_voxels, 0.5 * site.before);
  for (int k = 0; k < 8; ++k) {
    const double angle = k * pi / 4, radius = flat_voxels * voxel_m;
    const Vec3 at = site.at_m + basis.t * (radius * std::cos(angle)) + basis.b * (radius * std::sin(angle));
    const auto hit = tree.first_hit(at + site.normal * (off * voxel_m), -site.normal, 0);
    if (!hit || hit->t > (off + std::min(off_wall_voxels, 0.5 * site.behind)) * voxel_m) return false;
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
std::vector<Site> sites_of(const mesh::Mesh& mesh, const mesh::TriangleTree& tree, double voxel_m, std::size_t count) {
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
        sites[s].behind = to_next_wall(tree, sites[s].at_m, -sites[s].normal, voxel_m);
        sites[s].before = to_next_wall(tree, sites[s].at_m, sites[s].normal, voxel_m);
        walls[s] = is_wall(tree, sites[s], voxel_m);
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

Sampled::Sampled(const io::VolumeData& volume, Vec3 spacing_m) : volume_(volume), spacing_m_(spacing_m) {
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

volume::Edge edge_at(const Sampled& sampled, const Site& site, const Values& values, double reach) {
  volume::ProfileWish wish;
  wish.noise = values.noise;
  wish.mean_curvature = site.curvature;
  if (site.behind < 2 * reach) wish.inner = -site.behind;
  if (site.before < 2 * reach) wish.outer = site.before;
  const ProfileRange range = profile_range(site, reach);
  std::vector<double> s, v;
  for (double x = range.low; x <= range.high + 1e-9; x += profile_step) {
    s.push_back(x);
    v.push_back(sampled.at(site.at_m + site.normal * (x * sampled.voxel_m())));
    if (!std::isfinite(v.back())) return {};
  }
  return volume::fit_edge(s, v, wish);
}

}  // namespace gonio::explain::volumes
