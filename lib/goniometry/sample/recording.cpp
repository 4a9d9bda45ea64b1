// Goniometer recordings become samples (goniometry/sample/recording.h): pictures are read side by side, then the tile's
// readings give each light's scale, then the sample's become rows.
#include "goniometry/sample/recording.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "base/error.h"
#include "base/parallel.h"
#include "goniometry/sample/recording_setup.h"
#include "goniometry/sample/tile.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"
#include "render/mechanisms/sensor_black_offset.h"
#include "render/mechanisms/sensor_saturation.h"
#include "render/sensor_chain.h"
#include "scene/mechanisms/optics_vignetting.h"
#include "stats/intervals.h"

namespace gonio::goniometry {
namespace {

constexpr double brightest_tile = 1e3;  // a tile this much brighter than the sample is none, or the exposures differ
constexpr double least_tile_sigmas = 3;

std::string number(double v) {
  std::ostringstream text;
  text.precision(3);
  text << v;
  return text.str();
}

struct PictureReading {
  std::optional<PatchReading> sample, tile;
  std::size_t channels = 0;
};

void check_size(const io::Image& image, int width, int height, const std::string& what, const std::string& place) {
  if (image.width == width && image.height == height) return;
  const auto size = [](int w, int h) { return std::to_string(w) + " x " + std::to_string(h); };
  throw Error(Exit::data, place,
              what + " has " + size(image.width, image.height) + " pixels, its camera " + size(width, height),
              "give the camera of this size, or the picture as it was taken");
}

std::string left_out(const manifest::ImageEntry& image, const scene::View& seen) {
  if (image.weight == 0.0) return "its weight is 0";
  if (seen.lights.empty()) return "no light is on";
  return seen.lights.size() == 1 ? "" : "lit by " + std::to_string(seen.lights.size()) + " lights at once";
}

PictureReading read_picture(const Recording& recording, std::size_t number_of_view, const ReduceOptions& options) {
  const scene::View& seen = recording.scene.views[number_of_view];
  const manifest::ImageEntry& image = recording.image(number_of_view);
  const std::string place = recording.place(number_of_view);
  const std::size_t listed = recording.images[number_of_view];
  PictureReading result;
  const bool sample = recording.sample->in[number_of_view], tile = recording.tile && recording.tile->in[number_of_view];
  if (const std::string reason = left_out(image, seen); !reason.empty()) {
    PatchReading refused;
    refused.refusal = reason;
    if (sample) result.sample = refused;
    if (tile) result.tile = refused;
    return result;
  }
  const photograph::LinearPicture picture = photograph::read_linear(manifest::picture_path(*recording.document, listed),
                                                                    image.response, place, image.saturation);
  check_size(picture.colour, seen.camera.width_px(), seen.camera.height_px(), "the picture", place);
  result.channels = picture.colour.channels.size();
  std::optional<photograph::Mask> mask;
  if (const auto path = manifest::mask_path(*recording.document, listed); !path.empty()) {
    mask = photograph::read_mask(path);
    check_size(io::Image(mask->width, mask->height, {}), seen.camera.width_px(), seen.camera.height_px(), "the mask",
               place);
  }
  const render::Sensor sensor = render::sensor_of(*recording.document, listed);
  PictureView view{.picture = &picture,
                   .mask = mask ? &*mask : nullptr,
                   .noise = image.noise,
                   .gain = seen.gain,
                   .falloff = recording.scene.appearance.vignetting_falloff,
                   .black = sensor.amount(mechanism::sensor_black_offset(), "offset"),
                   .full_scale = options.full_scale > 0 ? options.full_scale
                                                        : sensor.amount(mechanism::sensor_saturation(), "full_scale"),
                   .camera = &seen.camera,
                   .world_from_camera = seen.world_from_camera,
                   .world_from_patch = {},
                   .light = recording.scene.appearance.lights[seen.lights.front()].emitter.get()};
  const auto read = [&](const Shown& patch, const Reflector* reflector) {
    view.world_from_patch = *patch.entry.world_from_sample;
    view.gain = patch.entry.values == "exposure" ? seen.gain * *image.exposure_s : seen.gain;
    return read_patch(patch.patch, view, reflector, {options.max_theta_rad, options.min_pixels});
  };
  if (sample) result.sample = read(*recording.sample, nullptr);
  if (tile) result.tile = read(*recording.tile, &*recording.reflector);
  return result;
}

// Something stands before the patch: more cells leave the course than do in the median picture. Glints of the sample
// itself are then no reason.
void refuse_hidden(std::vector<PictureReading>& pictures, std::optional<PatchReading> PictureReading::*which) {
  std::vector<int> counts;
  for (const PictureReading& picture : pictures)
    if (const auto& reading = picture.*which; reading && reading->refusal.empty()) counts.push_back(reading->outlying);
  if (counts.empty()) return;
  std::ranges::nth_element(counts, counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2));
  const int usual = counts[counts.size() / 2];
  for (PictureReading& picture : pictures) {
    auto& reading = picture.*which;
    if (!reading || !reading->refusal.empty()) continue;
    if (reading->outlying <= std::max(1, reading->cells / 25) + 2 * usual) continue;
    reading->refusal = "something is in front of the patch or shades it: " + std::to_string(reading->outlying) +
                       " of " + std::to_string(reading->cells) + " parts leave the others' course, by up to " +
                       number(100 * std::abs(reading->farthest)) + " %";
  }
}

class Reduction {
 public:
  Reduction(const Recording& recording, const ReduceOptions& options) : recording_(recording) {
    pictures_.resize(recording.images.size());
    parallel_for(0, pictures_.size(), [&](std::size_t i) { pictures_[i] = read_picture(recording, i, options); });
    count_bands();
    refuse_hidden(pictures_, &PictureReading::sample);
    refuse_hidden(pictures_, &PictureReading::tile);
  }

  Reduced reduce() {
    result_.samples.name = recording_.sample->name;
    const Scales scales(tile_readings());
    for (std::size_t i = 0; i < pictures_.size(); ++i)
      if (pictures_[i].sample) add(i, *pictures_[i].sample, scales);
    if (result_.samples.rows() == 0) refuse_all();
    if (recording_.tile) check_brightness();
    result_.scale_sigma.assign(bands(), common_sigma_);
    note_all(scales);
    return std::move(result_);
  }

 private:
  std::size_t bands() const { return result_.samples.bands(); }
  std::size_t light_of(std::size_t view) const { return recording_.scene.views[view].lights.front(); }

  void count_bands() {
    std::size_t channels = 0, first = 0;
    for (std::size_t i = 0; i < pictures_.size(); ++i) {
      if (pictures_[i].channels == 0) continue;
      if (channels == 0) channels = pictures_[i].channels, first = i;
      if (pictures_[i].channels != channels)
        throw Error(Exit::data, recording_.place(i),
                    "the picture has " + std::to_string(pictures_[i].channels) + " channels, " +
                        recording_.place(first) + " has " + std::to_string(channels),
                    "record all in the same bands");
    }
    result_.samples.band_name = channels == 1 ? std::vector<std::string>{"y"} : std::vector<std::string>{"r", "g", "b"};
  }

  // What hinders the tile in a picture is kept: it is the reason why a sample there may have no scale.
  std::vector<TileReading> tile_readings() {
    std::vector<TileReading> readings;
    tile_refusal_.resize(pictures_.size());
    for (std::size_t i = 0; i < pictures_.size(); ++i) {
      if (!pictures_[i].tile) continue;
      const PatchReading& tile = *pictures_[i].tile;
      tile_refusal_[i] = tile.refusal;
      for (int b = 0; b < 3 && tile_refusal_[i].empty(); ++b)
        if (!(tile.ratio[b] > 0) || tile.ratio[b] < least_tile_sigmas * tile.sigma[b])
          tile_refusal_[i] = "it is dark: its radiance is " + number(tile.ratio[b] / tile.sigma[b]) +
                             " of its standard deviations (limit " + number(least_tile_sigmas) + ")";
      if (tile_refusal_[i].empty())
        readings.push_back({i, light_of(i), recording_.image(i).time_s, tile.ratio, tile.sigma});
    }
    return readings;
  }

  void drop(std::size_t view, const std::string& reason) {
    result_.dropped.push_back({"images/" + std::to_string(recording_.images[view]), reason});
  }

  std::string no_scale(std::size_t view) const {
    std::string reason = "no picture shows the white tile under this light";
    for (std::size_t i = 0; i < pictures_.size(); ++i)
      if (!tile_refusal_[i].empty() &&
          (i == view || recording_.scene.views[i].lights == recording_.scene.views[view].lights)) {
        reason = "the white tile cannot be read: " + tile_refusal_[i];
        if (i == view) break;
      }
    return reason;
  }

  void add(std::size_t view, const PatchReading& reading, const Scales& scales) {
    if (!reading.refusal.empty()) return drop(view, reading.refusal);
    if (std::isnan(reading.sigma.x)) return drop(view, "too few pixels to judge their scatter, and no noise is stated");
    const std::size_t light = light_of(view);
    TileScale scale;
    if (recording_.tile) {
      const auto found = scales.at(view, light, recording_.image(view).time_s);
      if (!found) return drop(view, no_scale(view));
      scale = *found;
    }
    Samples& samples = result_.samples;
    const double tile = recording_.tile ? recording_.tile->entry.relative_sigma.value_or(0) : 0;
    for (std::size_t b = 0; b < bands(); ++b) {
      const int band = static_cast<int>(b);
      const double f = reading.ratio[band] / scale.value[band];
      const double own = reading.sigma[band] / scale.value[band], of_scale = scale.sigma[band] / scale.value[band];
      const double common = recording_.tile ? tile : recording_.light_sigma[light][band];
      common_sigma_ = std::max(common_sigma_, common);
      samples.f.push_back(f);
      samples.sigma.push_back(std::sqrt(own * own + f * f * (of_scale * of_scale + common * common)));
    }
    samples.wi.push_back(reading.wi);
    samples.wo.push_back(reading.wo);
    samples.series.push_back(series_.try_emplace(light, series_.size()).first->second);
    samples.place.push_back("images/" + std::to_string(recording_.images[view]));
    result_.readings.push_back({recording_.images[view], recording_.scene.appearance.lights[light].id,
                                scale.views.size() == 1 ? recording_.image(scale.views[0]).id : "",
                                reading.spread_i_rad, reading.spread_o_rad, reading.pixels, reading.scatter});
    if (scale.views.size() == 1 && scale.views[0] == view) ++with_own_tile_;
  }

  // "34 of 40: saturated; ..." of reasons up to their first colon.
  [[noreturn]] void refuse_all() const {
    std::map<std::string, std::size_t> kinds;
    for (const Dropped& d : result_.dropped) ++kinds[d.reason];
    std::map<std::string, std::pair<std::size_t, std::string>> grouped;
    for (const auto& [reason, count] : kinds) {
      auto& group = grouped[reason.substr(0, reason.find_first_of(":,"))];
      group.first += count;
      group.second = reason;
    }
    std::string text;
    for (const auto& [kind, group] : grouped)
      text += (text.empty() ? "" : "; ") + std::to_string(group.first) + ": " +
              (group.first == 1       ? group.second
               : kind == group.second ? kind
                                      : kind + ", as in \"" + group.second + "\"");
    throw Error(Exit::data, recording_.sample->place,
                "none of " + std::to_string(result_.dropped.size()) + " images gives a sample (" + text + ")",
                "check poses, patch and limits");
  }

  // The median of what the sample reflects over what the tile reflects at the same directions, brightest band.
  void check_brightness() const {
    std::vector<double> ratios;
    const Samples& samples = result_.samples;
    for (std::size_t r = 0; r < samples.rows(); ++r) {
      const Rgb tile = (*recording_.reflector)(samples.wo[r], samples.wi[r]);
      double most = 0;
      for (std::size_t b = 0; b < bands(); ++b)
        most = std::max(most, samples.f[r * bands() + b] / tile[static_cast<int>(b)]);
      ratios.push_back(most);
    }
    const double ratio = stats::median(ratios);
    const std::string place = recording_.tile->place;
    if (ratio < 1 / brightest_tile)
      throw Error(
          Exit::data, place,
          "the white tile is " + number(1 / ratio) +
              " times brighter than the sample in half of the "
              "images (limit 1000)",
          "check that tile and sample were exposed alike (exposure_s, \"values\"), and which of the two is which");
    if (ratio > brightest_tile)
      throw Error(
          Exit::data, place,
          "the white tile is " + number(ratio) +
              " times darker than the sample in half of the images "
              "(limit 1000)",
          "check that tile and sample were exposed alike (exposure_s, \"values\"), and which of the two is which");
  }

  void note(const std::string& text) { result_.notes.push_back(text); }

  void note_all(const Scales& scales) {
    const std::string rows = std::to_string(result_.samples.rows());
    if (recording_.tile)
      note("The white tile stands beside the sample in " + std::to_string(with_own_tile_) + " of " + rows +
           " pictures that count" +
           (with_own_tile_ < result_.samples.rows() ? "; the others refer to pictures of it under the same light."
                                                    : "."));
    else
      note("Irradiance is that of the lights as the manifest states them; no white tile was used.");
    double spread_i = 0, spread_o = 0;
    for (const Reading& r : result_.readings) {
      spread_i = std::max(spread_i, r.spread_i_rad);
      spread_o = std::max(spread_o, r.spread_o_rad);
    }
    note("Over the patch, directions to the light spread by up to " + number(spread_i * 180 / pi) +
         " degrees (root mean square), those to the camera by up to " + number(spread_o * 180 / pi) +
         " degrees: narrower lobes are smoothed.");
    for (const auto& [light, series] : series_)
      if (const auto wander = scales.wander(light); wander && wander->relative > 3 * wander->expected)
        note("The output of the light \"" + recording_.scene.appearance.lights[light].id +
             "\" wandered: readings of the tile scatter by " + number(100 * wander->relative) + " %, their noise by " +
             number(100 * wander->expected) + " %.");
    for (const std::string& id : names_in(*recording_.document, "mechanisms"))
      if ((id.starts_with("sensor.") && id != mechanism::sensor_saturation().id &&
           id != mechanism::sensor_black_offset().id) ||
          (id.starts_with("optics.") && id != mechanism::optics_vignetting().id))
        note("The mechanism " + id + " is not undone in the pictures.");
    if (std::ranges::any_of(result_.readings, [](const Reading& r) { return std::isnan(r.scatter); }))
      note("Noise is not stated of all images; there the scatter over the patch stands for it.");
  }

  const Recording& recording_;
  std::vector<PictureReading> pictures_;
  std::vector<std::string> tile_refusal_;
  std::map<std::size_t, std::size_t> series_;  // light -> series
  std::size_t with_own_tile_ = 0;
  double common_sigma_ = 0;
  Reduced result_;
};

}  // namespace

Reduced reduce(const manifest::Document& document, const ReduceOptions& options) {
  const Recording recording = set_up(document, options);
  return Reduction(recording, options).reduce();
}

}  // namespace gonio::goniometry
