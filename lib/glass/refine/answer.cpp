// See answer.h.
#include "glass/refine/answer.h"

#include <algorithm>
#include <cmath>

#include "glass/implicit.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "render/session.h"

namespace gonio::glass {
namespace {

constexpr std::size_t most_faces = 60000;
// What a posterior of smooth bodies leaves out: edges that the prior rounds off, outlines that pixels cannot place.
// From the development seeds of tests/prove/prove_glass_refine.cpp.
constexpr double inflation = 1.5, least_sigma_rad = 0.05;

struct Normal {
  Vec3 direction;  // world
  double sigma_rad = 0;
};

// Of the body, with the scatter of what was drawn from the posterior.
Normal normal_of(const Refined& refined, const PixelRay& ray, const SurfacePatch& met) {
  const SplineField& field = refined.best().field;
  Normal normal{-normalized(met.jet.slope), 0};
  if (refined.draws.empty()) return normal;
  const auto slopes = normal_slopes(met, ray.origin, ray.direction);
  const SplineField::Support at = field.support(met.at);
  double sum = 0;
  for (const std::vector<double>& change : refined.draws) {
    const auto local = field.gather(at, change);
    for (std::size_t k = 0; k < 3; ++k) {
      double off = 0;
      for (std::size_t l = 0; l < 4; ++l) off += slopes[k][l] * local[l];
      sum += off * off;
    }
  }
  const double variance = inflation * inflation * sum / static_cast<double>(refined.draws.size());
  normal.sigma_rad = std::min(pi / 2, std::sqrt(variance + least_sigma_rad * least_sigma_rad));
  return normal;
}

void believe_network(const View& view, std::size_t pixel, bool front, Normal& normal) {
  if (!view.network) return;
  const Vec3 told = (front ? view.network->front : view.network->back)[pixel];
  const double sigma = (front ? view.network->front_sigma_rad : view.network->back_sigma_rad)[pixel];
  if (norm(told) < 0.5) return;
  const double angle = std::acos(std::clamp(dot(told, normal.direction), -1.0, 1.0));
  if (angle > contradiction * sigma) normal = {told, sigma};
}

void put(io::Image& maps, int x, int y, int channel, const Normal& normal) {
  for (int k = 0; k < 3; ++k) maps.at(x, y, channel + k) = static_cast<float>(normal.direction[k]);
  maps.at(x, y, channel + 3) = static_cast<float>(normal.sigma_rad);
}

double thickness(const Passage& line) {
  double sum = 0, from = 0;
  for (const Passage::Crossing& c : line.crossings) (c.enters ? from : sum) = c.enters ? c.t : sum + c.t - from;
  return sum;
}

}  // namespace

io::TriangleMesh mesh_of(const SplineField& field) {
  const auto [nx, ny, nz] = field.nodes();
  const Vec3 middle = field.metres({(nx - 1) / 2.0, (ny - 1) / 2.0, (nz - 1) / 2.0});
  const int cells = std::max({nx, ny, nz}) - 3;  // within the full cells
  const double half = cells * field.cell_m() / 2;
  const auto value = [&](Vec3 p) { return field.value(field.cells(p + middle)) * field.cell_m(); };
  io::TriangleMesh mesh = body_of(value, half, cells, most_faces, true);
  for (Vec3& p : mesh.positions_m) p += middle;
  return mesh;
}

io::Image maps_of(const Refined& refined, const Measuring& measuring, std::size_t number) {
  const View& view = measuring.view(number);
  const SplineField& field = refined.best().field;
  io::Image maps(view.width, view.height,
                 {"mask", "depth.Z", "normal.X", "normal.Y", "normal.Z", "uncertainty.normal", "back_normal.X",
                  "back_normal.Y", "back_normal.Z", "uncertainty.back_normal", "thickness"});
  const Mat3 camera_from_world = transposed(view.world_from_camera_axes);
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const PixelRay ray = measuring.ray(field, number, x, y);
      Measuring::Path path;
      if (!measuring.straight(field, ray, path)) continue;
      Normal front = normal_of(refined, ray, path.first);
      Normal back = normal_of(refined, ray, path.second);
      believe_network(view, view.pixel(x, y), true, front);
      believe_network(view, view.pixel(x, y), false, back);
      maps.at(x, y, 0) = 1;
      maps.at(x, y, 1) = static_cast<float>((camera_from_world * (path.first.at - ray.origin)).z * field.cell_m());
      put(maps, x, y, 2, front);
      put(maps, x, y, 6, back);
      maps.at(x, y, 10) = static_cast<float>(thickness(passage(field, ray.origin, ray.direction)) * field.cell_m());
    }
  return maps;
}

void enter_body(manifest::Document& document, const Stage& stage, double index_sigma, const std::string& id,
                const std::filesystem::path& mesh_file) {
  document.meshes[id].file = manifest::add_file(document, mesh_file, id);
  manifest::Surface& surface = document.surfaces[id];
  surface.model = "dielectric";
  surface.parameters["eta"] = stage.glass.index;
  surface.parameters["sigma_a_per_m"] = std::max(0.0, stage.glass.absorption / stage.field.cell_m());
  if (index_sigma > 0) surface.sigma["eta"] = {index_sigma};
  manifest::Object object{.id = id, .mesh = id, .surface = id, .world_from_object = {}};
  document.objects.push_back(std::move(object));
}

double difference_from(const View& view, const io::Image& rendered) {
  const auto planes = stokes_planes(rendered);
  double sum = 0, count = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<float> plane = reduced(planes[k], rendered.width, rendered.height, view.reduced);
    for (std::size_t i = 0; i < plane.size(); ++i) {
      if (view.outline_px[i] <= 0) continue;
      const double off = (plane[i] - view.stokes[k][i]) / view.screen->mean_luminance();
      sum += off * off, ++count;
    }
  }
  return std::sqrt(sum / std::max(count, 1.0));
}

io::Image rendered_with_stokes(const manifest::Document& document, std::size_t image, int spp, std::uint64_t seed,
                               const std::filesystem::path& checkpoint_beside) {
  render::SessionOptions options;
  options.transport.stokes = true;
  options.seed = seed, options.spp = spp, options.force = true;
  const render::Session session(document, options, [](const std::filesystem::path&) {});
  io::Image picture = session.render(image, checkpoint_beside).picture;
  render::Session::remove_checkpoint(checkpoint_beside);
  return picture;
}

}  // namespace gonio::glass
