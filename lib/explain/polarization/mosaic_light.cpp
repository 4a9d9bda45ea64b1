// See mosaic_light.h.
#include "explain/polarization/mosaic_light.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.h"
#include "base/text.h"
#include "explain/images/traced.h"
#include "explain/polarization/coat.h"
#include "explain/polarization/mosaic_input.h"
#include "explain/polarization/screens.h"
#include "explain/traced/nodes.h"
#include "light/mechanisms/screen_leak.h"
#include "manifest/document.h"
#include "manifest/sections/surface.h"
#include "photograph/polarizers.h"
#include "relighting/repeats.h"
#include "render/camera_ray.h"
#include "render/mechanisms/sensor_crosstalk.h"
#include "render/mosaic.h"
#include "render/polarized_carrier.h"
#include "render/polarizer_reading.h"
#include "render/ray_caster.h"
#include "scene/model_choice.h"
#include "scene/scene.h"

namespace gonio::explain::polarization {
namespace {

constexpr std::uint64_t seed = 90;
constexpr std::size_t tiles_in_all = 100, most_looked_at = 4 * tiles_in_all;
constexpr double turn_rad = 0.2;  // between simulations of turned screens
constexpr double stated_paths = 2e6, other_paths = 5e5, first_paths = 1;
constexpr double dark = 0.02;                  // of the brightest
constexpr double least_share_of_sites = 0.03;  // of a surface that is asked for its roughness
constexpr std::size_t most_surfaces = 2;

// Rec. 709 luminance of triples.
std::vector<double> luminances(const std::vector<double>& rgb) {
  io::Image bands(static_cast<int>(rgb.size() / 3), 1, {"R", "G", "B"});
  for (std::size_t i = 0; i < rgb.size(); ++i) bands.data[i] = static_cast<float>(rgb[i]);
  const io::Image y = render::luminance(bands);
  return {y.data.begin(), y.data.end()};
}

// What light depends on beside the files and the seed, which is the same for all.
std::string key_of(const manifest::Document& document, const std::vector<images::TracedPixels>& pictures,
                   double paths) {
  std::string key = manifest::print_document(document, document.folder) + format("%.17g", paths);
  for (const images::TracedPixels& picture : pictures) {
    key += format(" image %zu", picture.entry);
    for (const auto& [x, y] : picture.at) key += format(" %d,%d", x, y);
  }
  return key;
}

TracedLight traced_light(const manifest::Document& document, std::vector<images::TracedPixels>& pictures, double paths,
                         KnownLight* known) {
  if (known != nullptr) {
    const std::string key = key_of(document, pictures, paths);
    if (const auto found = known->find(key); found != known->end()) return found->second;
    return (*known)[key] = traced_light(document, pictures, paths, nullptr);
  }
  images::trace_pixels(document, pictures, paths, seed, images::Caustics::traced, images::Light::polarized);
  TracedLight all;
  for (const images::TracedPixels& picture : pictures) {
    const std::vector<double> s0 = luminances(picture.radiance), others = luminances(picture.stokes);
    for (std::size_t k = 0; k < s0.size(); ++k) {
      all.light.push_back({s0[k], others[3 * k], others[3 * k + 1], others[3 * k + 2]});
      const double* v = &picture.variance[3 * k];
      all.variance.push_back(std::max({v[0], v[1], v[2]}));
    }
  }
  return all;
}

StokesVector minus(const StokesVector& a, const StokesVector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]};
}
void add(StokesVector& to, const StokesVector& what, double factor) {
  for (std::size_t k = 0; k < 4; ++k) to[k] += factor * what[k];
}

}  // namespace

MosaicLight::MosaicLight(const manifest::Document& stated, const std::vector<std::filesystem::path>& repeats,
                         const std::string& camera, KnownLight* known) {
  const manifest::Document document = images_of(stated, camera);
  setup_.camera = camera;
  recordings_ = relighting::read_recordings(document);
  relighting::measure_noise(repeats, document, recordings_);
  for (const std::string& name : polarized_lights(document))
    if (std::ranges::find(recordings_.lights, name) != recordings_.lights.end()) setup_.screens.push_back(name);
  draw_tiles(document, known);
  look(document);
  const Light light = trace(document, stated_paths, true, known);
  for (std::size_t i = 0; i < sites_.size(); ++i) sites_[i].stokes = light[i];
  trace_screens(document, known);
  trace_roughness(document, known);
}

// Whole tiles, all of whose pixels count; of dark ones nothing can be learnt.
void MosaicLight::draw_tiles(const manifest::Document& document, KnownLight* known) {
  std::vector<std::vector<Tile>> drawn(recordings_.images.size());
  const std::size_t looked_at = std::max<std::size_t>(4, most_looked_at / std::max<std::size_t>(1, drawn.size()));
  std::vector<images::TracedPixels> middles(drawn.size());
  for (std::size_t g = 0; g < drawn.size(); ++g) {
    const relighting::Recording& image = recordings_.images[g];
    const int width = image.picture.width, height = image.picture.height;
    for (int y = 0; y + side_px <= height; y += core_px)
      for (int x = 0; x + side_px <= width; x += core_px) {
        bool whole = true;
        for (int v = y; v < y + side_px; ++v)
          for (int u = x; u < x + side_px; ++u) whole = whole && image.counts[static_cast<std::size_t>(v * width + u)];
        if (whole) drawn[g].push_back({g, x, y});
      }
    Random random(seed, g);
    for (std::size_t k = drawn[g].size(); k > 1; --k)
      std::swap(drawn[g][k - 1], drawn[g][random.below(static_cast<std::uint32_t>(k))]);
    drawn[g].resize(std::min(drawn[g].size(), looked_at));
    middles[g].entry = image.entry;
    for (const Tile& tile : drawn[g]) middles[g].at.push_back({tile.x + side_px / 2, tile.y + side_px / 2});
  }
  const TracedLight light = traced_light(document, middles, first_paths, known);
  double brightest = 0;
  for (const StokesVector& s : light.light) brightest = std::max(brightest, s[0]);
  const std::size_t each = std::max<std::size_t>(2, tiles_in_all / std::max<std::size_t>(1, drawn.size()));
  std::size_t place = 0;
  for (const std::vector<Tile>& mine : drawn) {
    std::size_t taken = 0;
    for (const Tile& tile : mine)
      if (light.light[place++][0] > dark * brightest && taken < each) tiles_.push_back(tile), ++taken;
  }
}

// Where the pixels of the tiles are, and what they show first.
void MosaicLight::look(const manifest::Document& document) {
  const scene::Scene scene = scene::build_scene(document);
  const render::RayCaster caster(scene.instances);
  std::vector<std::size_t> seen(scene.appearance.surfaces.size()), of_site, mirror_of(seen.size(), no_mirror);
  for (const Tile& tile : tiles_) {
    const scene::View& view = scene.views[recordings_.images[tile.image].entry];
    const render::CameraRays rays(view);
    const Vec3 camera_x = matrix_of(view.world_from_camera.rotation) * Vec3{1, 0, 0};
    for (int y = tile.y; y < tile.y + side_px; ++y)
      for (int x = tile.x; x < tile.x + side_px; ++x) {
        Site site{.x = x, .y = y, .radius = render::radius_of(view.camera, x, y)};
        const render::WorldRay ray = rays.principal({static_cast<double>(x), static_cast<double>(y)});
        const auto met = caster.closest(ray.origin_m, ray.direction);
        site.incidence_rad = std::numeric_limits<double>::quiet_NaN();
        of_site.push_back(met ? met->surface : seen.size());
        if (met) {
          ++seen[met->surface];
          site.incidence_rad = std::acos(std::clamp(-dot(ray.direction, met->normal), 0.0, 1.0));
          const Vec3 across = cross(ray.direction, met->normal),
                     own = render::polarization_axis(camera_x, ray.direction);
          site.s_axis_rad = std::atan2(dot(across, cross(-ray.direction, own)), dot(across, own));
        }
        sites_.push_back(site);
      }
  }
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (static_cast<double>(seen[k]) < least_share_of_sites * static_cast<double>(sites_.size())) continue;
    ask_roughness(document, scene.appearance.surfaces[k]);
    ask_film(scene.appearance.surfaces[k], k, mirror_of);
  }
  for (std::size_t i = 0; i < sites_.size(); ++i)
    if (of_site[i] < seen.size()) sites_[i].mirror = mirror_of[of_site[i]];
}

void MosaicLight::ask_roughness(const manifest::Document& document, const scene::Surface& surface) {
  const manifest::ParameterInfo* alpha = scene::find_parameter(surface.model->info(), "alpha");
  const auto stated = document.surfaces.find(surface.id);
  if (alpha == nullptr || surface.varies() || stated == document.surfaces.end()) return;
  if (setup_.rough.size() == most_surfaces) return;
  const auto given = stated->second.parameters.find("alpha");
  const bool is_given = given != stated->second.parameters.end() && given->second.given();
  setup_.rough.push_back({surface.id, is_given ? given->second.scalar() : alpha->preset.value_or(0), alpha->upper});
}

// Metals that state an index, and no roughness.
void MosaicLight::ask_film(const scene::Surface& surface, std::size_t place, std::vector<std::size_t>& mirror_of) {
  constexpr double smooth = 1e-4;
  const auto rough = surface.parameters.find("alpha"), eta = surface.parameters.find("eta"),
             k = surface.parameters.find("k");
  if (surface.varies() || rough == surface.parameters.end() || !(rough->second.scalar() < smooth)) return;
  if (eta == surface.parameters.end() || k == surface.parameters.end()) return;
  mirror_of[place] = setup_.mirrors.size();
  setup_.mirrors.push_back({surface.id, {mean(eta->second.rgb()), mean(k->second.rgb())}});
}

MosaicLight::Light MosaicLight::trace(const manifest::Document& document, double paths, bool keep_variance,
                                      KnownLight* known) {
  std::vector<images::TracedPixels> pictures(recordings_.images.size());
  for (std::size_t g = 0; g < pictures.size(); ++g) pictures[g].entry = recordings_.images[g].entry;
  for (std::size_t t = 0; t < tiles_.size(); ++t)
    for (std::size_t k = 0; k < in_a_tile; ++k) pictures[tiles_[t].image].at.push_back({site(t, k).x, site(t, k).y});
  TracedLight all = traced_light(document, pictures, paths, known);
  if (keep_variance)
    for (std::size_t i = 0; i < sites_.size(); ++i) sites_[i].variance = all.variance[i];
  return std::move(all.light);
}

void MosaicLight::trace_screens(const manifest::Document& document, KnownLight* known) {
  if (setup_.screens.empty()) return;
  const auto changed = [&](double degree, double turn) {
    manifest::Document other = document;
    for (const std::string& name : setup_.screens) {
      set_screen(other, name, screen_degree_key, degree * screen_degree(document, name), 0);
      set_screen(other, name, screen_angle_key, screen_angle_rad(document, name) + turn, 0);
    }
    return trace(other, other_paths, false, known);
  };
  const Light stated = changed(1, 0), none = changed(0, 0), left = changed(1, turn_rad), right = changed(1, -turn_rad);
  const double bend = 1 - std::cos(2 * turn_rad), slope = 2 * std::sin(2 * turn_rad);
  for (std::size_t i = 0; i < sites_.size(); ++i) {
    unpolarized_.push_back(minus(none[i], stated[i]));
    StokesVector b = stated[i], c{};
    add(b, left[i], -0.5), add(b, right[i], -0.5);
    add(c, left[i], 1 / slope), add(c, right[i], -1 / slope);
    for (double& v : b) v /= bend;
    cosine_.push_back(b), sine_.push_back(c);
  }
}

void MosaicLight::trace_roughness(const manifest::Document& document, KnownLight* known) {
  if (setup_.rough.empty()) return;
  const Light stated = trace(document, other_paths, false, known);
  for (const RoughSurface& surface : setup_.rough) {
    Rough& rough = rough_.emplace_back();
    for (const double more : {0.0, 0.02, 0.05, 0.085, 0.13, 0.2, roughest}) {
      rough.nodes.push_back(more);
      std::vector<StokesVector>& change = rough.change.emplace_back(sites_.size());
      if (more == 0) continue;
      manifest::Document other = document;
      const double alpha = std::min(surface.upper, std::hypot(surface.alpha, more));
      other.surfaces.at(surface.name).parameters["alpha"].value = {alpha};
      const Light light = trace(other, other_paths, false, known);
      for (std::size_t i = 0; i < light.size(); ++i) change[i] = minus(light[i], stated[i]);
    }
  }
}

StokesVector MosaicLight::stokes(std::size_t site, const State& state) const {
  StokesVector s = sites_[site].stokes;
  if (!unpolarized_.empty() && (state.screen_leak != 0 || state.screen_turn_rad != 0)) {
    const double q = equation::screen_leak(1, state.screen_leak), t = 2 * state.screen_turn_rad;
    add(s, unpolarized_[site], 1 - q);
    add(s, cosine_[site], q * (std::cos(t) - 1)), add(s, sine_[site], q * std::sin(t));
  }
  for (std::size_t k = 0; k < rough_.size(); ++k) {
    if (!(state.rougher[k] > 0)) continue;
    std::array<double, 16> y{};
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t n = 0; n < rough_[k].nodes.size(); ++n) y[n] = rough_[k].change[n][site][c];
      s[c] += traced::between(rough_[k].nodes, std::span(y).first(rough_[k].nodes.size()), state.rougher[k]);
    }
  }
  const Site& here = sites_[site];
  if (here.mirror == no_mirror || state.film[here.mirror].thickness_m == 0) return s;
  return coated(s, std::cos(here.incidence_rad), here.s_axis_rad, setup_.mirrors[here.mirror].index,
                state.film[here.mirror]);
}

void MosaicLight::readings(std::size_t tile, const State& state, std::vector<double>& to) const {
  to.resize(in_a_tile);
  std::array<std::array<double, 4>, photograph::polarizer_count>
      row{};  // of each polarizer, the same for all its samples
  for (int k = 0; k < photograph::polarizer_count; ++k)
    row[static_cast<std::size_t>(k)] = photograph::analyser(state.array, k & 1, k >> 1, {});
  const std::size_t around = state.array.share == 0 ? 1 : 0;
  for (std::size_t y = around; y + around < side_px; ++y)
    for (std::size_t x = around; x + around < side_px; ++x) {
      const Site& here = site(tile, y * side_px + x);
      const StokesVector s = stokes(tile * in_a_tile + y * side_px + x, state);
      const std::size_t filter = polarizer_over(here.x, here.y);
      const std::array<double, 4> of = state.array.retardance_rad == 0
                                           ? row[filter]
                                           : photograph::analyser(state.array, here.x, here.y, here.radius);
      to[y * side_px + x] = of[0] * s[0] + of[1] * s[1] + of[2] * s[2] + of[3] * s[3];
    }
  if (state.array.share == 0) return;
  const std::vector<double> own = to;
  for (std::size_t y = 1; y + 1 < side_px; ++y)
    for (std::size_t x = 1; x + 1 < side_px; ++x) {
      const std::size_t k = y * side_px + x;
      const double sum = own[k] + own[k - 1] + own[k + 1] + own[k - side_px] + own[k + side_px];
      to[k] = equation::sensor_crosstalk(own[k], state.array.share, sum, 5);
    }
}

}  // namespace gonio::explain::polarization
