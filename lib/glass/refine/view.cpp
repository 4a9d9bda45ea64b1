// See view.h.
#include "glass/refine/view.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "geom/luminance.h"
#include "glass/net/seen.h"
#include "io/picture.h"
#include "light/aimed.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "scene/scene.h"

namespace gonio::glass {
namespace {

namespace fs = std::filesystem;
using Plane = std::vector<float>;

[[noreturn]] void refuse(const manifest::Document& document, std::size_t image, const std::string& what,
                         const std::string& remedy) {
  throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(image)), what, remedy);
}

Plane plane_of(const io::Image& picture, int channel) {
  Plane plane(picture.pixels());
  for (std::size_t i = 0; i < plane.size(); ++i)
    plane[i] = picture.data[i * picture.channels.size() + static_cast<std::size_t>(channel)];
  return plane;
}

std::array<Plane, 3> three(const Planes& planes) {
  std::array<Plane, 3> apart;
  for (std::size_t k = 0; k < apart.size() && !planes.values.empty(); ++k)
    apart[k].assign(planes.plane(k), planes.plane(k) + planes.pixels());
  return apart;
}

std::array<Plane, 3> stokes_of(const io::Image& picture, bool behind_polarizers, const manifest::Document& document,
                               std::size_t image) {
  const std::array<Plane, 3> stokes = stokes_planes(picture);
  if (!stokes[0].empty()) return stokes;
  if (!behind_polarizers || picture.channel("Y") < 0)
    refuse(document, image, "has neither Stokes planes s1, s2 nor a camera with \"mosaic\": \"polarizers\"",
           "photograph it with a polarization camera, or render it with --stokes");
  demand_mosaic(picture, manifest::place(document, "/images/" + std::to_string(image)));
  return three(stokes_of_mosaic(picture));
}

// The scene behind the document. One without objects has none that a renderer could build: it gets a speck.
scene::Scene scene_of(manifest::Document document, const ViewFiles& files) {
  if (document.objects.empty()) {
    document.meshes["speck"].sphere_radius_m = 1e-9;
    document.surfaces["speck"].model = "diffuse";
    document.objects.push_back({.id = "speck", .mesh = "speck", .surface = "speck", .world_from_object = {}});
  }
  return scene::build_scene(document, {.on_file = files.on_file});
}

void add_screen(View& view, const scene::Scene& scene, std::size_t number, const manifest::Document& document) {
  const scene::Light* found = nullptr;
  for (const std::size_t l : scene.views[number].lights)
    if (scene.appearance.lights[l].model->info().id == "screen") {
      if (found != nullptr) refuse(document, number, "is lit by several screens", "name one in its \"light\"");
      found = &scene.appearance.lights[l];
    }
  if (found == nullptr) refuse(document, number, "is lit by no screen", "name a light of model \"screen\"");
  const std::string place = manifest::place(document, "/lights/" + found->id);
  const auto values = manifest::values_of(found->model->info(), found->parameters, place);
  const auto value = [&](const std::string& name) {
    const auto& all = found->model->info().parameters;
    const auto at = std::ranges::find(all, name, &manifest::ParameterInfo::name);
    return values[static_cast<std::size_t>(at - all.begin())];
  };
  const light::Panel panel{value("position_m"), light::lamp_frame(value("direction"), value("up"), place),
                           value("width_m").x, value("height_m").x};
  const int columns = found->picture->width, rows = found->picture->height;
  const Rgb gain = scene.views[number].gain;
  std::vector<double> luminance;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const Vec3 at = panel.at(((x + 0.5) / columns - 0.5) * panel.width_m, (0.5 - (y + 0.5) / rows) * panel.height_m);
      const Rgb radiance = found->emitter->hit(at + panel.frame.n, -panel.frame.n).radiance * gain;
      luminance.push_back(luminance_of(radiance));
    }
  view.screen = std::make_shared<ScreenPicture>(panel, luminance, columns, rows, value("exponent").x);
  view.emitter = found->emitter;
}

std::vector<Vec3> vectors_of(const io::Image& picture, const std::string& layer, const fs::path& path) {
  std::array<int, 3> channel{picture.channel(layer + ".X"), picture.channel(layer + ".Y"),
                             picture.channel(layer + ".Z")};
  if (channel[0] < 0 || channel[1] < 0 || channel[2] < 0)
    throw Error(Exit::data, path.string(), "has no layer " + layer, "give what glass-net(1) writes");
  std::vector<Vec3> all(picture.pixels());
  const std::size_t step = picture.channels.size();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto part = [&](std::size_t k) {
      return double{picture.data[i * step + static_cast<std::size_t>(channel[k])]};
    };
    const Vec3 v{part(0), part(1), part(2)};
    const double length = norm(v);
    all[i] = length > 0.5 && is_finite(v) ? v / length : Vec3{};
  }
  return all;
}

Plane mask_of(const io::Image& network) {
  const int c = network.channel("mask");
  return c < 0 ? Plane{} : plane_of(network, c);
}

// Of a reduced view: the mean direction of a block's normals and the mean of its deviations.
void add_network(View& view, const io::Image& picture, const fs::path& path, const manifest::Document& document,
                 std::size_t image) {
  if (picture.width != view.camera.width_px() || picture.height != view.camera.height_px())
    refuse(document, image, "has another size than the network's answer " + path.string(), "predict it anew");
  NetworkAnswer answer;
  for (const bool front : {true, false}) {
    const std::string layer = front ? "normal" : "back_normal";
    const std::vector<Vec3> normals = vectors_of(picture, layer, path);
    const int c = picture.channel("uncertainty." + layer);
    const Plane sigma = c < 0 ? Plane(picture.pixels(), 0.5f) : plane_of(picture, c);
    std::vector<Vec3> sum(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
    for (int y = 0; y < view.height * view.reduced; ++y)
      for (int x = 0; x < view.width * view.reduced; ++x)
        sum[view.pixel(x / view.reduced, y / view.reduced)] += normals[static_cast<std::size_t>(y * picture.width + x)];
    for (Vec3& v : sum) v = norm(v) > 0.5 ? normalized(v) : Vec3{};
    (front ? answer.front : answer.back) = std::move(sum);
    (front ? answer.front_sigma_rad : answer.back_sigma_rad) =
        reduced(sigma, picture.width, picture.height, view.reduced);
  }
  view.network = std::move(answer);
}

Plane outline_mask(const manifest::Document& document, std::size_t image, const std::optional<io::Image>& network,
                   int width, int height) {
  const fs::path path = manifest::mask_path(document, image);
  Plane mask;
  if (!path.empty()) {
    const io::Image picture = io::read_picture(path);
    if (picture.width != width || picture.height != height)
      refuse(document, image, "has a mask of another size", "masks have the photograph's");
    mask = plane_of(picture, 0);
  } else if (network) {
    mask = mask_of(*network);
  }
  if (mask.empty()) refuse(document, image, "has no mask", "name one, or give the network's answers: --network");
  if (std::ranges::none_of(mask, [](float m) { return m > 0.5f; }))
    refuse(document, image, "has a mask that shows no object", "leave the image out");
  return mask;
}

View view_of(const manifest::Document& document, std::size_t image, const scene::Scene& scene, const ViewFiles& files) {
  const manifest::ImageEntry& entry = document.images[image];
  View view{.id = entry.id, .camera = scene.views[image].camera};
  view.world_from_camera = scene.views[image].world_from_camera;
  view.world_from_camera_axes = matrix_of(view.world_from_camera.rotation);
  if (view.camera.orthographic()) refuse(document, image, "is orthographic", "give the camera's centre");
  const auto read = [&](const fs::path& path) {
    if (files.on_file) files.on_file(path);
    return io::read_picture(path);
  };
  const io::Image picture = read(manifest::picture_path(document, image));
  const int width = picture.width, height = picture.height;
  if (width != view.camera.width_px() || height != view.camera.height_px())
    refuse(document, image, "has another size than its camera", "calibrate at this size");
  view.reduced = (std::max(width, height) + files.most_px - 1) / files.most_px;
  view.width = width / view.reduced, view.height = height / view.reduced;
  view.focal_px = view.camera.intrinsics().fx_px / view.reduced;
  const bool mosaic = document.cameras.at(entry.camera).mosaic == "polarizers";
  const auto stokes = stokes_of(picture, mosaic, document, image);
  for (std::size_t k = 0; k < 3; ++k) view.stokes[k] = reduced(stokes[k], width, height, view.reduced);
  add_screen(view, scene, image, document);
  const double bright = view.screen->mean_luminance();
  view.noise = entry.noise ? std::sqrt(bright / entry.noise->gain + entry.noise->read * entry.noise->read) : 0;
  std::optional<io::Image> network;
  if (files.network && fs::exists(*files.network / (entry.id + ".exr")))
    network = read(*files.network / (entry.id + ".exr"));
  const fs::path mask_path = manifest::mask_path(document, image);
  if (files.on_file && !mask_path.empty()) files.on_file(mask_path);
  const Plane mask = outline_mask(document, image, network, width, height);
  view.outline_px = distance_from_edge(reduced(mask, width, height, view.reduced), view.width, view.height);
  if (network) add_network(view, *network, *files.network / (entry.id + ".exr"), document, image);
  return view;
}

}  // namespace

std::vector<float> reduced(const std::vector<float>& plane, int width, int height, int factor) {
  const int w = width / factor, h = height / factor;
  std::vector<float> small(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
  for (int y = 0; y < h * factor; ++y)
    for (int x = 0; x < w * factor; ++x)
      small[static_cast<std::size_t>(y / factor * w + x / factor)] +=
          plane[static_cast<std::size_t>(y * width + x)] / static_cast<float>(factor * factor);
  return small;
}

std::array<std::vector<float>, 3> stokes_planes(const io::Image& picture) {
  return three(stokes_of_picture(picture));
}

Vec3 View::direction(double x, double y) const {
  const double shift = (reduced - 1) / 2.0;
  return world_from_camera_axes * camera.ray({x * reduced + shift, y * reduced + shift}).direction;
}

std::optional<Vec2> View::project(Vec3 point_m) const {
  const auto pixel = camera.project(transposed(world_from_camera_axes) * (point_m - eye_m()));
  if (!pixel) return {};
  const double shift = (reduced - 1) / 2.0;
  return Vec2{(pixel->x - shift) / reduced, (pixel->y - shift) / reduced};
}

double View::outline_at(Vec2 place) const {
  const Vec2 in{std::clamp(place.x, 0.0, width - 1.0), std::clamp(place.y, 0.0, height - 1.0)};
  const int i = std::min(static_cast<int>(in.x), width - 2), j = std::min(static_cast<int>(in.y), height - 2);
  const double s = in.x - i, t = in.y - j;
  const auto at = [&](int x, int y) { return double{outline_px[pixel(x, y)]}; };
  return (1 - t) * ((1 - s) * at(i, j) + s * at(i + 1, j)) + t * ((1 - s) * at(i, j + 1) + s * at(i + 1, j + 1)) -
         norm(place - in);
}

std::vector<float> distance_from_edge(const std::vector<float>& mask, int width, int height) {
  const auto at = [&](int x, int y) { return mask[static_cast<std::size_t>(y * width + x)] - 0.5; };
  std::vector<Vec2> edge;  // where the mask passes one half between neighbours
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double here = at(x, y);
      if (x + 1 < width && (here > 0) != (at(x + 1, y) > 0))
        edge.push_back({x + here / (here - at(x + 1, y)), 1.0 * y});
      if (y + 1 < height && (here > 0) != (at(x, y + 1) > 0))
        edge.push_back({1.0 * x, y + here / (here - at(x, y + 1))});
    }
  std::vector<float> distance(mask.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double least = static_cast<double>(width) * width + static_cast<double>(height) * height;
      for (const Vec2& p : edge) least = std::min(least, (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y));
      distance[static_cast<std::size_t>(y * width + x)] =
          static_cast<float>((at(x, y) > 0 ? 1 : -1) * std::sqrt(least));
    }
  return distance;
}

std::vector<View> views_in(const manifest::Document& document, const ViewFiles& files) {
  const scene::Scene scene = scene_of(document, files);
  const auto others = std::make_shared<render::RayCaster>(scene.instances);
  std::vector<View> views;
  for (std::size_t image = 0; image < document.images.size(); ++image) {
    views.push_back(view_of(document, image, scene, files));
    views.back().others = others;
  }
  if (views.size() < 3)
    throw Error(Exit::data, manifest::place(document, "/images"), "are fewer than 3 views",
                "a shape needs views from all round");
  return views;
}

}  // namespace gonio::glass
