// See probe_document.h.
#include "probe/probe_document.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "camera/undistort_document.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/environment.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/table.h"
#include "probe/highlight_rows.h"
#include "probe/probe_views.h"
#include "probe/scale_document.h"

namespace gonio::probe {
namespace {

std::vector<double> list(Vec3 v) {
  return {v.x, v.y, v.z};
}
std::vector<double> deviations(const Mat3& covariance) {
  return {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), std::sqrt(covariance(2, 2))};
}
// Of a direction: root of the mean of its two tangential variances, rad.
double sigma_of(const Mat3& covariance) {
  return std::sqrt((covariance(0, 0) + covariance(1, 1) + covariance(2, 2)) / 2);
}

manifest::Light entry_of(const FoundLight& light) {
  manifest::Light entry;
  if (!light.position_m) {
    entry.model = "directional";
    entry.parameters["towards"] = list(light.direction);
    entry.parameters["watt_per_m2"] = list(light.irradiance);
    entry.sigma["towards"] = deviations(light.direction_covariance);
    entry.sigma["watt_per_m2"] = list(light.irradiance_sigma);
    return entry;
  }
  const double square = light.distance_m * light.distance_m;
  entry.model = "point";
  entry.parameters["position_m"] = list(*light.position_m);
  entry.parameters["watt_per_sr"] = list(light.irradiance * square);
  const double radius_m = light.distance_m * std::sin(light.half_angle_rad);
  if (radius_m > 0) entry.parameters["radius_m"] = radius_m;
  entry.sigma["position_m"] = deviations(light.position_covariance_m2);
  entry.sigma["watt_per_sr"] = list(light.irradiance_sigma * square);
  return entry;
}

std::string line(std::initializer_list<double> numbers) {
  std::string text;
  for (const double v : numbers) text += "," + (std::isfinite(v) ? shortest_text(v) : std::string());
  return text;
}

constexpr const char* light_header =
    "light,images,towards_x,towards_y,towards_z,sigma_rad,distance_m,x_m,y_m,z_m,sigma_x_m,sigma_y_m,sigma_z_m,"
    "irradiance_r,irradiance_g,irradiance_b,sigma_r,sigma_g,sigma_b,half_angle_rad,saturated,chi_square,degrees\n";

std::string row_of(const std::string& name, const FoundLight& l, const std::string& images) {
  const Vec3 nowhere{NAN, NAN, NAN}, at = l.position_m.value_or(nowhere);
  const Mat3 unknown{{NAN, 0, 0, 0, NAN, 0, 0, 0, NAN}};
  const std::vector<double> s = deviations(l.position_m ? l.position_covariance_m2 : unknown);
  return name + "," + images +
         line({l.direction.x,
               l.direction.y,
               l.direction.z,
               sigma_of(l.direction_covariance),
               l.distance_m,
               at.x,
               at.y,
               at.z,
               s[0],
               s[1],
               s[2],
               l.irradiance.x,
               l.irradiance.y,
               l.irradiance.z,
               l.irradiance_sigma.x,
               l.irradiance_sigma.y,
               l.irradiance_sigma.z,
               l.half_angle_rad,
               l.clipped ? 1.0 : 0.0,
               l.chi_square,
               static_cast<double>(l.degrees)}) +
         "\n";
}

std::string balls_csv(const manifest::Document& document, const BallViews& all) {
  std::string csv =
      "ball,image,x_m,y_m,z_m,sigma_x_m,sigma_y_m,sigma_z_m,radius_m,outline_x_px,outline_y_px,outline_radius_px,"
      "cover,rms_px,chi_square,degrees\n";
  for (std::size_t v = 0; v < all.views.size(); ++v) {
    const FoundBall& b = all.balls[all.ball_of_view[v]];
    const std::vector<double> s = deviations(b.covariance_m2);
    const reassembly::Outline& outline = all.outline_of_view[v];
    const Vec3 c = b.ball.centre_m;
    csv += std::to_string(all.ball_of_view[v] + 1) + "," + document.images[all.image_of_view[v]].id +
           line({c.x, c.y, c.z, s[0], s[1], s[2], b.ball.radius_m, outline.centre_px.x, outline.centre_px.y,
                 outline.radius_px, outline.cover, outline.rms_px, b.chi_square, static_cast<double>(b.degrees)}) +
           "\n";
  }
  return csv;
}

void say(const std::string& name, const FoundLight& l) {
  std::string text = name + ": towards " + format("%.4f %.4f %.4f", l.direction.x, l.direction.y, l.direction.z) +
                     format(" +- %.3g deg", sigma_of(l.direction_covariance) * 180 / pi);
  if (l.position_m) text += format(", %.4g m away", l.distance_m);
  log(LogLevel::info, text + format(", half angle %.3g deg", l.half_angle_rad * 180 / pi));
  if (l.clipped)
    log(LogLevel::warning, name + ": saturated; its intensity is a lower bound (develop --merge joins exposures)");
}

std::string images_of(const manifest::Document& document, const BallViews& all, const std::vector<Highlight>& spots,
                      const FoundLight& light) {
  std::string text;
  for (const std::size_t k : light.seen)
    text += (text.empty() ? "" : " ") + document.images[all.image_of_view[spots[k].view]].id;
  return text;
}

// Where the ball mirrors the middle of the lamp, and how well the picture alone says so; nothing where it is not to be
// seen.
struct Seen {
  Vec2 pixel, sigma;
  double cosine = 0;
};
std::optional<Seen> seen_at(const Highlight& h, const BallView& view) {
  const MirrorBall mirror = view.mirror();
  const auto pixel = [&](Vec3 direction) -> std::optional<Vec2> {
    const auto shown = mirror.shown(normalized(direction));
    if (!shown) return {};
    return view.camera.project(inverse(view.world_from_camera) * shown->point_m);
  };
  constexpr double step = 1e-5;
  const Basis f(h.direction);
  const auto middle = pixel(h.direction), t = pixel(h.direction + f.t * step), b = pixel(h.direction + f.b * step);
  if (!middle || !t || !b) return {};
  const Vec2 by_t = (*t - *middle) * (1 / step), by_b = (*b - *middle) * (1 / step);
  const double tt = dot(f.t, h.own_covariance * f.t), tb = dot(f.t, h.own_covariance * f.b),
               bb = dot(f.b, h.own_covariance * f.b);
  const auto sigma = [&](double a, double c) { return std::sqrt(a * a * tt + 2 * a * c * tb + c * c * bb); };
  return Seen{*middle, {sigma(by_t.x, by_b.x), sigma(by_t.y, by_b.y)}, mirror.shown(h.direction)->cosine};
}

HighlightRow highlight_row(const Highlight& h, const FoundLight& light, const Seen& seen, const FoundBall& ball,
                           const Metal& metal) {
  HighlightRow row;
  row.stated = ball.ball, row.covariance_m2 = ball.covariance_m2;
  row.seen_px = seen.pixel, row.sigma_px = seen.sigma;
  // From the ball's own directions to the balls' middle: bright_lights.h.
  const double q = std::max(0.0, light.nearness_per_m);
  const double nearer = (1 + h.focus_m.x * q) * (1 + h.focus_m.y * q),
               doubt = (h.focus_m.x + h.focus_m.y) * light.nearness_sigma_per_m;
  const Rgb reflectance = metal.reflectance(seen.cosine);
  const auto sigma = [&](double value, double own) { return std::hypot(own, value * doubt); };
  const Rgb e = h.irradiance, s = h.irradiance_sigma;
  row.reflected = e * reflectance * nearer;
  row.reflected_sigma = Rgb{sigma(e.x, s.x), sigma(e.y, s.y), sigma(e.z, s.z)} * reflectance * nearer;
  row.theta_i = std::acos(std::clamp(seen.cosine, 0.0, 1.0));
  row.clipped = h.clipped;
  return row;
}

// Highlights of lamps that two views or more show whole, as tables for explain.
void enter_highlights(manifest::Document& document, const ProbeRequest& request, const BallViews& all,
                      const std::vector<Highlight>& spots, const std::vector<FoundLight>& lights,
                      const std::vector<std::string>& names) {
  std::vector<HighlightRow> rows;
  for (std::size_t l = 0; l < lights.size(); ++l) {
    std::vector<std::size_t> whole;
    std::ranges::copy_if(lights[l].seen, std::back_inserter(whole), [&](std::size_t k) { return !spots[k].cut; });
    if (whole.size() < 2) continue;
    for (const std::size_t k : whole) {
      const std::size_t v = spots[k].view, b = all.ball_of_view[v];
      const auto at = seen_at(spots[k], all.views[v]);
      if (!at) continue;
      rows.push_back(highlight_row(spots[k], lights[l], *at, all.balls[b], request.unwrap.metal));
      rows.back().image = document.images[all.image_of_view[v]].id;
      rows.back().ball = std::to_string(b + 1), rows.back().lamp = names[l];
    }
  }
  const std::string group = highlight_group(rows), name = request.name + "-highlights";
  if (group.empty()) return;
  const auto path = request.output_path(name + ".csv");
  write_file(path, highlight_csv(rows));
  document.tables[name] = highlight_table(manifest::add_file(document, path, name), group);
  const Metal& metal = request.unwrap.metal;
  const std::string light = reflected_csv(rows, metal), reflected = request.name + "-reflected";
  if (light.empty()) return;
  const auto reflected_path = request.output_path(reflected + ".csv");
  write_file(reflected_path, light);
  document.tables[reflected] = reflected_table(manifest::add_file(document, reflected_path, reflected), metal);
}

struct Lamps {
  std::vector<Highlight> spots;
  std::vector<FoundLight> lights;
};
// Lights of these views; their highlights leave the faces.
Lamps taken_out(const ProbeRequest& request, const BallViews& all, std::vector<Facing>& faces) {
  Lamps lamps;
  for (std::size_t v = 0; v < all.views.size(); ++v) {
    auto here = highlights(all.views, faces, v, *request.lights);
    lamps.spots.insert(lamps.spots.end(), here.begin(), here.end());
  }
  const std::vector<FoundLight> found = lights_of(lamps.spots, all.middle_m, *request.lights);
  lamps.lights = agreed(found, lamps.spots, all.views, faces);
  take_out(lamps.lights, lamps.spots, faces);
  if (lamps.lights.size() < found.size())
    log(LogLevel::info, format("%zu bright regions stay in the picture, because not all views that show them have them "
                               "as one region",
                               found.size() - lamps.lights.size()));
  return lamps;
}

// Returns their names.
std::vector<std::string> enter_lights(manifest::Document& document, const ProbeRequest& request, const BallViews& all,
                                      const Lamps& lamps, const Scale& scale, const std::string& stem,
                                      std::string& csv) {
  std::vector<std::string> names;
  for (const FoundLight& found : lamps.lights) {
    const FoundLight light = scaled(found, scale);
    names.push_back(stem + "-" + std::to_string(names.size() + 1));
    document.lights[names.back()] = entry_of(light);
    csv += row_of(names.back(), light, images_of(document, all, lamps.spots, light));
    say(names.back(), light);
  }
  if (!request.each && !request.parallel) enter_highlights(document, request, all, lamps.spots, lamps.lights, names);
  return names;
}

// The photographs were taken under what was found in them, and under nothing else of the manifest: other lights beside
// it would be counted twice.
void light_images(manifest::Document& document, const ProbeRequest& request, const std::vector<std::string>& names) {
  for (const std::size_t index : request.images) document.images[index].light = names;
  if (request.scale) document.images[request.scale->image].light = names;
  if (document.lights.size() == names.size()) return;
  std::size_t all_on = 0;
  std::string first;
  for (const manifest::ImageEntry& image : document.images)
    if (image.light.empty() && !image.dark.value_or(false) && all_on++ == 0) first = image.id;
  if (all_on > 0)
    log(LogLevel::warning,
        format("image \"%s\"%s no light and has all of the manifest's on, what was found here and "
               "what stood there before; say in its `light` which",
               first.c_str(), all_on == 1 ? " names" : format(", one of %zu, names", all_on).c_str()));
}

std::vector<Facing> faces_of(const BallViews& all, const ProbeRequest& request, const std::string& place) {
  std::vector<Facing> faces;
  for (const BallView& view : all.views) {
    faces.push_back(facing(view, request.unwrap));
    if (std::ranges::none_of(faces.back().used, [](std::uint8_t u) { return u != 0; }))
      throw Error(Exit::data, place, "leaves no pixel of the ball",
                  "check the masks, and that the ball is larger than some pixels");
  }
  return faces;
}

void probe_each(manifest::Document& document, const ProbeRequest& request) {
  const auto lights_path = request.output_path(request.name + "-lights.csv"),
             balls_path = request.output_path(request.name + "-balls.csv");
  std::string lights = light_header, balls;
  Progress progress("light-probe", request.images.size());
  for (const std::size_t index : request.images) {
    const std::string id = document.images[index].id;
    const BallViews all = ball_views({load_view(document, index, request)}, request, id);
    std::vector<Facing> faces = faces_of(all, request, id);
    const Lamps lamps = taken_out(request, all, faces);
    const auto names = enter_lights(document, request, all, lamps, {}, request.name + "-" + id, lights);
    if (names.empty())
      log(LogLevel::warning, id + ": shows no light above " + shortest_text(request.lights->ratio) + " times the mean");
    document.images[index].light = names;
    const std::string rows = balls_csv(document, all);
    balls += balls.empty() ? rows : rows.substr(rows.find('\n') + 1);
    progress.advance();
  }
  write_file(lights_path, lights), write_file(balls_path, balls);
  manifest::add_file(document, lights_path, request.name + "-lights");
  manifest::add_file(document, balls_path, request.name + "-balls");
}

void probe_all(manifest::Document& document, const ProbeRequest& request) {
  const auto out = [&](const char* ending) { return request.output_path(request.name + ending); };
  const auto picture_path = out(".exr"), weight_path = out("-weight.exr"), balls_path = out("-balls.csv");
  const auto lights_path = request.lights ? out("-lights.csv") : std::filesystem::path();
  std::vector<LoadedView> loaded;
  for (const std::size_t index : request.images) loaded.push_back(load_view(document, index, request));
  const std::string place = document.name;
  const BallViews all = ball_views(loaded, request, place);
  loaded.clear();
  std::vector<Facing> faces = faces_of(all, request, place);
  std::string lights = light_header;
  const std::vector<Facing> whole = request.scale && request.lights ? faces : std::vector<Facing>{};
  const Lamps lamps = request.lights ? taken_out(request, all, faces) : Lamps{};
  const Unwrapped map = unwrapped(all.views, faces, request.unwrap);
  const Scale scale = request.scale ? scale_of(document, request, all, whole, lamps.lights, map) : Scale{};
  std::vector<std::string> names = enter_lights(document, request, all, lamps, scale, request.name, lights);
  names.insert(names.begin(), request.name);
  io::write_picture(picture_path, map.radiance);
  io::write_picture(weight_path, map.weight);
  write_file(balls_path, balls_csv(document, all));
  manifest::Environment& around = document.environments[request.name];
  around = {.file = manifest::add_file(document, picture_path, request.name), .blind_sr = map.blind_sr};
  if (request.scale) {
    around.scale = scale.value, around.sigma["scale"] = {scale.sigma};
    log(LogLevel::info, request.name + format(": scale %.5g +- %.2g, by image \"%s\"", scale.value, scale.sigma,
                                              document.images[request.scale->image].id.c_str()));
  }
  manifest::Light entry;
  entry.model = "lat-long";
  entry.environment = request.name;
  document.lights[request.name] = entry;
  manifest::add_file(document, weight_path, request.name + "-weight");
  manifest::add_file(document, balls_path, request.name + "-balls");
  if (request.lights) {
    write_file(lights_path, lights);
    manifest::add_file(document, lights_path, request.name + "-lights");
  }
  light_images(document, request, names);
  log(LogLevel::info, format("%zu views of %zu balls; %.3g sr of 12.6 are seen by none", all.views.size(),
                             all.balls.size(), map.blind_sr));
}

}  // namespace

void check_probe(const manifest::Document& document, const ProbeRequest& request) {
  if (request.images.empty())
    throw Error(Exit::data, manifest::place(document, "/images"), "has no image with a file",
                "name photographs of the ball");
  if (request.scale) check_scale(document, *request.scale);
  for (const std::size_t index : request.images) {
    manifest::picture_path(document, index), manifest::mask_path(document, index);
    if (request.parallel) continue;
    const std::string name = camera::camera_of_picture(document, index),
                      place = manifest::place(document, "/cameras/" + name);
    if (!document.cameras.contains(name)) throw Error(Exit::data, place, "missing", "calibrate it first");
    if (camera::CameraModel(document.cameras.at(name), place).orthographic())
      throw Error(Exit::data, place, "has no perspective", "say --orthographic");
  }
  if (request.images.size() > 1 && !request.each && !request.parallel)
    for (const std::size_t index : request.images)
      if (!document.images[index].world_from_camera)
        throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(index) + "/world_from_camera"),
                    "missing, and there are " + std::to_string(request.images.size()) + " views to be put together",
                    "give every view its pose, or use --each");
}

void probe_document(manifest::Document& document, const ProbeRequest& request) {
  check_probe(document, request);
  if (request.each)
    probe_each(document, request);
  else
    probe_all(document, request);
}

}  // namespace gonio::probe
