// See relief.h.
#include "relief/relief.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "relief/gaps.h"

namespace gonio::relief {

// Lengths along x and y in cells, z in metres; the place on the ray is at + t direction.
struct Relief::Ray {
  double x = 0, y = 0, z = 0;     // in the present period
  double dx = 0, dy = 0, dz = 0;  // per t
  double t = 0;                   // where the present tile was entered
  int i = 0, j = 0;               // its cell at t: counted, not found anew
  bool first = false;             // starts on the patch of this cell
};

Relief::Relief(int nx, int ny, double step_x_m, double step_y_m, std::vector<double> z_m, bool periodic,
               const std::string& place)
    : nx_(nx), ny_(ny), step_x_m_(step_x_m), step_y_m_(step_y_m), z_m_(std::move(z_m)), periodic_(periodic) {
  if (nx < 2 || ny < 2 || z_m_.size() != static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny))
    throw Error(Exit::data, place, "has " + std::to_string(nx) + " x " + std::to_string(ny) + " points",
                "a relief needs two a side");
  if (!(step_x_m > 0 && step_y_m > 0 && std::isfinite(step_x_m) && std::isfinite(step_y_m)))
    throw Error(Exit::data, place, "has no step between its points", "state it");
  if (!std::all_of(z_m_.begin(), z_m_.end(), [](double z) { return std::isfinite(z); }))
    throw Error(Exit::data, place, "has points without height", "fill them first");
  build_levels();
}

Relief::Patch Relief::patch(int i, int j) const {
  const int right = i + 1 == nx_ ? 0 : i + 1, up = j + 1 == ny_ ? 0 : j + 1;
  const double z00 = z_m_[index(i, j)], z10 = z_m_[index(right, j)], z01 = z_m_[index(i, up)],
               z11 = z_m_[index(right, up)];
  return {z00, z10 - z00, z01 - z00, z00 - z10 - z01 + z11};
}

Vec3 Relief::normal(const Place& at) const {
  const Patch p = patch(at.i, at.j);
  return normalized(Vec3{-(p.b + p.d * at.v) / step_x_m_, -(p.c + p.d * at.u) / step_y_m_, 1});
}

double Relief::height_m(const Place& at) const {
  const Patch p = patch(at.i, at.j);
  return p.a + p.b * at.u + p.c * at.v + p.d * at.u * at.v;
}

void Relief::build_levels() {
  Level base{cells_x(), cells_y(), {}, {}};
  for (int j = 0; j < base.ny; ++j)
    for (int i = 0; i < base.nx; ++i) {
      const Patch p = patch(i, j);
      const auto [low, high] = std::minmax({p.a, p.a + p.b, p.a + p.c, p.a + p.b + p.c + p.d});
      base.low.push_back(low), base.high.push_back(high);
    }
  levels_.push_back(std::move(base));
  while (levels_.back().nx > 1 || levels_.back().ny > 1) {
    const Level& fine = levels_.back();
    Level coarse{(fine.nx + 1) / 2, (fine.ny + 1) / 2, {}, {}};
    const auto size = static_cast<std::size_t>(coarse.nx) * static_cast<std::size_t>(coarse.ny);
    coarse.low.assign(size, 1e300), coarse.high.assign(size, -1e300);
    for (int j = 0; j < fine.ny; ++j)
      for (int i = 0; i < fine.nx; ++i) {
        const auto from = static_cast<std::size_t>(j * fine.nx + i),
                   to = static_cast<std::size_t>(j / 2 * coarse.nx + i / 2);
        coarse.low[to] = std::min(coarse.low[to], fine.low[from]);
        coarse.high[to] = std::max(coarse.high[to], fine.high[from]);
      }
    levels_.push_back(std::move(coarse));
  }
}

std::optional<Hit> Relief::met_from_above(double x_m, double y_m, Vec3 direction) const {
  Ray ray;
  ray.x = x_m / step_x_m_, ray.y = y_m / step_y_m_, ray.z = highest_m();
  if (periodic_) {
    ray.x -= cells_x() * std::floor(ray.x / cells_x());
    ray.y -= cells_y() * std::floor(ray.y / cells_y());
  } else if (ray.x < 0 || ray.y < 0 || ray.x > cells_x() || ray.y > cells_y()) {
    return {};
  }
  ray.i = std::min(static_cast<int>(ray.x), cells_x() - 1);
  ray.j = std::min(static_cast<int>(ray.y), cells_y() - 1);
  ray.dx = direction.x / step_x_m_, ray.dy = direction.y / step_y_m_, ray.dz = direction.z;
  return follow(ray);
}

std::optional<Hit> Relief::met_from(const Hit& from, Vec3 direction) const {
  Ray ray;
  ray.i = from.place.i, ray.j = from.place.j;
  ray.x = ray.i + from.place.u, ray.y = ray.j + from.place.v, ray.z = from.z_m;
  ray.dx = direction.x / step_x_m_, ray.dy = direction.y / step_y_m_, ray.dz = direction.z;
  ray.first = true;
  return follow(ray);
}

// Against a + b u + c v + d u v, with u = x + t dx - i, ...: the height above the patch is q0 + q1 t + q2 t^2.
std::optional<Hit> Relief::met_in_cell(Ray& ray, double leaves) const {
  const Patch p = patch(ray.i, ray.j);
  const double u = ray.x - ray.i, v = ray.y - ray.j;
  double q0 = ray.z - (p.a + p.b * u + p.c * v + p.d * u * v);
  const double q1 = ray.dz - (p.b * ray.dx + p.c * ray.dy + p.d * (u * ray.dy + v * ray.dx)),
               q2 = -p.d * ray.dx * ray.dy;
  double met = -1;
  if (ray.first) {  // t = 0 is one of the two solutions
    if (q2 < 0 && q1 > 0 && -q1 / q2 <= leaves) met = -q1 / q2;
  } else {
    const double at_entry = q0 + ray.t * (q1 + ray.t * q2), at_exit = q0 + leaves * (q1 + leaves * q2);
    if (at_entry <= 0) {  // through a crack of rounding's width
      if (q1 + 2 * q2 * ray.t < 0) met = ray.t;
    } else if (at_exit <= 0 || q2 > 0) {
      const double inner = q1 * q1 - 4 * q2 * q0;
      if (inner >= 0) {
        const double w = -0.5 * (q1 + std::copysign(std::sqrt(inner), q1));
        double near = q2 != 0 ? w / q2 : INFINITY, far = w != 0 ? q0 / w : INFINITY;
        if (near > far) std::swap(near, far);
        met = near >= ray.t ? near : far;
        if (at_exit <= 0) met = std::clamp(met, ray.t, leaves);
        if (met < ray.t || met > leaves) met = -1;
      } else if (at_exit <= 0) {
        met = leaves;
      }
    }
  }
  if (met < 0) return {};
  Hit hit;
  hit.place = {ray.i, ray.j, std::clamp(u + met * ray.dx, 0.0, 1.0), std::clamp(v + met * ray.dy, 0.0, 1.0)};
  hit.normal = normal(hit.place);
  hit.z_m = height_m(hit.place);
  return hit;
}

// Into the neighbour of the present tile; false where the ray leaves an open relief. A periodic one moves the ray back
// by its period.
bool Relief::step(Ray& ray, int level, double leaves, bool along_x) const {
  const int size = 1 << level, last_x = cells_x() - 1, last_y = cells_y() - 1;
  const int left = ray.i >> level << level, bottom = ray.j >> level << level;
  const auto across = [&](double at, int first, int last) {
    return std::clamp(static_cast<int>(std::floor(at)), first, std::min(first + size - 1, last));
  };
  ray.t = leaves;
  ray.first = false;
  if (along_x) {
    ray.j = across(ray.y + leaves * ray.dy, bottom, last_y);
    ray.i = ray.dx > 0 ? left + size : left - 1;
    if (ray.i >= 0 && ray.i <= last_x) return true;
    ray.x += ray.dx > 0 ? -cells_x() : cells_x();
    ray.i = ray.dx > 0 ? 0 : last_x;
  } else {
    ray.i = across(ray.x + leaves * ray.dx, left, last_x);
    ray.j = ray.dy > 0 ? bottom + size : bottom - 1;
    if (ray.j >= 0 && ray.j <= last_y) return true;
    ray.y += ray.dy > 0 ? -cells_y() : cells_y();
    ray.j = ray.dy > 0 ? 0 : last_y;
  }
  return periodic_;
}

std::optional<Hit> Relief::follow(Ray ray) const {
  constexpr long most_tiles = 1'000'000;  // of a path that stays level with the highest point
  const int top = static_cast<int>(levels_.size()) - 1;
  int level = ray.first ? 0 : top;
  const double per_dx = 1 / ray.dx, per_dy = 1 / ray.dy;
  for (long tiles = 0; tiles < most_tiles; ++tiles) {
    const Level& l = levels_[static_cast<std::size_t>(level)];
    const int tx = ray.i >> level, ty = ray.j >> level;
    const int right = std::min((tx + 1) << level, cells_x()), up = std::min((ty + 1) << level, cells_y());
    const double out_x = ray.dx > 0   ? (right - ray.x) * per_dx
                         : ray.dx < 0 ? ((tx << level) - ray.x) * per_dx
                                      : INFINITY,
                 out_y = ray.dy > 0   ? (up - ray.y) * per_dy
                         : ray.dy < 0 ? ((ty << level) - ray.y) * per_dy
                                      : INFINITY;
    const double leaves = std::max(ray.t, std::min(out_x, out_y));
    const bool straight = !std::isfinite(leaves);  // along z
    const double enters_z = ray.z + ray.t * ray.dz,
                 lowest = ray.dz < 0 ? (straight ? -INFINITY : ray.z + leaves * ray.dz) : enters_z;
    if (ray.dz >= 0 && enters_z > highest_m()) return {};
    if (lowest <= l.high[static_cast<std::size_t>(ty * l.nx + tx)]) {
      if (level > 0) {
        --level;
        continue;
      }
      // Along z a patch is met at once: far enough for its height.
      if (const auto hit =
              met_in_cell(ray, straight ? 2 * (highest_m() - lowest_m()) / std::abs(ray.dz) + ray.t + 1 : leaves))
        return hit;
    }
    if (straight) return {};
    if (!step(ray, level, leaves, out_x <= out_y)) return {};
    if (level < top) ++level;
  }
  return {};
}

Relief relief_of(const io::HeightMap& map, Tiling tiling, const std::string& place, std::size_t* missing) {
  io::HeightMap whole = map;
  const std::size_t gaps = fill_gaps(whole, place);
  if (missing != nullptr) *missing = gaps;
  const auto w = static_cast<int>(map.width), h = static_cast<int>(map.height);
  const bool mirrored = tiling == Tiling::mirrored;
  const int nx = mirrored ? 2 * (w - 1) : w, ny = mirrored ? 2 * (h - 1) : h;
  std::vector<double> z;
  z.reserve(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny));
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const int x = i < w ? i : nx - i, up = j < h ? j : ny - j;
      z.push_back(whole.at(static_cast<std::size_t>(x), static_cast<std::size_t>(h - 1 - up)));
    }
  return {nx, ny, map.step_x_m, map.step_y_m, std::move(z), tiling != Tiling::open, place};
}

io::HeightMap map_of(const Relief& relief) {
  io::HeightMap map{static_cast<std::size_t>(relief.nx()),
                    static_cast<std::size_t>(relief.ny()),
                    relief.step_x_m(),
                    relief.step_y_m(),
                    {}};
  for (int j = relief.ny() - 1; j >= 0; --j)
    for (int i = 0; i < relief.nx(); ++i) map.z_m.push_back(relief.z_m(i, j));
  return map;
}

}  // namespace gonio::relief
