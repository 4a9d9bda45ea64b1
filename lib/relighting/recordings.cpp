// Reading of recordings. Where the manifest states no noise, and the file no variance, it is measured: the median
// absolute value of the horizontal second difference (1, -2, 1), whose variance is six times that of a pixel, scaled to
// a standard deviation by 1 / 0.6745 (Rousseeuw & Croux 1993). Smooth shading cancels in it, and edges are too few to
// move a median. Behind a mosaic the three stand behind the same filter.
#include "relighting/recordings.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

#include "base/error.h"
#include "camera/intrinsics.h"
#include "camera/mosaic.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/object.h"
#include "photograph/linear_picture.h"
#include "photograph/mask.h"
#include "photograph/noise_variance.h"
#include "scene/mechanisms.h"
#include "stats/intervals.h"

namespace gonio::relighting {
namespace {

[[noreturn]] void refuse(const manifest::Document& document, std::size_t entry, const std::string& key,
                         const std::string& problem, const std::string& remedy) {
  throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(entry) + key), problem, remedy);
}

bool is_variance(float v) {
  return v > 0 && std::isfinite(v);
}

void read_pixels(const manifest::Document& document, const std::filesystem::path& path, Recording& image) {
  const manifest::ImageEntry& entry = document.images[image.entry];
  const std::string place = manifest::place(document, "/images/" + std::to_string(image.entry) + "/response");
  const photograph::LinearPicture read = photograph::read_linear(path, entry.response, place, entry.saturation);
  const io::Image& colour = read.colour;
  const std::size_t channels = colour.channels.size();
  image.picture = io::Image(colour.width, colour.height, {"R", "G", "B"});
  image.grey = channels == 1;
  image.counts.assign(colour.pixels(), 1);
  for (std::size_t i = 0; i < colour.pixels(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = colour.data[i * channels + (channels == 3 ? c : 0)];
      image.picture.data[3 * i + c] = value;
      if (!std::isfinite(value) || read.clipped[i]) image.counts[i] = 0;
    }
  const io::Image& variance = read.variance;
  if (entry.noise || variance.channels.size() != channels || std::ranges::none_of(variance.data, is_variance)) return;
  image.variance.resize(image.picture.data.size());
  for (std::size_t i = 0; i < colour.pixels(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = variance.data[i * channels + (channels == 3 ? c : 0)];
      image.variance[3 * i + c] = value;
      if (!is_variance(value)) image.counts[i] = 0;
    }
}

Rgb mean_of_finite(const io::Image& picture) {
  Rgb sum;
  double n = 0;
  for (std::size_t i = 0; i + 2 < picture.data.size(); i += 3) {
    const Rgb value{picture.data[i], picture.data[i + 1], picture.data[i + 2]};
    if (!std::isfinite(value.x + value.y + value.z)) continue;
    sum += value;
    n += 1;
  }
  return n > 0 ? sum / n : sum;
}

void leave_out_masked(const manifest::Document& document, Recording& image) {
  const std::filesystem::path path = manifest::mask_path(document, image.entry);
  if (path.empty()) return;
  const std::vector<std::uint8_t> counts = photograph::read_mask_of(
      image.picture, path, manifest::place(document, "/images/" + std::to_string(image.entry) + "/mask"));
  for (std::size_t i = 0; i < image.counts.size(); ++i) image.counts[i] = image.counts[i] && counts[i];
}

// Of the whole picture: where single places are not asked.
manifest::Noise usual_noise(const Recording& image) {
  std::vector<double> counted;
  for (std::size_t i = 0; i < image.variance.size(); ++i)
    if (image.counts[i / 3]) counted.push_back(image.variance[i]);
  return {.gain = 0, .read = counted.empty() ? 1e-6 : std::sqrt(stats::median(counted))};
}

// `step`: pixels to the next behind the same filter.
manifest::Noise measured_noise(const Recording& image, int step) {
  std::vector<double> differences;
  const io::Image& p = image.picture;
  for (int y = 0; y < p.height; ++y)
    for (int x = step; x + step < p.width; ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(p.width) + static_cast<std::size_t>(x);
      const auto far = static_cast<std::size_t>(step);
      if (!image.counts[i - far] || !image.counts[i] || !image.counts[i + far]) continue;
      for (int c = 0; c < 3; ++c)
        differences.push_back(std::abs(double{p.at(x - step, y, c)} - 2.0 * p.at(x, y, c) + p.at(x + step, y, c)));
    }
  const double sigma = differences.empty() ? 0 : stats::median(differences) / 0.6745 / std::sqrt(6.0);
  return {.gain = 0, .read = std::max(sigma, 1e-6)};
}

// The view that `entry` was taken from, entered where it is new. What the manifest's mechanisms say of where things are
// seen has acted on it.
std::size_t view_of(const manifest::Document& document, const manifest::ImageEntry& entry, Recordings& recordings) {
  manifest::Camera camera = *find_camera(document, entry.camera);
  const std::string place = manifest::place(document, "/cameras/" + entry.camera);
  const auto acting = [&](const auto& act) {
    for (const auto& [id, use] : document.mechanisms)
      if (const mechanism::Mechanism* m = mechanism::find_mechanism(id); m != nullptr && scene::moves_pixels(*m))
        act(*m, use, manifest::place(document, "/mechanisms/" + id));
  };
  acting([&](const auto& m, const auto& use, const std::string& at) {
    scene::apply_mechanism(camera, entry.camera, m, use, at);
  });
  scene::View seen{.image = entry.id, .camera = camera::CameraModel(camera, place), .camera_name = entry.camera};
  if (entry.world_from_camera)
    seen.world_from_camera = {entry.world_from_camera->rotation, entry.world_from_camera->translation_m};
  acting([&](const auto& m, const auto& use, const std::string& at) { scene::apply_mechanism(seen, m, use, at); });
  const View view{entry.camera, seen.camera, seen.world_from_camera};
  for (std::size_t v = 0; v < recordings.views.size(); ++v)
    if (recordings.views[v] == view) return v;
  recordings.views.push_back(view);
  return recordings.views.size() - 1;
}

// Is the light on in this image? One that names none has all of them.
bool is_lit(const manifest::ImageEntry& entry, const std::string& light) {
  return (entry.light.empty() && !entry.dark.value_or(false)) ||
         std::ranges::find(entry.light, light) != entry.light.end();
}

bool counts(const manifest::ImageEntry& entry) {
  return !entry.weight || *entry.weight != 0;
}

}  // namespace

bool has_recordings(const manifest::Document& document) {
  return !document.objects.empty() &&
         std::any_of(document.images.begin(), document.images.end(),
                     [](const manifest::ImageEntry& e) { return !e.file.empty() && !e.camera.empty(); });
}

std::vector<std::string> lights_of_recordings(const manifest::Document& document) {
  std::vector<std::string> names;
  for (const auto& [name, light] : document.lights)
    if (std::ranges::any_of(document.images, [&](const auto& entry) { return counts(entry) && is_lit(entry, name); }))
      names.push_back(name);
  return names;
}

Recordings read_recordings(const manifest::Document& document) {
  Recordings recordings;
  bool timed = false;
  recordings.lights = lights_of_recordings(document);
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const manifest::ImageEntry& entry = document.images[i];
    if (!counts(entry)) continue;
    if (!has_entry(document, "cameras", entry.camera))
      refuse(document, i, "/camera", "names no camera: \"" + entry.camera + "\"", "enter it in cameras");
    Recording image;
    image.id = entry.id;
    image.entry = i;
    image.view = view_of(document, entry, recordings);
    for (std::size_t l = 0; l < recordings.lights.size(); ++l)
      if (is_lit(entry, recordings.lights[l])) image.lights.push_back(l);
    read_pixels(document, manifest::picture_path(document, i), image);
    const camera::CameraModel& camera = recordings.views[image.view].model;
    if (image.picture.width != camera.width_px() || image.picture.height != camera.height_px())
      refuse(document, i, "/file",
             "is " + std::to_string(image.picture.width) + "x" + std::to_string(image.picture.height) +
                 " pixels, the camera " + std::to_string(camera.width_px()) + "x" + std::to_string(camera.height_px()),
             "give the camera the size of its pictures");
    image.mean = mean_of_finite(image.picture);
    leave_out_masked(document, image);
    const int step = camera::filter_pitch(camera::mosaic_of(document, entry.camera),
                                          manifest::place(document, "/cameras/" + entry.camera + "/mosaic"));
    image.noise = entry.noise              ? *entry.noise
                  : image.variance.empty() ? measured_noise(image, step)
                                           : usual_noise(image);
    image.gain = entry.gain ? *entry.gain : manifest::Parameter(1.0);
    image.exposure_s = entry.exposure_s;
    image.time_s = entry.time_s;
    image.temperature_K = entry.temperature_K;
    if (image.time_s)
      recordings.first_time_s = timed ? std::min(recordings.first_time_s, *image.time_s) : *image.time_s;
    if (image.time_s) recordings.last_time_s = timed ? std::max(recordings.last_time_s, *image.time_s) : *image.time_s;
    timed = timed || image.time_s;
    recordings.images.push_back(std::move(image));
  }
  return recordings;
}

io::Image read_take(const manifest::Document& document, const Recording& image, const std::filesystem::path& path) {
  Recording take;
  take.entry = image.entry;
  read_pixels(document, path, take);
  return take.picture;
}

double noise_sigma(const Recording& image, double value) {
  return std::sqrt(photograph::noise_variance(image.noise, value));
}

double noise_sigma(const Recording& image, double value, std::size_t place) {
  return image.variance.empty() ? noise_sigma(image, value) : std::sqrt(double{image.variance[place]});
}

Rgb local_mean(const Recording& image, int x, int y) {
  Rgb sum;
  double n = 0;
  for (int v = std::max(0, y - 2); v <= std::min(image.picture.height - 1, y + 2); ++v)
    for (int u = std::max(0, x - 2); u <= std::min(image.picture.width - 1, x + 2); ++u) {
      if (!image.counts[static_cast<std::size_t>(v) * static_cast<std::size_t>(image.picture.width) +
                        static_cast<std::size_t>(u)])
        continue;
      sum += Rgb{image.picture.at(u, v, 0), image.picture.at(u, v, 1), image.picture.at(u, v, 2)};
      n += 1;
    }
  return n > 0 ? sum / n : sum;
}

}  // namespace gonio::relighting
