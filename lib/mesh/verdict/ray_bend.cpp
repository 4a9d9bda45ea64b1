// Rays through glass. Lines are drawn as many through every bit of the surface from every side as isotropic light sends
// (a point by area, a direction by the cosine to the normal there: the invariant measure of lines, Santalo 1976),
// started far outside. At a crossing with unit normal n, turned against the ray d, and ratio r of the indices before
// and behind:
//   t = r d + (r cos_i - sqrt(1 - r^2 (1 - cos_i^2))) n     Snell's law; total reflection where the root is not real
// Which side the ray comes from is told by the triangle, how it bends by the normal interpolated over the triangle.
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "mesh/mesh.h"
#include "mesh/triangle_tree.h"
#include "mesh/verdict.h"

namespace gonio::mesh {
namespace {

constexpr int most_crossings = 64;

struct Passage {
  Vec3 direction{};
  std::uint64_t path = 1;  // a bit a crossing behind a leading one: 1 where it was a total reflection
  bool left = false;       // the ray came out within `most_crossings`
};

class Glass {
 public:
  Glass(const io::TriangleMesh& mesh, double eta)
      : mesh_(mesh),
        tree_(mesh.positions_m, mesh.triangles),
        normals_(mesh.normals.empty() ? averaged_normals(mesh.positions_m, mesh.triangles) : mesh.normals),
        eta_(eta) {
    if (mesh.triangles.empty())
      throw Error(Exit::data, "mesh", "a mesh without triangles bends no ray", "give a closed mesh");
    Vec3 low = mesh.positions_m[mesh.triangles[0][0]], high = low;
    for (const auto& t : mesh.triangles)
      for (const std::uint32_t v : t) {
        const Vec3 p = mesh.positions_m[v];
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
      }
    extent_ = norm(high - low);
    centre_ = (low + high) / 2;
  }
  double extent() const { return extent_; }
  Vec3 centre() const { return centre_; }

  // `disturb` may turn the normal of a crossing.
  Passage through(Vec3 origin, Vec3 direction, const std::function<Vec3(Vec3)>& disturb) const {
    Passage passage{direction};
    for (int i = 0; i < most_crossings; ++i) {
      const auto hit = tree_.first_hit(origin, passage.direction, 1e-9 * extent_);
      if (!hit) {
        passage.left = true;
        return passage;
      }
      origin += passage.direction * hit->t;
      cross_surface(*hit, passage, disturb);
    }
    return passage;
  }

 private:
  void cross_surface(const TriangleTree::Hit& hit, Passage& passage, const std::function<Vec3(Vec3)>& disturb) const {
    const auto& [a, b, c] = mesh_.triangles[hit.triangle];
    const Vec3 p = mesh_.positions_m[a];
    const Vec3 flat = normalized(cross(mesh_.positions_m[b] - p, mesh_.positions_m[c] - p));
    Vec3 n = normals_[a] * hit.weights[0] + normals_[b] * hit.weights[1] + normals_[c] * hit.weights[2];
    n = norm(n) > 0 ? normalized(n) : flat;
    if (disturb) n = disturb(n);
    const Vec3 d = passage.direction;
    const bool entering = dot(d, flat) < 0;
    if (dot(d, n) * dot(d, flat) <= 0) n = flat;
    if (!entering) n = -n;
    const double ratio = entering ? 1 / eta_ : eta_, cosine = -dot(d, n);
    const double squared = 1 - ratio * ratio * (1 - cosine * cosine);
    const bool reflected = squared < 0;
    passage.direction =
        normalized(reflected ? d + n * (2 * cosine) : d * ratio + n * (ratio * cosine - std::sqrt(squared)));
    // Beyond 62 crossings the path is remembered by a mix of its bits.
    passage.path = passage.path >> 62 ? split_mix(passage.path + reflected) >> 1 | 1ull << 62
                                      : passage.path << 1 | std::uint64_t{reflected};
  }

  const io::TriangleMesh& mesh_;
  TriangleTree tree_;
  std::vector<Vec3> normals_;
  double eta_, extent_ = 0;
  Vec3 centre_{};
};

class Lines {
 public:
  explicit Lines(const io::TriangleMesh& mesh) : mesh_(mesh), running_(mesh.triangles.size()) {
    for (std::size_t t = 0; t < running_.size(); ++t) running_[t] = sum_ += norm(doubled_area(t));
    if (!(sum_ > 0)) throw Error(Exit::data, "mesh", "its surface has no area", "give a closed mesh");
  }
  // A point of the surface and a direction into it.
  std::pair<Vec3, Vec3> draw(Random& random) const {
    const auto found = std::upper_bound(running_.begin(), running_.end(), random.uniform() * sum_);
    const auto t = std::min(static_cast<std::size_t>(found - running_.begin()), running_.size() - 1);
    const auto& [a, b, c] = mesh_.triangles[t];
    const double root = std::sqrt(random.uniform()), v = random.uniform();
    const Vec3 point =
        mesh_.positions_m[a] * (1 - root) + mesh_.positions_m[b] * (root * (1 - v)) + mesh_.positions_m[c] * (root * v);
    const double sine = std::sqrt(random.uniform()), angle = 2 * pi * random.uniform();
    const Vec3 local{sine * std::cos(angle), sine * std::sin(angle), std::sqrt(1 - sine * sine)};
    return {point, -Basis(normalized(doubled_area(t))).to_world(local)};
  }

 private:
  Vec3 doubled_area(std::size_t t) const {
    const auto& [a, b, c] = mesh_.triangles[t];
    const Vec3 p = mesh_.positions_m[a];
    return cross(mesh_.positions_m[b] - p, mesh_.positions_m[c] - p);
  }
  const io::TriangleMesh& mesh_;
  std::vector<double> running_;
  double sum_ = 0;
};

double angle_between(Vec3 a, Vec3 b) {
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

// angles: one a ray; negative where the paths differ, NaN where neither has a path to compare.
RayBend summary(std::vector<double> angles) {
  RayBend bend;
  bend.differing_paths =
      static_cast<std::size_t>(std::count_if(angles.begin(), angles.end(), [](double a) { return a < 0; }));
  std::erase_if(angles, [](double a) { return !(a >= 0); });
  bend.rays = angles.size();
  if (angles.empty()) return bend;
  double squares = 0;
  for (const double a : angles) squares += a * a;
  bend.rms_rad = std::sqrt(squares / static_cast<double>(angles.size()));
  std::sort(angles.begin(), angles.end());
  bend.median_rad = angles[angles.size() / 2];
  bend.p95_rad = angles[static_cast<std::size_t>(0.95 * static_cast<double>(angles.size() - 1))];
  return bend;
}

double difference(const Passage& a, const Passage& b) {
  if (!a.left && !b.left) return std::numeric_limits<double>::quiet_NaN();
  return a.left != b.left || a.path != b.path ? -1 : angle_between(a.direction, b.direction);
}

}  // namespace

RayBend ray_bend(const io::TriangleMesh& mesh, const io::TriangleMesh& reference, double eta, std::size_t rays,
                 std::uint64_t seed) {
  const Glass glass(mesh, eta), truth(reference, eta);
  const Lines lines(reference);
  const double back = 2 * (truth.extent() + glass.extent() + norm(truth.centre() - glass.centre()));
  std::vector<double> angles(rays);
  parallel_for(
      0, rays,
      [&](std::size_t i) {
        Random random(seed, i);
        const auto [point, direction] = lines.draw(random);
        const Vec3 origin = point - direction * back;
        angles[i] = difference(glass.through(origin, direction, {}), truth.through(origin, direction, {}));
      },
      64);
  return summary(std::move(angles));
}

RayBend ray_bend_of_noise(const io::TriangleMesh& mesh, double normal_noise_rad, double eta, std::size_t rays,
                          std::uint64_t seed) {
  const Glass glass(mesh, eta);
  const Lines lines(mesh);
  std::vector<double> angles(rays);
  parallel_for(
      0, rays,
      [&](std::size_t i) {
        Random random(seed, i);
        const auto [point, direction] = lines.draw(random);
        const Vec3 origin = point - direction * (2 * glass.extent());
        // The angle's two components have half of its mean square each.
        const auto disturb = [&](Vec3 n) {
          const Basis basis(n);
          const double sd = normal_noise_rad / std::sqrt(2.0);
          const double x = sd * random.normal(), y = sd * random.normal();
          return normalized(n + basis.t * x + basis.b * y);
        };
        angles[i] = difference(glass.through(origin, direction, disturb), glass.through(origin, direction, {}));
      },
      64);
  return summary(std::move(angles));
}

}  // namespace gonio::mesh
