// See believed_body.h.
#include "explain/volumes/believed_body.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"

namespace gonio::explain::volumes {
namespace {

constexpr int rays_across = 2;  // of a cell, along i and along j

struct Crossing {
  double z = 0;
  int turn = 0;  // +1 where a ray along +z enters
};

// Columns of rays along z. A ray never meets an edge of a mesh exactly: its place has digits that no mesh has.
class Columns {
 public:
  Columns(const Body& body) : body_(body), across_(body.size[0] * rays_across), along_(body.size[1] * rays_across) {
    crossings_.resize(across_ * along_);
  }
  void add(const mesh::Mesh& mesh) {
    for (const std::array<std::uint32_t, 3>& t : mesh.triangles)
      add(mesh.positions_m[t[0]], mesh.positions_m[t[1]], mesh.positions_m[t[2]]);
  }
  std::vector<Crossing>& at(std::size_t u, std::size_t v) { return crossings_[v * across_ + u]; }

 private:
  double place(double first, double cell, std::size_t ray) const {
    return first + cell * ((static_cast<double>(ray) + 0.5) / rays_across - 0.5 + 1.234567e-7);
  }
  std::pair<std::size_t, std::size_t> range(double low, double high, double first, double cell, std::size_t n) const {
    const double a = ((low - first) / cell + 0.5) * rays_across - 1,
                 b = ((high - first) / cell + 0.5) * rays_across + 1;
    const double last = static_cast<double>(n);
    return {static_cast<std::size_t>(std::clamp(a, 0.0, last)), static_cast<std::size_t>(std::clamp(b, 0.0, last))};
  }
  void add(Vec3 a, Vec3 b, Vec3 c) {
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (area == 0) return;
    const auto [u0, u1] =
        range(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), body_.first_m.x, body_.cell_m.x, across_);
    const auto [v0, v1] =
        range(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}), body_.first_m.y, body_.cell_m.y, along_);
    for (std::size_t v = v0; v < v1; ++v)
      for (std::size_t u = u0; u < u1; ++u) {
        const double x = place(body_.first_m.x, body_.cell_m.x, u), y = place(body_.first_m.y, body_.cell_m.y, v);
        const double wb = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / area;
        const double wc = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
        if (wb < 0 || wc < 0 || wb + wc > 1) continue;
        crossings_[v * across_ + u].push_back({a.z + wb * (b.z - a.z) + wc * (c.z - a.z), area < 0 ? 1 : -1});
      }
  }
  const Body& body_;
  std::size_t across_, along_;
  std::vector<std::vector<Crossing>> crossings_;
};

// Adds the piece from..to of a ray to a column of cells, each of `weight`.
void fill(Body& body, std::size_t i, std::size_t j, double from, double to, double weight) {
  const double low = (from - body.first_m.z) / body.cell_m.z + 0.5, high = (to - body.first_m.z) / body.cell_m.z + 0.5;
  const double end = static_cast<double>(body.size[2]);
  const double a = std::clamp(low, 0.0, end), b = std::clamp(high, 0.0, end);
  const std::size_t slice = body.size[0] * body.size[1];
  for (auto k = static_cast<std::size_t>(a); k < body.size[2] && static_cast<double>(k) < b; ++k) {
    const double part = std::min(b, static_cast<double>(k) + 1) - std::max(a, static_cast<double>(k));
    body.share[k * slice + j * body.size[0] + i] += static_cast<float>(weight * part);
  }
}

}  // namespace

double Body::at(Vec3 p) const {
  const double g[3] = {(p.x - first_m.x) / cell_m.x, (p.y - first_m.y) / cell_m.y, (p.z - first_m.z) / cell_m.z};
  double sum = 0;
  std::ptrdiff_t low[3];
  double f[3];
  for (int a = 0; a < 3; ++a) {
    const double floor = std::floor(g[a]);
    if (!(floor >= -1 && floor < static_cast<double>(size[static_cast<std::size_t>(a)]))) return 0;
    low[a] = static_cast<std::ptrdiff_t>(floor), f[a] = g[a] - floor;
  }
  for (int corner = 0; corner < 8; ++corner) {
    std::size_t index[3];
    double weight = 1;
    bool within = true;
    for (int a = 0; a < 3; ++a) {
      const bool upper = corner >> a & 1;
      const std::ptrdiff_t k = low[a] + (upper ? 1 : 0);
      within = within && k >= 0 && k < static_cast<std::ptrdiff_t>(size[static_cast<std::size_t>(a)]);
      index[a] = static_cast<std::size_t>(k);
      weight *= upper ? f[a] : 1 - f[a];
    }
    if (within && weight > 0)
      sum += weight * static_cast<double>(share[(index[2] * size[1] + index[1]) * size[0] + index[0]]);
  }
  return sum;
}

Body body_of(const mesh::Mesh& mesh, std::array<std::size_t, 3> size, Vec3 extent_m, const std::string& place) {
  Body body;
  body.size = size;
  body.cell_m = {extent_m.x / static_cast<double>(size[0]), extent_m.y / static_cast<double>(size[1]),
                 extent_m.z / static_cast<double>(size[2])};
  body.first_m = body.cell_m * 0.5 - extent_m * 0.5;
  body.share.assign(size[0] * size[1] * size[2], 0);
  Columns columns(body);
  columns.add(mesh);
  std::size_t broken = 0, met = 0;
  constexpr double weight = 1.0 / (rays_across * rays_across);
  for (std::size_t v = 0; v < size[1] * rays_across; ++v)
    for (std::size_t u = 0; u < size[0] * rays_across; ++u) {
      std::vector<Crossing>& c = columns.at(u, v);
      if (c.empty()) continue;
      ++met;
      std::sort(c.begin(), c.end(), [](const Crossing& a, const Crossing& b) { return a.z < b.z; });
      int depth = 0;
      bool sound = true;
      for (std::size_t k = 0; k < c.size(); ++k) {
        if (depth > 0) fill(body, u / rays_across, v / rays_across, c[k - 1].z, c[k].z, weight);
        depth += c[k].turn;
        sound = sound && depth >= 0;
      }
      broken += !sound || depth != 0;
    }
  if (met == 0) throw Error(Exit::data, place, "lies outside of the volume", "give the object's pose in the volume");
  if (20 * broken > met)
    throw Error(Exit::data, place,
                "is not closed, or its triangles face inwards: " + std::to_string(broken) + " of " +
                    std::to_string(met) + " rays through it do not leave it",
                "close the mesh: scene check");
  for (float& share : body.share) share = std::clamp(share, 0.0f, 1.0f);
  return body;
}

}  // namespace gonio::explain::volumes
