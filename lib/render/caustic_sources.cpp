#include "render/caustic_sources.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"

namespace gonio::render {
namespace {

constexpr double even_share = 0.1;  // of draws that ignore what the probes saw
constexpr int probes = 4;           // per cell

Ball ball_of_mesh(const mesh::Mesh& mesh, const Rigid<frame::World, frame::Object>& pose) {
  Vec3 low = mesh.positions_m.front(), high = low;
  for (const Vec3 p : mesh.positions_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return {pose * ((low + high) * 0.5), norm(high - low) / 2};
}

// Smallest of the balls around both, not the smallest of all.
Ball around(Ball a, Ball b) {
  const double distance = norm(b.centre_m - a.centre_m);
  if (distance + b.radius_m <= a.radius_m) return a;
  if (distance + a.radius_m <= b.radius_m) return b;
  const double radius = (distance + a.radius_m + b.radius_m) / 2;
  return {a.centre_m + (b.centre_m - a.centre_m) * ((radius - a.radius_m) / distance), radius};
}

}  // namespace

Ball ball_around(const scene::Instance& instance) {
  const auto& pose = instance.world_from_object;
  if (const auto* sphere = std::get_if<scene::Sphere>(&instance.shape)) return {pose.translation_m, sphere->radius_m};
  if (const auto* plane = std::get_if<scene::Plane>(&instance.shape))
    return {pose.translation_m, std::hypot(plane->size_x_m, plane->size_y_m) / 2};
  Ball ball = ball_of_mesh(*std::get<std::shared_ptr<const mesh::Mesh>>(instance.shape), pose);
  ball.radius_m *= 1 + 1e-9;
  return ball;
}

bool has_smooth_lobe(const scene::Scene& scene, std::size_t number) {
  const scene::Surface& surface = scene.appearance.surfaces[number];
  surface::Values values = surface.values;
  // A textured parameter may be anything; its lower bound is where roughness vanishes.
  for (const scene::Texture& texture : surface.textures) {
    const double low = surface.model->info().parameters[texture.parameter].lower;
    values.v[texture.parameter] = {low, low, low};
  }
  surface::Layer base;
  if (surface.base) {
    const scene::Surface& beneath = scene.appearance.surfaces[*surface.base];
    base = {beneath.model, beneath.values};
    values.base = &base;
  }
  if (surface.model->transmits())
    if (const auto medium = surface.model->interior(values)) values.eta = medium->eta;
  if (values.eta == Rgb{1, 1, 1} && surface.model->transmits()) values.eta = Rgb{1.3, 1.3, 1.3};  // seen from elsewhere
  Random random(1);
  for (const double cosine : {0.95, 0.6, 0.2})
    for (int i = 0; i < 16; ++i) {
      const Vec3 wo{std::sqrt(1 - cosine * cosine), 0, cosine};
      const Vec2 u{random.uniform(), random.uniform()};
      const surface::Sample sample = surface.model->sample(values, wo, u, (i + 0.5) / 16);
      if (sample.pdf > 0 && sample.delta) return true;
    }
  return false;
}

CausticSources::CausticSources(const scene::Scene& scene, std::vector<const light::Emitter*> emitters)
    : emitters_(std::move(emitters)), sources_(emitters_.size()) {
  std::vector<bool> smooth;
  for (std::size_t i = 0; i < scene.appearance.surfaces.size(); ++i) smooth.push_back(has_smooth_lobe(scene, i));
  for (const scene::Instance& instance : scene.instances)
    if (smooth[instance.surface]) balls_.push_back(ball_around(instance));
  if (balls_.empty()) return;
  all_ = balls_.front();
  for (const Ball& ball : balls_) all_ = around(all_, ball);
  for (std::size_t i = 0; i < emitters_.size(); ++i) {
    sources_[i] = prepare(i);
    total_ += sources_[i].chance;
  }
  const auto count = std::count_if(sources_.begin(), sources_.end(), [](const Source& s) { return s.chance > 0; });
  for (Source& source : sources_)
    if (source.chance > 0)
      source.chance = (1 - even_share) * source.chance / total_ + even_share / static_cast<double>(count);
}

light::Emission CausticSources::emission(std::size_t emitter, Vec2 position, Vec2 direction) const {
  if (!sources_[emitter].distant) return emitters_[emitter]->emit(position, direction);
  const light::Sample sample = emitters_[emitter]->sample(all_.centre_m, {0.5, 0.5});
  const double r = all_.radius_m * std::sqrt(position.x), phi = 2 * pi * position.y;
  const Vec3 across = Basis(sample.direction).to_world({r * std::cos(phi), r * std::sin(phi), 0});
  return {all_.centre_m + across + sample.direction * (100 * all_.radius_m), -sample.direction,
          sample.weight * (pi * all_.radius_m * all_.radius_m), sample.valid};
}

bool CausticSources::hits_ball(Vec3 origin_m, Vec3 direction) const {
  return std::any_of(balls_.begin(), balls_.end(), [&](const Ball& ball) {
    const Vec3 arm = ball.centre_m - origin_m;
    const double square = dot(arm, arm), room = ball.radius_m * ball.radius_m, along = dot(arm, direction);
    return square <= room || (along > 0 && square - along * along <= room);
  });
}

// chance: the power, mean over bands, that was seen to leave towards the balls, with a floor.
CausticSources::Source CausticSources::prepare(std::size_t emitter) {
  Source& source = sources_[emitter];
  Random random(2, emitter);
  const auto two = [&] { return Vec2{random.uniform(), random.uniform()}; };
  if (emitters_[emitter]->infinite() || !emitters_[emitter]->emit({0.3, 0.4}, {0.6, 0.2}).valid) {
    const light::Sample sample = emitters_[emitter]->sample(all_.centre_m, {0.5, 0.5});
    source.distant = sample.valid && sample.delta && !std::isfinite(sample.distance_m);
    if (!source.distant && emitters_[emitter]->infinite()) return source;
  }
  const Vec3 a = emission(emitter, {0.1, 0.2}, {0.5, 0.5}).origin_m,
             b = emission(emitter, {0.7, 0.9}, {0.5, 0.5}).origin_m;
  source.point = !source.distant && a == b;
  source.positions = source.point ? 1 : source.distant ? 64 : 12;
  source.directions = source.point ? 128 : source.distant ? 1 : 24;
  const std::size_t n = static_cast<std::size_t>(source.positions), m = static_cast<std::size_t>(source.directions),
                    cells = n * n * m * m;
  double seen = 0, all = 0;
  source.cumulative.resize(cells);
  for (std::size_t cell = 0; cell < cells; ++cell) {
    double here = 0;
    for (int probe = 0; probe < probes; ++probe) {
      const Vec2 p = two(), d = two();
      const std::size_t i = cell % n, j = cell / n % n, k = cell / (n * n) % m, l = cell / (n * n * m);
      const light::Emission e = emission(
          emitter,
          {(static_cast<double>(i) + p.x) / source.positions, (static_cast<double>(j) + p.y) / source.positions},
          {(static_cast<double>(k) + d.x) / source.directions, (static_cast<double>(l) + d.y) / source.directions});
      if (!e.valid) continue;
      source.power += e.flux / static_cast<double>(cells * probes);
      all += mean(e.flux);
      if (hits_ball(e.origin_m, e.direction)) here += mean(e.flux);
    }
    seen += here;
    source.cumulative[cell] = here;
  }
  double sum = 0;
  for (double& cell : source.cumulative) {
    cell = sum +=
        (seen > 0 ? (1 - even_share) * cell / seen : 0) + (seen > 0 ? even_share : 1) / static_cast<double>(cells);
  }
  source.chance = (seen + 1e-3 * all) / static_cast<double>(cells * probes);
  return source;
}

Photon CausticSources::draw(Sampler& sampler) const {
  const Vec2 choice = sampler.two(), position = sampler.two(), direction = sampler.two();
  std::size_t emitter = 0;
  double left = choice.x;
  for (; emitter + 1 < sources_.size() && left >= sources_[emitter].chance; ++emitter) left -= sources_[emitter].chance;
  while (emitter > 0 && !(sources_[emitter].chance > 0)) --emitter;
  const Source& source = sources_[emitter];
  const auto& cumulative = source.cumulative;
  const auto found = std::upper_bound(cumulative.begin(), cumulative.end() - 1, choice.y * cumulative.back());
  const auto cell = static_cast<std::size_t>(found - cumulative.begin());
  const double chance = (cumulative[cell] - (cell > 0 ? cumulative[cell - 1] : 0)) / cumulative.back();
  const std::size_t n = static_cast<std::size_t>(source.positions), m = static_cast<std::size_t>(source.directions);
  const std::size_t i = cell % n, j = cell / n % n, k = cell / (n * n) % m, l = cell / (n * n * m);
  const light::Emission e = emission(emitter,
                                     {(static_cast<double>(i) + position.x) / source.positions,
                                      (static_cast<double>(j) + position.y) / source.positions},
                                     {(static_cast<double>(k) + direction.x) / source.directions,
                                      (static_cast<double>(l) + direction.y) / source.directions});
  if (!e.valid || !hits_ball(e.origin_m, e.direction))
    return {.emitter = emitter, .origin_m = {}, .direction = {}, .flux = {}};
  const double density = chance * static_cast<double>(cumulative.size()) * source.chance;
  return {emitter, e.origin_m, e.direction, e.flux / density, true};
}

}  // namespace gonio::render
