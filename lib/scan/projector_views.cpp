// See projector_views.h.
#include "scan/projector_views.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "camera/picture_names.h"
#include "io/image.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/projection.h"
#include "scan/projector_corners.h"
#include "scan/scan_document.h"
#include "scan/scan_views.h"
#include "scan/sequence.h"

namespace gonio::scan {
namespace {

using manifest::Document;
using manifest::ImageEntry;

std::string image_place(const Document& document, std::size_t image) {
  return manifest::place(document, "/images/" + std::to_string(image));
}

// That took pictures of the projection, in the order of the images.
std::vector<std::string> cameras_of(const Document& document, const ProjectorRequest& request) {
  std::vector<std::string> cameras;
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const ImageEntry& image = document.images[i];
    if (image.camera == request.projector && !image.file.empty())
      throw Error(Exit::data, image_place(document, i), "is a photograph by " + request.projector + ", the projector",
                  "give projector and cameras different names");
    if (image.projection != request.projection || image.file.empty()) continue;
    if (image.camera.empty())
      throw Error(Exit::data, image_place(document, i) + "/camera", "missing",
                  "say which of the cameras took the image");
    if (std::ranges::find(cameras, image.camera) == cameras.end()) cameras.push_back(image.camera);
  }
  if (cameras.empty())
    throw Error(Exit::no_input, manifest::place(document, "/images"),
                "have no pictures of projection " + request.projection,
                "say in each what it shows (projection, shows, group), or name the photographs");
  return cameras;
}

// The frame in which a board looks as it does by day.
std::size_t plain_frame(const Sequence& sequence) {
  const auto white = std::ranges::find(sequence.frames, Shown::What::white, &Shown::what);
  return white == sequence.frames.end() ? 0 : static_cast<std::size_t>(white - sequence.frames.begin());
}

void check_projector(const Document& document, const ProjectorRequest& request, const Sequence& sequence) {
  const std::string at = manifest::place(document, "/projections/" + request.projection);
  for (const Axis axis : {Axis::column, Axis::row})
    if (!sequence.tells(axis))
      throw Error(Exit::data, at, "tells one axis alone, and a corner has two coordinates", "show columns and rows");
  using What = Shown::What;
  const auto has = [&](What what) {
    return std::ranges::find(sequence.frames, what, &Shown::what) != sequence.frames.end();
  };
  if (has(What::bit) && (!has(What::white) || !has(What::black)))
    throw Error(Exit::data, at, "has bits, and no white or no black picture",
                "show both: corners are sought in the white one, and they tell what is lit at all");
  const auto known = document.cameras.find(request.projector);
  if (known == document.cameras.end()) return;
  const manifest::Camera& own = known->second;
  if ((own.width_px != 0 && own.width_px != sequence.width_px) ||
      (own.height_px != 0 && own.height_px != sequence.height_px))
    throw Error(Exit::data, manifest::place(document, "/cameras/" + request.projector),
                format("has %d x %d pixels, and what it shows %d x %d", own.width_px, own.height_px, sequence.width_px,
                       sequence.height_px),
                "state the projector's own size in both");
}

// The image that stands for what the projector sees of a view: of a calibration before this one, or new.
ImageEntry& own_view(Document& document, const ProjectorRequest& request, const ScanView& view) {
  for (ImageEntry& image : document.images)
    if (image.camera == request.projector && image.group == view.group) return image;
  ImageEntry image;
  const std::string id = view.name + "-" + request.projector;
  image.id = id;
  for (int k = 2; manifest::index_of_image(document, image.id); ++k) image.id = id + "-" + std::to_string(k);
  image.camera = request.projector, image.group = view.group;
  document.images.push_back(std::move(image));
  return document.images.back();
}

void enter_view(const ScanView& view, std::size_t plain, const ProjectorRequest& request, Document& document) {
  ImageEntry& own = own_view(document, request, view);
  const std::string shot = view.name;
  own.shot = shot;
  for (const Frames& frames : view.cameras) {
    const std::size_t i = frames[plain];
    ImageEntry& image = document.images[i];
    if (image.board.empty() && image.boards.empty()) {
      if (document.boards.size() != 1)
        throw Error(Exit::data, image_place(document, i) + "/board", "missing",
                    document.boards.empty() ? "describe the board" : "say which of the boards the image shows");
      image.board = document.boards.begin()->first;
    }
    image.shot = shot;
    if (own.boards.empty() && own.board.empty()) own.board = image.board, own.boards = image.boards;
  }
}

class Lookup {
 public:
  Lookup(ProjectorRequest request, std::function<void(const std::filesystem::path&)> note)
      : request_(std::move(request)), note_(std::move(note)) {}

  std::optional<io::GreyImage> picture(const Document& document, std::size_t image) const {
    const ImageEntry& entry = document.images[image];
    if (entry.projection != request_.projection) return std::nullopt;
    const Sequence sequence = sequence_of(document, request_.projection);
    if (sequence.frames[plain_frame(sequence)].what != Shown::What::cosine) return std::nullopt;
    return mean_of(document, sequence, frames_of(document, image));
  }

  camera::Detection corners(const Document& document, std::size_t image, const std::string& board,
                            const std::vector<camera::SeenBoard>& seen) const {
    const ImageEntry& own = document.images[image];
    if (own.camera != request_.projector)
      throw Error(Exit::data, image_place(document, image) + "/file", "missing", "name the photograph");
    std::vector<Codes> codes(seen.size());
    std::vector<CameraCorners> cameras;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      if (document.images[seen[k].image].projection != request_.projection) continue;
      codes[k] = codes_at(document, seen[k].image);
      cameras.push_back({seen[k].camera, &seen[k].detection, &codes[k]});
    }
    ProjectorCorners found = projector_corners(cameras, camera::board_of(document, board));
    if (found.turned_over > 0)
      throw Error(
          Exit::data, image_place(document, image),
          own.id + (found.exchanged ? " has columns for rows: the projector's columns run down the board's mirror image"
                                    : " is mirrored: the projector's pixels run the other way round than the camera's"),
          found.exchanged ? "say of every frame which axis it shows, and of every image which frame"
                          : "turn off mirroring in projector and camera, or state the frames as they were shown");
    return found.detection;
  }

 private:
  Frames frames_of(const Document& document, std::size_t image) const {
    const ImageEntry& entry = document.images[image];
    for (ScanView& view : views_of(document, request_.projection, {entry.camera}))
      if (view.group == entry.group) return view.cameras[0];
    throw Error(Exit::internal, image_place(document, image), "is of no view", "report this");
  }

  // Over shifts that are evenly spread the pattern cancels.
  io::GreyImage mean_of(const Document& document, const Sequence& sequence, const Frames& frames) const {
    const io::GreyImage first = io::read_grey(manifest::picture_path(document, frames[0]));
    io::Image mean(first.width, first.height, {"Y"});
    double count = 0;
    for (std::size_t f = 0; f < frames.size(); ++f) {
      if (sequence.frames[f].what != Shown::What::cosine) continue;
      const CameraFrame frame = read_frame(document, frames[f], first.width, first.height);
      for (std::size_t i = 0; i < frame.size(); ++i) mean.data[i] += frame.at(i);
      ++count;
    }
    for (float& v : mean.data) v /= static_cast<float>(count);
    return io::grey_of(mean);
  }

  Codes codes_at(const Document& document, std::size_t image) const {
    const Frames frames = frames_of(document, image);
    const io::GreyImage first = io::read_grey(manifest::picture_path(document, frames[0]));
    if (note_)
      for (const std::size_t i : frames) note_(manifest::picture_path(document, i));
    DecodeRequest decoding;
    decoding.width = first.width, decoding.height = first.height;
    return codes_of(document, request_.projection, request_.projector, frames, std::move(decoding));
  }

  ProjectorRequest request_;
  std::function<void(const std::filesystem::path&)> note_;
};

}  // namespace

void enter_board_sequences(const std::vector<std::string>& paths, const ProjectorRequest& request,
                           const std::vector<std::string>& cameras, const std::string& response, Document& document) {
  std::map<std::string, std::vector<std::string>> views;
  for (const std::string& path : paths) {
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    std::string name = folder.filename().string();
    if (const std::string camera = camera::camera_in_name(name, cameras); cameras.size() > 1 && !camera.empty())
      name.erase(name.find(camera), camera.size());
    views[(folder.parent_path() / name).string()].push_back(path);
  }
  std::set<std::string> names;
  for (const auto& [folder, own] : views) {
    const std::size_t before = document.images.size();
    enter_photographs(own, request.projection, cameras, response, document);
    const std::filesystem::path path = std::filesystem::path(folder).lexically_normal();
    std::string group = path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
    if (group.empty() || group == "." || !names.insert(group).second) group = folder.empty() ? "view" : folder;
    for (std::size_t i = before; i < document.images.size(); ++i) document.images[i].group = group;
  }
}

void enter_projector_views(const ProjectorRequest& request, Document& document) {
  const Sequence sequence = sequence_of(document, request.projection);
  check_projector(document, request, sequence);
  const std::vector<std::string> cameras = cameras_of(document, request);
  for (const ScanView& view : views_of(document, request.projection, cameras)) {
    for (const Frames& frames : view.cameras)
      for (const std::size_t i : frames) {
        const std::filesystem::path path = manifest::picture_path(document, i);
        if (!std::filesystem::exists(path))
          throw Error(Exit::no_input, path.string(), "is missing", "a sequence is complete or nothing");
      }
    enter_view(view, plain_frame(sequence), request, document);
  }
  const auto [entry, fresh] = document.cameras.try_emplace(request.projector);
  if (fresh) entry->second.model = request.model;
  entry->second.width_px = sequence.width_px, entry->second.height_px = sequence.height_px;
}

void look_up_corners(const ProjectorRequest& request, camera::CalibrationRequest& calibration,
                     std::function<void(const std::filesystem::path&)> note_input) {
  const auto lookup = std::make_shared<const Lookup>(request, std::move(note_input));
  calibration.picture = [lookup](const Document& document, std::size_t image) {
    return lookup->picture(document, image);
  };
  calibration.look_up = [lookup](const Document& document, std::size_t image, const std::string& board,
                                 const std::vector<camera::SeenBoard>& seen) {
    return lookup->corners(document, image, board, seen);
  };
}

}  // namespace gonio::scan
