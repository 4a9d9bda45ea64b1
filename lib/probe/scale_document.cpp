// See scale_document.h.
#include "probe/scale_document.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "camera/undistort_document.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/flat_patch.h"
#include "manifest/sections/image.h"

namespace gonio::probe {
namespace {

std::string tile_place(const manifest::Document& document, const std::string& name) {
  return manifest::place(document, "/goniometer/" + name);
}

Tile tile_of(const manifest::Document& document, const std::string& name) {
  const manifest::FlatPatch& entry = document.goniometer.at(name);
  const std::vector<double>& r = entry.reflectance;
  return {{entry, tile_place(document, name)},
          *entry.world_from_sample,
          r.size() == 3 ? Rgb{r[0], r[1], r[2]} : Rgb{r[0], r[0], r[0]},
          entry.relative_sigma.value_or(0),
          name};
}

// As the tile sees them.
std::vector<Lamp> lamps_at(Vec3 point_m, const std::vector<FoundLight>& lights) {
  std::vector<Lamp> lamps;
  for (const FoundLight& l : lights) {
    Lamp lamp{l.direction, l.irradiance, l.irradiance_sigma};
    if (l.position_m) {
      const Vec3 way = *l.position_m - point_m;
      const double nearer = l.distance_m * l.distance_m / dot(way, way);
      lamp = {normalized(way), l.irradiance * nearer, l.irradiance_sigma * nearer};
    }
    lamps.push_back(lamp);
  }
  return lamps;
}

// The balls in the reference, where they were found to stand.
Unwrapped in_reference(const LoadedView& read, const BallViews& all, UnwrapWish wish, const std::string& place) {
  std::vector<BallView> views;
  std::vector<Facing> faces;
  for (const FoundBall& ball : all.balls) {
    BallView view{.picture = read.picture, .counts = read.counts, .camera = *read.camera};
    view.counts.resize(read.picture.pixels(), 1);
    for (std::size_t i = 0; i < read.clipped.size(); ++i)
      if (read.clipped[i] != 0) view.counts[i] = 0;
    view.world_from_camera = read.outlines.world_from_camera;
    view.ball = ball.ball;
    for (const FoundBall& other : all.balls)
      if (&other != &ball) view.others.push_back(other.ball);
    const MirrorBall mirror = view.mirror();
    view.radius_px =
        read.camera->intrinsics().fx_px * std::tan(std::asin(ball.ball.radius_m / mirror.eye_distance_m()));
    faces.push_back(facing(view, wish));
    views.push_back(std::move(view));
  }
  if (std::ranges::all_of(faces, [](const Facing& f) { return std::ranges::count(f.used, 1) == 0; }))
    throw Error(Exit::data, place, "does not show the ball where it was found, or it is saturated",
                "name a photograph that shows it; or --tile for one that shows a white tile");
  wish.fill = false;
  return unwrapped(views, faces, wish);
}

}  // namespace

void check_scale(const manifest::Document& document, const ScaleWish& wish) {
  const manifest::ImageEntry& image = document.images[wish.image];
  manifest::picture_path(document, wish.image), manifest::mask_path(document, wish.image);
  camera::camera_of_picture(document, wish.image);
  if (!image.world_from_camera)
    throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(wish.image) + "/world_from_camera"),
                "missing: where the reference was taken from", "give it its pose");
  if (wish.tile.empty()) return;
  const std::string place = tile_place(document, wish.tile);
  if (!document.goniometer.contains(wish.tile))
    throw Error(Exit::data, place, "missing", "enter the tile: world_from_sample, polygon_m or radius_m, reflectance");
  const manifest::FlatPatch& tile = document.goniometer.at(wish.tile);
  if (tile.reflectance.empty())
    throw Error(Exit::data, place + "/reflectance", "missing", "a white tile states it, such as 0.99");
  if (!tile.world_from_sample)
    throw Error(Exit::data, place + "/world_from_sample", "missing", "say where the tile lies");
  tile_of(document, wish.tile);
}

Scale scale_of(const manifest::Document& document, const ProbeRequest& request, const BallViews& all,
               const std::vector<Facing>& faces, const std::vector<FoundLight>& lights, const Unwrapped& map) {
  const std::size_t image = request.scale->image;
  LoadedView read = read_view(document, image, request);
  const std::string place = manifest::picture_path(document, image).string();
  if (request.scale->tile.empty()) {
    UnwrapWish wish = request.unwrap;
    wish.fill = false;
    return scale_by_ball(lights.empty() ? map : unwrapped(all.views, faces, wish),
                         in_reference(read, all, request.unwrap, place), place);
  }
  const Tile tile = tile_of(document, request.scale->tile);
  const Vec2 middle = tile.patch.middle();
  return scale_by_tile(map, lamps_at(tile.world_from_tile * Vec3{middle.x, middle.y, 0}, lights), tile,
                       {std::move(read.picture), std::move(read.counts), std::move(read.clipped), *read.camera,
                        read.outlines.world_from_camera, place});
}

FoundLight scaled(FoundLight light, const Scale& scale) {
  const auto error = [&](double value, double sigma) { return std::hypot(sigma * scale.value, value * scale.sigma); };
  const Rgb v = light.irradiance, s = light.irradiance_sigma;
  light.irradiance_sigma = {error(v.x, s.x), error(v.y, s.y), error(v.z, s.z)};
  light.irradiance = v * scale.value;
  return light;
}

}  // namespace gonio::probe
