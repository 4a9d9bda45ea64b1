#include "relighting/body_walks.h"

#include <algorithm>
#include <mutex>
#include <optional>

#include "base/parallel.h"
#include "base/random.h"
#include "geom/cubic_weights.h"
#include "mesh/topology.h"
#include "relighting/clearance.h"
#include "relighting/image_model.h"
#include "relighting/surface_samples.h"

namespace gonio::relighting {
namespace {

constexpr int most_scatterings = 340;
constexpr double shortest_m = 1e-4;      // of the tables' l_s, which grow by half octaves
constexpr std::size_t table_count = 20;  // to 72 mm

std::size_t bin_of(int scatterings) {
  if (scatterings < 4) return static_cast<std::size_t>(scatterings);
  return std::min(BodyWalks::orders - 1, static_cast<std::size_t>(4 + std::log(scatterings / 4.0) / std::log(1.4)));
}

// Mean of n over a bin: over 1 / n^1.5, as the walks of a half space leave it.
double mean_order(std::size_t bin) {
  if (bin < 4) return static_cast<double>(bin);
  double sum = 0, weight = 0;
  for (int n = 4; n <= most_scatterings; ++n)
    if (bin_of(n) == bin) sum += std::pow(n, -0.5), weight += std::pow(n, -1.5);
  return weight > 0 ? sum / weight : most_scatterings;
}

Vec3 about(Vec3 n, double cosine, double azimuth) {
  const Vec3 t = normalized(std::abs(n.x) > 0.7 ? cross(n, Vec3{0, 1, 0}) : cross(n, Vec3{1, 0, 0}));
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  return t * (sine * std::cos(azimuth)) + cross(n, t) * (sine * std::sin(azimuth)) + n * cosine;
}

// Any direction is as likely as any other.
Vec3 any_direction(Random& random) {
  const double azimuth = 2 * pi * random.uniform(), cosine = 2 * random.uniform() - 1;
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  return {-sine * std::sin(azimuth), sine * std::cos(azimuth), cosine};
}

struct Start {
  std::size_t view = 0, facet = 0;
  render::SurfacePoint point;
};

struct Departure {
  render::SurfacePoint point;  // outside
  int scatterings = 0;
};

// The bodies alone, and how far the nearest surface is at least.
struct Bodies {
  std::vector<scene::Instance> instances;
  std::vector<std::uint32_t> number;  // of each in the scene
  std::unique_ptr<render::RayCaster> caster;
  Clearance clearance;

  Bodies(const Setting& setting, std::size_t surface) {
    for (std::size_t i = 0; i < setting.scene.instances.size(); ++i)
      if (setting.scene.instances[i].surface == surface) {
        instances.push_back(setting.scene.instances[i]);
        number.push_back(static_cast<std::uint32_t>(i));
      }
    caster = std::make_unique<render::RayCaster>(instances);
    clearance = Clearance(instances);
  }

  std::optional<Departure> outside(const std::optional<render::SurfacePoint>& hit, int scatterings) const {
    if (!hit) return std::nullopt;
    render::SurfacePoint point = hit->outside ? *hit : render::beyond(*hit);
    point.instance = number[hit->instance];
    return Departure{point, scatterings};
  }

  std::optional<Departure> walk(const render::SurfacePoint& from, double mean_path_m, Random& random) const {
    const render::SurfacePoint below = render::beyond(from);
    Vec3 direction = about(below.geometric_normal, std::sqrt(random.uniform()), 2 * pi * random.uniform());
    double path_m = -mean_path_m * std::log(random.uniform());
    if (caster->occluded(below, direction, path_m)) return outside(caster->closest_from(below, direction), 0);
    Vec3 at = below.position_m + direction * path_m;
    for (int n = 1; n <= most_scatterings; ++n) {
      direction = any_direction(random);
      path_m = -mean_path_m * std::log(random.uniform());
      if (path_m > clearance.at(at) && caster->blocked(at, direction, path_m))
        return outside(caster->closest(at, direction), n);
      at += direction * path_m;
    }
    return std::nullopt;
  }
};

// Patches are means over a part of a pixel: the surface is near them along the line of sight, within a pixel or, where
// it is seen at grazing angles, a few.
std::optional<render::SurfacePoint> seen_at(const Bodies& bodies, const Patch& patch, double pixel_m) {
  for (const double back : {1.0, 4.0, 16.0}) {
    const auto found = bodies.caster->closest(patch.position_m + patch.wo * (back * pixel_m), -patch.wo);
    if (found && found->outside && found->distance_m < 2 * back * pixel_m) return found;
  }
  return std::nullopt;
}

std::vector<Start> starts_of(const Setting& s, const Bodies& bodies, std::size_t surface) {
  std::vector<Start> starts;
  for (std::size_t v = 0; v < s.model.views(); ++v) {
    const ViewCache& cache = s.model.cache(v);
    const View& view = s.recordings.views[v];
    const Vec2 centre = view.model.principal_point_px();
    const auto here = view.model.ray(centre), next = view.model.ray({centre.x + 1, centre.y});
    const double across = norm(next.direction - here.direction), across_m = norm(next.origin_m - here.origin_m);
    for (std::size_t f = 0; f < cache.facets.size(); ++f) {
      if (cache.facets[f].surface != surface) continue;
      const Facet& facet = cache.facets[f];
      const Patch& patch = cache.patches[facet.first_patch + facet.patches / 2];
      const double pixel_m = across_m + across * norm(patch.position_m - view.world_from_camera.translation_m);
      if (const auto point = seen_at(bodies, patch, pixel_m)) starts.push_back({v, f, *point});
    }
  }
  return starts;
}

}  // namespace

bool are_bodies(const Setting& setting, std::size_t surface) {
  for (const scene::Instance& instance : setting.scene.instances) {
    if (instance.surface != surface) continue;
    if (std::holds_alternative<scene::Plane>(instance.shape)) return false;
    if (const auto* mesh = std::get_if<std::shared_ptr<const mesh::Mesh>>(&instance.shape)) {
      const mesh::Topology topology = mesh::topology_of(**mesh);
      const auto edges = static_cast<double>((*mesh)->triangles.size()) * 1.5;
      if (topology.disagreeing_edges > 0 || !(topology.volume_m3 > 0)) return false;
      if (static_cast<double>(topology.boundary_edges) > 0.01 * edges) return false;
    }
  }
  return true;
}

struct BodyWalks::Tables {
  const render::RayCaster& caster;  // of the whole scene
  const std::vector<LightSource> sources;
  Bodies bodies;
  std::vector<Start> starts;
  std::vector<std::vector<std::uint32_t>> place;  // [view][facet] -> place among starts, or none
  std::size_t lights, walks;
  std::array<double, orders> mean{};
  std::mutex mutex;
  std::array<std::vector<float>, table_count> made;  // [start][light][order]
  static constexpr std::uint32_t none = 0xffffffff;

  Tables(const Setting& s, std::size_t surface, std::size_t count)
      : caster(s.caster),
        sources(s.layout.lights),
        bodies(s, surface),
        starts(starts_of(s, bodies, surface)),
        lights(sources.size()),
        walks(count) {
    for (std::size_t v = 0; v < s.model.views(); ++v) place.emplace_back(s.model.cache(v).facets.size(), none);
    for (std::size_t k = 0; k < starts.size(); ++k)
      place[starts[k].view][starts[k].facet] = static_cast<std::uint32_t>(k);
    for (std::size_t b = 0; b < orders; ++b) mean[b] = mean_order(b);
  }

  void fill(std::size_t start, double mean_path_m, float* row) const {
    for (std::size_t w = 0; w < walks; ++w) {
      Random random(67, start * walks + w);
      const auto left = bodies.walk(starts[start].point, mean_path_m, random);
      if (!left) continue;
      const std::size_t bin = bin_of(left->scatterings);
      for (std::size_t l = 0; l < lights; ++l) row[l * orders + bin] += received(caster, left->point, sources[l]);
    }
    for (std::size_t i = 0; i < lights * orders; ++i) row[i] /= static_cast<float>(walks);
  }

  void need(std::size_t table) {
    const std::lock_guard lock(mutex);
    if (!made[table].empty() || starts.empty()) return;
    std::vector<float> rows(starts.size() * lights * orders);
    const double mean_path_m = shortest_m * std::pow(2.0, 0.5 * static_cast<double>(table));
    parallel_for(
        0, starts.size(), [&](std::size_t k) { fill(k, mean_path_m, &rows[k * lights * orders]); }, 8);
    made[table] = std::move(rows);
  }
};

BodyWalks::BodyWalks(const Setting& setting, std::size_t surface, std::size_t walks)
    : tables_(std::make_unique<Tables>(setting, surface, walks)) {}
BodyWalks::~BodyWalks() = default;

BodyWalks::Weights BodyWalks::weights(double path_m, double albedo) const {
  Weights w;
  const double a = std::clamp(albedo, 0.01, 0.99), alpha = scattering_albedo(a);
  const double mean_path_m = path_m * std::sqrt(3 * (1 - alpha));
  for (std::size_t b = 0; b < orders; ++b) w.of_order[b] = std::pow(alpha, tables_->mean[b]) / a;
  const double last = static_cast<double>(table_count - 1);
  const double halves = 2 * std::log2(std::max(mean_path_m, 1e-9) / shortest_m);
  if (halves < 0) w.own_share = 1 - mean_path_m / shortest_m;
  const double place = std::clamp(halves, 0.0, last);
  const auto lower = std::min(static_cast<std::size_t>(place), table_count - 2);
  w.of_table = cubic_weights(place - static_cast<double>(lower));
  w.tables = {lower > 0 ? lower - 1 : 0, lower, lower + 1, std::min(lower + 2, table_count - 1)};
  for (std::size_t k = 0; k < 4; ++k)
    if (w.of_table[k] != 0) tables_->need(w.tables[k]);
  return w;
}

double BodyWalks::spread(const Weights& w, std::size_t view, std::size_t facet, std::size_t light, double own) const {
  const std::uint32_t start = tables_->place[view][facet];
  if (start == Tables::none) return own;
  const std::size_t row = (start * tables_->lights + light) * orders;
  double spread = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (w.of_table[k] == 0) continue;
    const float* rows = &tables_->made[w.tables[k]][row];
    for (std::size_t b = 0; b < orders; ++b) spread += w.of_table[k] * w.of_order[b] * double{rows[b]};
  }
  return spread + w.own_share * (own - spread);
}

}  // namespace gonio::relighting
