// See scan_views.h.
#include "scan/scan_views.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "io/grey.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/projection.h"
#include "mechanism/mechanism.h"
#include "photograph/linear_picture.h"
#include "photograph/mask.h"
#include "photograph/response.h"
#include "photograph/saturation.h"

namespace gonio::mechanism {
const Mechanism& projector_gamma();
}

namespace gonio::scan {

using manifest::Document;
using manifest::ImageEntry;

namespace {

std::string place_of(const Document& document, std::size_t image, const std::string& key = "") {
  return manifest::place(document, "/images/" + std::to_string(image) + key);
}

std::string words_of(const manifest::ProjectedFrame& f) {
  if (f.show == "bit")
    return format("bit %lld of %ss%s", static_cast<long long>(*f.bit), f.axis.c_str(),
                  f.inverse.value_or(false) ? ", inverse" : "");
  if (f.show == "cosine")
    return format("%g periods along the %ss, shifted by %.4g rad", *f.periods, f.axis.c_str(), *f.shift_rad);
  if (f.show == "line")
    return format("lines %lld pixels apart along the %ss, at %lld", static_cast<long long>(*f.period_px),
                  f.axis.c_str(), static_cast<long long>(*f.offset_px));
  return f.show;
}

void check_size(const std::filesystem::path& path, int own_width, int own_height, int width, int height) {
  if (own_width == width && own_height == height) return;
  throw Error(Exit::data, path.string(),
              format("has %d x %d pixels, and its camera %d x %d", own_width, own_height, width, height),
              "give pictures of this camera, uncut");
}

// Codes of a file that is grey and has 8 bits: a quarter of the numbers' bytes.
std::optional<CameraFrame> read_codes(const Document& document, std::size_t image, int width, int height) {
  const ImageEntry& entry = document.images[image];
  const std::filesystem::path path = manifest::picture_path(document, image);
  if (!io::is_grey_of_8_bits(path) || entry.response.is_null()) return std::nullopt;
  io::GreyImage read = io::read_grey(path);
  check_size(path, read.width, read.height, width, height);
  const std::string at = place_of(document, image, "/response");
  const photograph::Response response(photograph::response_of_channel(entry.response, "Y", at), at);
  CameraFrame frame;
  frame.codes = std::move(read.bytes);
  const double full = photograph::saturated_from(8, entry.saturation);
  for (int code = 255; code >= 0; --code) {
    const float share = static_cast<float>(code) / 255;
    frame.light_of_code[static_cast<std::size_t>(code)] = response(share);
    if (share >= full) frame.full_from = code;
  }
  return frame;
}

// Nothing where one states none, or another.
std::optional<manifest::Noise> noise_of_frames(const Document& document, const Frames& frames) {
  const auto& first = document.images[frames[0]].noise;
  for (const std::size_t i : frames) {
    const auto& own = document.images[i].noise;
    if (!own || !(own->gain > 0 || own->read > 0) || own->gain != first->gain || own->read != first->read)
      return std::nullopt;
  }
  return first;
}

}  // namespace

std::vector<ScanView> views_of(const Document& document, const std::string& projection_name,
                               const std::vector<std::string>& cameras) {
  const manifest::Projection& projection = document.projections.at(projection_name);
  constexpr auto none = static_cast<std::size_t>(-1);
  std::map<std::string, ScanView> found;
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const ImageEntry& image = document.images[i];
    if (image.projection != projection_name || image.file.empty() || image.weight == 0.0) continue;
    const auto camera = std::ranges::find(cameras, image.camera);
    if (camera == cameras.end()) continue;
    if (!image.shows)
      throw Error(Exit::data, place_of(document, i), "does not say which frame of its projection it shows",
                  "\"shows\": its place, from 0");
    ScanView& view = found[image.group];
    view.group = image.group, view.name = image.group.empty() ? projection_name : image.group;
    view.cameras.resize(cameras.size(), Frames(projection.frames.size(), none));
    std::size_t& place =
        view.cameras[static_cast<std::size_t>(camera - cameras.begin())][static_cast<std::size_t>(*image.shows)];
    if (place != none)
      throw Error(Exit::data, place_of(document, i),
                  "shows the same frame as " + document.images[place].id + ", by the same camera",
                  "give views different groups, or leave one out");
    place = i;
  }
  std::vector<ScanView> views;
  for (auto& [key, view] : found) {
    for (std::size_t c = 0; c < view.cameras.size(); ++c)
      for (std::size_t f = 0; f < projection.frames.size(); ++f)
        if (view.cameras[c][f] == none)
          throw Error(Exit::data, manifest::place(document, "/images"),
                      format("have no picture of frame %zu (%s) by camera %s in view %s", f,
                             words_of(projection.frames[f]).c_str(), cameras[c].c_str(), view.name.c_str()),
                      "record it again, whole: everything else stands still only once");
    views.push_back(std::move(view));
  }
  if (views.empty())
    throw Error(Exit::no_input, manifest::place(document, "/images"),
                "have no pictures of projection " + projection_name + " by " + cameras[0],
                "say in each what it shows (projection, shows), or name the photographs");
  return views;
}

std::optional<Rigid<frame::World, frame::Camera>> world_from_camera(const Document& document, std::size_t image) {
  const auto& pose = document.images[image].world_from_camera;
  return pose ? std::optional<Rigid<frame::World, frame::Camera>>(*pose) : std::nullopt;
}

CameraFrame read_frame(const Document& document, std::size_t image, int width, int height) {
  if (std::optional<CameraFrame> codes = read_codes(document, image, width, height)) return std::move(*codes);
  const ImageEntry& entry = document.images[image];
  photograph::LinearPicture read = photograph::read_linear(manifest::picture_path(document, image), entry.response,
                                                           place_of(document, image, "/response"), entry.saturation);
  check_size(manifest::picture_path(document, image), read.colour.width, read.colour.height, width, height);
  CameraFrame frame;
  const std::size_t channels = read.colour.channels.size(), pixels = read.colour.pixels();
  if (channels == 1)
    frame.light = std::move(read.colour.data);
  else {
    frame.light.resize(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
      float sum = 0;
      for (std::size_t c = 0; c < channels; ++c) sum += read.colour.data[i * channels + c];
      frame.light[i] = sum / static_cast<float>(channels);
    }
  }
  frame.saturated = std::move(read.clipped);
  return frame;
}

std::vector<std::array<float, 3>> colours_of(const Document& document, const Sequence& sequence, const Frames& frames,
                                             int width, int height) {
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<std::array<float, 3>> sum;
  // False for a grey picture.
  const auto add = [&](std::size_t frame, float weight) {
    const std::size_t image = frames[frame];
    const std::filesystem::path path = manifest::picture_path(document, image);
    if (io::is_grey_of_8_bits(path)) return false;
    const ImageEntry& entry = document.images[image];
    const photograph::LinearPicture read =
        photograph::read_linear(path, entry.response, place_of(document, image, "/response"), entry.saturation);
    check_size(path, read.colour.width, read.colour.height, width, height);
    const std::size_t channels = read.colour.channels.size();
    if (channels < 3) return false;
    sum.resize(pixels);
    for (std::size_t i = 0; i < pixels; ++i)
      for (std::size_t k = 0; k < 3; ++k) sum[i][k] += weight * read.colour.data[i * channels + k];
    return true;
  };
  const Shown* coarsest = nullptr;
  for (std::size_t f = 0; f < sequence.frames.size(); ++f) {
    const Shown& s = sequence.frames[f];
    if (s.what == Shown::What::white || s.what == Shown::What::black) {
      if (!add(f, s.what == Shown::What::white ? 1.0f : -1.0f)) return {};
    } else if (s.what == Shown::What::cosine && (coarsest == nullptr || s.periods < coarsest->periods)) {
      coarsest = &s;
    }
  }
  if (!sum.empty() || coarsest == nullptr) return sum;
  const auto is_one = [coarsest](const Shown& s) {
    return s.what == coarsest->what && s.axis == coarsest->axis && s.periods == coarsest->periods;
  };
  const auto count = static_cast<float>(std::ranges::count_if(sequence.frames, is_one));
  for (std::size_t f = 0; f < sequence.frames.size(); ++f)
    if (is_one(sequence.frames[f]) && !add(f, 1 / count)) return {};
  return sum;
}

namespace {

// Of several projectors the numbers stand in the order of `on`.
void take_gamma(const Document& document, const std::string& projector, DecodeRequest& decoding) {
  const auto use = document.mechanisms.find(mechanism::projector_gamma().id);
  if (use == document.mechanisms.end()) return;
  const std::vector<std::string>& on = use->second.on;
  std::size_t place = 0;
  if (!on.empty() && !projector.empty()) {
    place = static_cast<std::size_t>(std::ranges::find(on, projector) - on.begin());
    if (place == on.size()) return;
  } else if (on.size() > 1) {
    return;
  }
  const auto gamma = use->second.parameters.find("gamma");
  const auto sigma = use->second.sigma.find("gamma");
  if (gamma != use->second.parameters.end() && gamma->second.given()) {
    const std::vector<double>& values = gamma->second.value;
    decoding.gamma = values[std::min(place, values.size() - 1)];
  }
  if (sigma != use->second.sigma.end() && !sigma->second.empty())
    decoding.gamma_sigma = sigma->second[std::min(place, sigma->second.size() - 1)];
}

void warn_of_level(const std::string& camera, const char* side, const std::optional<FlatLevel>& level) {
  if (!level) return;
  log(LogLevel::warning, format("camera %s: the projector shows all %s %.3g +- %.2g of what is sent alike; turn its "
                                "contrast down. Phases are straightened for it",
                                camera.c_str(), side, level->level, level->sigma));
}

}  // namespace

Codes codes_of(const Document& document, const std::string& projection, const std::string& projector,
               const Frames& frames, DecodeRequest decoding) {
  decoding.sequence = sequence_of(document, projection);
  decoding.read = [&](std::size_t frame) {
    return read_frame(document, frames[frame], decoding.width, decoding.height);
  };
  const std::filesystem::path mask = manifest::mask_path(document, frames[0]);
  if (!mask.empty())
    decoding.mask = photograph::read_mask_of(io::Image(decoding.width, decoding.height, {"Y"}), mask,
                                             place_of(document, frames[0], "/mask"));
  decoding.noise = noise_of_frames(document, frames);
  take_gamma(document, projector, decoding);
  Codes codes = decode(decoding);
  const std::string& camera = document.images[frames[0]].camera;
  warn_of_level(camera, "above", codes.above), warn_of_level(camera, "below", codes.below);
  return codes;
}

}  // namespace gonio::scan
