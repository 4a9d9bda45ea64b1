// See scan_document.h.
#include "scan/scan_document.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/text.h"
#include "io/grey.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/cloud.h"
#include "manifest/sections/image.h"
#include "manifest/sections/projection.h"
#include "photograph/linear_picture.h"
#include "photograph/mask.h"
#include "photograph/response.h"
#include "photograph/saturation.h"
#include "scan/cloud_file.h"
#include "scan/scan_page.h"
#include "scan/stations.h"
#include "scan/triangulate.h"
#include "stats/intervals.h"

namespace gonio::scan {
namespace {

using manifest::Document;
using manifest::ImageEntry;

// Places in document.images, by frame of the projection.
using Frames = std::vector<std::size_t>;

struct View {
  std::string name;
  std::vector<Frames> cameras;  // in the request's order
};

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

std::vector<View> views_of(const Document& document, const ScanRequest& request) {
  const manifest::Projection& projection = document.projections.at(request.projection);
  constexpr auto none = static_cast<std::size_t>(-1);
  std::map<std::string, View> found;
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const ImageEntry& image = document.images[i];
    if (image.projection != request.projection || image.file.empty() || image.weight == 0.0) continue;
    const auto camera = std::ranges::find(request.cameras, image.camera);
    if (camera == request.cameras.end()) continue;
    if (!image.shows)
      throw Error(Exit::data, place_of(document, i), "does not say which frame of its projection it shows",
                  "\"shows\": its place, from 0");
    View& view = found[image.group];
    view.name = image.group.empty() ? request.projection : image.group;
    view.cameras.resize(request.cameras.size(), Frames(projection.frames.size(), none));
    std::size_t& place = view.cameras[static_cast<std::size_t>(camera - request.cameras.begin())]
                                     [static_cast<std::size_t>(*image.shows)];
    if (place != none)
      throw Error(Exit::data, place_of(document, i),
                  "shows the same frame as " + document.images[place].id + ", by the same camera",
                  "give views different groups, or leave one out");
    place = i;
  }
  std::vector<View> views;
  for (auto& [key, view] : found) {
    for (std::size_t c = 0; c < view.cameras.size(); ++c)
      for (std::size_t f = 0; f < projection.frames.size(); ++f)
        if (view.cameras[c][f] == none)
          throw Error(Exit::data, manifest::place(document, "/images"),
                      format("have no picture of frame %zu (%s) by camera %s in view %s", f,
                             words_of(projection.frames[f]).c_str(), request.cameras[c].c_str(), view.name.c_str()),
                      "record it again, whole: everything else stands still only once");
    views.push_back(std::move(view));
  }
  if (views.empty())
    throw Error(Exit::no_input, manifest::place(document, "/images"),
                "have no pictures of projection " + request.projection + " by " + request.cameras[0],
                "say in each what it shows (projection, shows), or name the photographs");
  return views;
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

Codes codes_of(const Document& document, const ScanRequest& request, const Frames& frames, const Station& camera) {
  DecodeRequest decoding;
  decoding.sequence = sequence_of(document, request.projection);
  decoding.width = camera.lens.width_px(), decoding.height = camera.lens.height_px();
  decoding.read = [&](std::size_t frame) {
    return read_frame(document, frames[frame], decoding.width, decoding.height);
  };
  const std::filesystem::path mask = manifest::mask_path(document, frames[0]);
  if (!mask.empty())
    decoding.mask = photograph::read_mask_of(io::Image(decoding.width, decoding.height, {"Y"}), mask,
                                             place_of(document, frames[0], "/mask"));
  decoding.noise = noise_of_frames(document, frames);
  decoding.least_reflected = request.least_reflected, decoding.least_difference = request.least_difference;
  decoding.least_share = request.least_share, decoding.least_sigmas = request.least_sigmas;
  decoding.indirect = request.indirect;
  return decode(decoding);
}

void write_codes(const std::filesystem::path& path, const Codes& codes) {
  std::vector<std::string> names{"reflected", "refusal"};
  constexpr const char* axes[] = {"column", "row"};
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (!codes.place[axis].empty()) names.insert(names.end(), {axes[axis], std::string("sigma.") + axes[axis]});
  io::Image picture(codes.width, codes.height, names);
  for (std::size_t i = 0; i < codes.refusal.size(); ++i) {
    float* at = &picture.data[i * names.size()];
    *at++ = codes.reflected.empty() ? 0 : codes.reflected[i];
    *at++ = static_cast<float>(codes.refusal[i]);
    for (std::size_t axis = 0; axis < 2; ++axis)
      if (!codes.place[axis].empty()) *at++ = codes.place[axis][i], *at++ = codes.sigma[axis][i];
  }
  io::write_picture(path, picture);
}

manifest::Cloud entry_of(const Cloud& cloud, const ScanRequest& request) {
  manifest::Cloud entry;
  entry.cameras = request.cameras;
  if (!request.projector.empty()) entry.cameras.push_back(request.projector);
  entry.projection = request.projection;
  entry.points = static_cast<std::int64_t>(cloud.points.size());
  std::vector<double> sigmas, off;
  for (const ScanPoint& p : cloud.points) sigmas.push_back(p.sigma_m), off.push_back(p.reprojection_px);
  if (!sigmas.empty()) entry.sigma_m = stats::median(sigmas), entry.reprojection_px = stats::median(off);
  if (cloud.epipolar_chi_square > 0) entry.epipolar_chi_square = cloud.epipolar_chi_square;
  for (const auto& [reason, count] : cloud.refused) entry.refused[reason] = static_cast<std::int64_t>(count);
  return entry;
}

void log_noise(const std::string& camera, const Codes& codes) {
  log(LogLevel::info,
      format("camera %s: noise %.3g of a full picture in the dark%s", camera.c_str(), codes.noise.read,
             codes.noise.gain > 0 ? format(", %.3g in the brightest",
                                           std::sqrt(codes.noise.read * codes.noise.read + 1 / codes.noise.gain))
                                        .c_str()
                                  : ""));
  if (codes.gamma_sigma > 0)
    log(LogLevel::info, format("camera %s: the projector's light goes with the power %.4g +- %.2g of what is sent",
                               camera.c_str(), codes.gamma, codes.gamma_sigma));
}

void log_cloud(const std::string& name, const manifest::Cloud& c, std::size_t matched) {
  std::string text = format("view %s: %lld points", name.c_str(), static_cast<long long>(c.points));
  if (matched > 0) text += format(" of %zu pixels of the projector that both cameras see", matched);
  if (c.sigma_m) text += format(", sigma %.3g mm", 1e3 * *c.sigma_m);
  if (c.reprojection_px && *c.reprojection_px > 0) text += format(", reprojection %.3g px", *c.reprojection_px);
  std::string refused;
  for (const auto& [reason, count] : c.refused)
    refused += format("%s%lld %s", refused.empty() ? "" : ", ", static_cast<long long>(count), reason.c_str());
  log(LogLevel::info, text + (refused.empty() ? "" : "; without a point: " + refused));
}

}  // namespace

void check_scan(const Document& document, const ScanRequest& request) {
  const Sequence sequence = sequence_of(document, request.projection);
  std::vector<std::string> names = request.cameras;
  if (!request.projector.empty()) names.push_back(request.projector);
  const std::vector<Station> stations = stations_of(document, names);
  if (!request.projector.empty()) {
    const Station& projector = stations.back();
    if (projector.lens.width_px() != sequence.width_px || projector.lens.height_px() != sequence.height_px)
      throw Error(Exit::data, manifest::place(document, "/cameras/" + request.projector),
                  format("has %d x %d pixels, and what it shows %d x %d", projector.lens.width_px(),
                         projector.lens.height_px(), sequence.width_px, sequence.height_px),
                  "state the projector's own size in both");
  } else if (!sequence.tells(Axis::column) || !sequence.tells(Axis::row)) {
    throw Error(Exit::data, manifest::place(document, "/projections/" + request.projection),
                "tells one axis alone, and two cameras need both to find the same pixel of the projector",
                "show columns and rows, or calibrate the projector (--projector)");
  }
  for (const View& view : views_of(document, request))
    for (const Frames& frames : view.cameras)
      for (const std::size_t i : frames) {
        const std::filesystem::path path = manifest::picture_path(document, i);
        if (!std::filesystem::exists(path))
          throw Error(Exit::no_input, path.string(), "is missing", "a sequence is complete or nothing");
        if (request.note_input) request.note_input(path);
      }
}

ScanSummary scan_document(Document& document, const ScanRequest& request) {
  std::vector<std::string> names = request.cameras;
  if (!request.projector.empty()) names.push_back(request.projector);
  const std::vector<Station> stations = stations_of(document, names);
  const Sequence sequence = sequence_of(document, request.projection);
  std::optional<ScanSummary> all;
  ScanPage page;
  for (const View& view : views_of(document, request)) {
    std::vector<Codes> codes(view.cameras.size());
    parallel_for(0, codes.size(),
                 [&](std::size_t c) { codes[c] = codes_of(document, request, view.cameras[c], stations[c]); });
    for (std::size_t c = 0; c < codes.size() && request.codes; ++c)
      write_codes(request.output_path(file_stem(view.name + "-" + request.cameras[c]) + "-codes.exr"), codes[c]);
    const Cloud cloud = request.projector.empty()
                            ? points_of_cameras(codes[0], stations[0], codes[1], stations[1], sequence.width_px)
                            : points_of_projector(codes[0], stations[0], stations[1]);
    for (std::size_t c = 0; c < codes.size(); ++c) log_noise(request.cameras[c], codes[c]);
    const auto& pose = document.images[view.cameras[0][0]].world_from_camera;
    const auto path = request.output_path(file_stem(view.name) + ".ply");
    Rigid<frame::World, frame::Rig> world_from_rig;
    if (pose) {
      const Rigid<frame::World, frame::Camera>& world_from_camera = *pose;
      world_from_rig = world_from_camera * inverse(stations[0].rig_from_camera);
    }
    write_cloud(path, cloud, world_from_rig);
    manifest::Cloud entry = entry_of(cloud, request);
    entry.file = manifest::add_file(document, path, "cloud-" + view.name);
    log_cloud(view.name, entry, cloud.matched);
    if (!all) all = ScanSummary{cloud.points.size()};
    all->fewest_points = std::min(all->fewest_points, cloud.points.size());
    all->epipolar_chi_square = std::max(all->epipolar_chi_square, cloud.epipolar_chi_square);
    if (!request.page.empty()) page.add(view.name, request.cameras, codes, sequence, stations[0], cloud, entry);
    document.clouds[view.name] = std::move(entry);
  }
  if (!request.page.empty()) write_file(request.page, page.html());
  return *all;
}

}  // namespace gonio::scan
