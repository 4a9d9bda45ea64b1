// Vertices moved to where their edges say that the wall is: move_to_steepest of threshold.h.
//
// Of a neighbour j the plane through its wall q_j = p_j + t_j n_j tells where along n_i the wall of vertex i is. With
// either normal alone the plane misses a surface of curvature k by k d^2 / 2, outwards with n_j and inwards with n_i;
// with their mean it does not:
//   t_ij = (q_j - p_i) . (n_i + n_j) / (1 + n_i . n_j)
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "volume/contour_shape.h"
#include "volume/crossings.h"
#include "volume/threshold.h"

namespace gonio::volume {
namespace {

constexpr double neighbour_sd = 0.1;     // voxels: how well a neighbour's plane foretells this vertex' wall
constexpr double alike = 0.9;            // cosine between normals: beyond it there is a crease between them
constexpr int filling_rounds = 8;        // so many edges far do good edges lend their shift
constexpr int halvings = 5;              // then a vertex stays where it was

struct Mover {
  Contour& contour;
  const std::vector<Edge>& edges;
  double at_most;
  Vec3 scale;
  std::vector<Vec3> place{}, normal{};   // before
  std::vector<double> shift{}, share{};  // along the normal, and how much of it is taken
  std::vector<bool> known{};

  std::size_t vertices() const { return contour.positions.size(); }
  Vec3 moved(std::size_t v) const { return place[v] + normal[v] * (shift[v] * share[v]); }
  void prepare();
  void average();
  void fill();
  void bound();
  void unfold();
  void uncross();
  bool relent(std::uint32_t v);
  void store();
};

void Mover::prepare() {
  const std::size_t n = vertices();
  place.resize(n), normal.resize(n), shift.assign(n, 0), share.assign(n, 1), known.assign(n, false);
  for (std::size_t v = 0; v < n; ++v) {
    place[v] = vector_of(contour.positions[v]) * scale;
    normal[v] = normal_of(contour, v, scale);
    known[v] = edges[v].good && is_finite(normal[v]);
    if (!is_finite(normal[v])) normal[v] = {};
  }
}

// Every edge between vertices is a side of two triangles, and counts twice for both: the weights stay in proportion.
void Mover::average() {
  const std::size_t n = vertices();
  std::vector<double> sum(n), weight(n), sides(n);
  for (const auto& t : contour.triangles)
    for (const std::uint32_t v : t) sides[v] += 1;
  for (std::size_t v = 0; v < n; ++v) {
    if (!known[v]) continue;
    const double w = 1 / (edges[v].sigma * edges[v].sigma + 1e-6);
    sum[v] = w * edges[v].position, weight[v] = w;
  }
  const auto tell = [&](std::uint32_t to, std::uint32_t from) {
    if (!known[to] || !known[from] || dot(normal[to], normal[from]) < alike) return;
    const Vec3 wall = place[from] + normal[from] * edges[from].position;
    const double t = dot(wall - place[to], normal[to] + normal[from]) / (1 + dot(normal[to], normal[from]));
    if (std::abs(t - edges[to].position) > 3 * std::hypot(edges[to].sigma, edges[from].sigma, neighbour_sd)) return;
    // All neighbours together count for one: their edges were fitted to the same voxels.
    const double w = 1 / (edges[from].sigma * edges[from].sigma + neighbour_sd * neighbour_sd) / (2 * sides[to]);
    sum[to] += w * t, weight[to] += w;
  };
  for (const auto& t : contour.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      tell(t[i], t[(i + 1) % 3]);
      tell(t[(i + 1) % 3], t[i]);
    }
  for (std::size_t v = 0; v < n; ++v)
    if (known[v]) shift[v] = sum[v] / weight[v];
}

void Mover::fill() {
  const std::size_t n = vertices();
  std::vector<bool> filled = known;
  for (int round = 0; round < filling_rounds; ++round) {
    std::vector<double> sum(n), count(n);
    for (const auto& t : contour.triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = t[i], b = t[(i + 1) % 3];
        if (filled[a] && !filled[b]) sum[b] += shift[a], count[b] += 1;
        if (filled[b] && !filled[a]) sum[a] += shift[b], count[a] += 1;
      }
    bool more = false;
    for (std::size_t v = 0; v < n; ++v)
      if (!filled[v] && count[v] > 0) shift[v] = sum[v] / count[v], filled[v] = true, more = true;
    if (!more) return;
  }
}

void Mover::bound() {
  for (std::size_t v = 0; v < vertices(); ++v)
    shift[v] = std::clamp(shift[v], -std::min(at_most, edges[v].inward / 3), std::min(at_most, edges[v].outward / 3));
}

// True where there was something left to take back.
bool Mover::relent(std::uint32_t v) {
  if (share[v] == 0 || shift[v] == 0) return false;
  share[v] = share[v] < std::ldexp(1.5, -halvings) ? 0 : share[v] / 2;
  return true;
}

// A triangle that turns over, or shrinks to a tenth of its height, was moved by more than its vertices are apart.
void Mover::unfold() {
  for (bool again = true; again;) {
    again = false;
    for (const auto& t : contour.triangles) {
      const Vec3 before = cross(place[t[1]] - place[t[0]], place[t[2]] - place[t[0]]);
      const Vec3 after = cross(moved(t[1]) - moved(t[0]), moved(t[2]) - moved(t[0]));
      if (dot(before, after) >= 0.1 * dot(before, before)) continue;
      for (const std::uint32_t v : t) again = relent(v) || again;
    }
  }
}

void Mover::uncross() {
  std::vector<Vec3> there(vertices());
  std::vector<bool> stirred(vertices());
  for (std::size_t v = 0; v < vertices(); ++v) there[v] = moved(v), stirred[v] = shift[v] * share[v] != 0;
  for (bool again = true; again;) {
    again = false;
    std::vector<bool> next(vertices());
    for (const auto& pair : crossing_triangles(there, contour.triangles, stirred))
      for (const std::uint32_t t : pair)
        for (const std::uint32_t v : contour.triangles[t])
          if (!next[v] && relent(v)) next[v] = again = true;
    if (again) unfold();
    for (std::size_t v = 0; v < vertices(); ++v) {
      const Vec3 now = moved(v);
      next[v] = next[v] || !(now == there[v]);
      there[v] = now;
    }
    stirred.swap(next);
  }
}

void Mover::store() {
  for (std::size_t v = 0; v < vertices(); ++v) {
    if (shift[v] * share[v] == 0) continue;
    const Vec3 p = divided(moved(v), scale);
    contour.positions[v] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
  }
}

Refined figures(const Mover& mover) {
  Refined r;
  std::vector<double> sigmas;
  double sum = 0, squares = 0;
  for (std::size_t v = 0; v < mover.vertices(); ++v) {
    const double t = mover.shift[v] * mover.share[v];
    (t != 0 ? r.moved : r.held) += 1;
    if (mover.known[v]) sigmas.push_back(mover.edges[v].sigma);
    sum += t, squares += t * t;
    r.largest_shift = std::max(r.largest_shift, std::abs(t));
  }
  const double n = static_cast<double>(std::max<std::size_t>(1, mover.vertices()));
  r.unfitted = mover.vertices() - sigmas.size();
  r.mean_shift = sum / n;
  r.rms_shift = std::sqrt(squares / n);
  if (sigmas.empty()) return r;
  const auto middle = sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
  std::nth_element(sigmas.begin(), middle, sigmas.end());
  r.sigma_position = *middle;
  return r;
}

}  // namespace

Refined move_to_steepest(Contour& contour, const std::vector<Edge>& edges, double at_most, Vec3 scale) {
  if (edges.size() != contour.positions.size())
    throw Error(Exit::internal, "move_to_steepest", std::to_string(edges.size()) + " edges for " +
                                                        std::to_string(contour.positions.size()) + " vertices");
  Mover mover{contour, edges, at_most, scale};
  mover.prepare();
  mover.average();
  mover.fill();
  mover.bound();
  mover.unfold();
  mover.uncross();
  mover.store();
  return figures(mover);
}

}  // namespace gonio::volume
