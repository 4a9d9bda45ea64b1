// See scan_document.h.
#include "scan/scan_document.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/text.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/cloud.h"
#include "manifest/sections/projection.h"
#include "scan/cloud_file.h"
#include "scan/scan_page.h"
#include "scan/scan_views.h"
#include "scan/stations.h"
#include "scan/triangulate.h"
#include "stats/intervals.h"

namespace gonio::scan {
namespace {

using manifest::Document;

DecodeRequest decoding_of(const ScanRequest& request, const Station& camera) {
  DecodeRequest decoding;
  decoding.width = camera.lens.width_px(), decoding.height = camera.lens.height_px();
  decoding.least_reflected = request.least_reflected, decoding.least_difference = request.least_difference;
  decoding.least_share = request.least_share, decoding.least_sigmas = request.least_sigmas;
  decoding.least_direct = request.least_direct;
  decoding.motion = request.motion, decoding.indirect = request.indirect;
  return decoding;
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
  if (!request.shape.empty()) {
    entry.shape = manifest::KnownShape{.model = request.shape};
    if (request.radius_m > 0) entry.shape->radius_m = request.radius_m;
  }
  entry.points = static_cast<std::int64_t>(cloud.points.size());
  std::vector<double> sigmas, off;
  for (const ScanPoint& p : cloud.points) sigmas.push_back(p.sigma_m), off.push_back(p.reprojection_px);
  if (!sigmas.empty()) entry.sigma_m = stats::median(sigmas), entry.reprojection_px = stats::median(off);
  if (cloud.epipolar_chi_square > 0) entry.epipolar_chi_square = cloud.epipolar_chi_square;
  for (const auto& [reason, count] : cloud.refused) entry.refused[reason] = static_cast<std::int64_t>(count);
  return entry;
}

Cloud points_of(const ScanRequest& request, const std::vector<Codes>& codes, const std::vector<Station>& stations,
                const Sequence& sequence) {
  if (codes.size() == 1) return points_of_projector(codes[0], stations[0], stations[1]);
  std::vector<Look> cameras;
  for (std::size_t c = 0; c < codes.size(); ++c) cameras.push_back({&codes[c], stations[c]});
  return points_of_rig(cameras, request.projector.empty() ? nullptr : &stations.back(), sequence.width_px);
}

// Where all cameras take colour pictures.
void colour(const Document& document, const ScanView& view, const Sequence& sequence, const std::vector<Codes>& codes,
            Cloud& cloud) {
  std::vector<std::vector<std::array<float, 3>>> pictures;
  for (std::size_t c = 0; c < codes.size(); ++c) {
    pictures.push_back(colours_of(document, sequence, view.cameras[c], codes[c].width, codes[c].height));
    if (pictures.back().empty()) return;
  }
  for (const ScanPoint& p : cloud.points) {
    const auto x = static_cast<std::size_t>(std::lround(p.pixel.x)),
               y = static_cast<std::size_t>(std::lround(p.pixel.y));
    cloud.colours.push_back(pictures[p.camera][y * static_cast<std::size_t>(codes[p.camera].width) + x]);
  }
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
  if (matched > 0) text += format(" of %zu pixels of the projector that two devices know of", matched);
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
  }
  if (request.cameras.size() > 1 && (!sequence.tells(Axis::column) || !sequence.tells(Axis::row))) {
    throw Error(Exit::data, manifest::place(document, "/projections/" + request.projection),
                "tells one axis alone, and several cameras need both to find the same pixel of the projector",
                "show columns and rows, or measure by one camera and a projector that is calibrated (--projector)");
  }
  for (const ScanView& view : views_of(document, request.projection, request.cameras))
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
  for (const ScanView& view : views_of(document, request.projection, request.cameras)) {
    std::vector<Codes> codes(view.cameras.size());
    parallel_for(0, codes.size(), [&](std::size_t c) {
      codes[c] =
          codes_of(document, request.projection, request.projector, view.cameras[c], decoding_of(request, stations[c]));
    });
    for (std::size_t c = 0; c < codes.size() && request.codes; ++c)
      write_codes(request.output_path(file_stem(view.name + "-" + request.cameras[c]) + "-codes.exr"), codes[c]);
    Cloud cloud = points_of(request, codes, stations, sequence);
    colour(document, view, sequence, codes, cloud);
    for (std::size_t c = 0; c < codes.size(); ++c) log_noise(request.cameras[c], codes[c]);
    const auto pose = world_from_camera(document, view.cameras[0][0]);
    const auto path = request.output_path(file_stem(view.name) + ".ply");
    Rigid<frame::World, frame::Rig> world_from_rig;
    if (pose) world_from_rig = *pose * inverse(stations[0].rig_from_camera);
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
