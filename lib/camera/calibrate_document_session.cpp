// From the manifest's images to sessions, and from pictures to corners.
#include "camera/calibrate_document_session.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/parallel.h"
#include "base/progress.h"
#include "camera/detection_failure.h"
#include "camera/intrinsics.h"
#include "io/grey.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/projection.h"

namespace gonio::camera {
namespace {

constexpr double usual_noise_px = 0.1;  // where too few corners allow no estimate
constexpr double least_noise_px = 0.01;
constexpr double same_corner_px = 1e-3;  // two photographs never agree as closely
constexpr std::size_t enough_corners = 6;

std::vector<std::string> board_ids_of(const manifest::Document& document, std::size_t index) {
  const manifest::ImageEntry& image = document.images[index];
  std::vector<std::string> ids;
  for (const manifest::SeenBoard& seen : image.boards) ids.push_back(seen.board);
  if (ids.empty() && !image.board.empty()) ids.push_back(image.board);
  if (ids.empty() && document.boards.size() == 1) ids.push_back(document.boards.begin()->first);
  if (!ids.empty()) return ids;
  throw Error(Exit::data, manifest::place(document, image_pointer(index) + "/board"), "missing",
              "say which of the boards the image shows");
}

std::string camera_id_of(const manifest::Document& document, std::size_t index) {
  const std::string& given = document.images[index].camera;
  if (!given.empty()) return given;
  const auto cameras = names_in(document, "cameras");
  if (cameras.size() == 1) return cameras.front();
  if (cameras.empty()) return "camera";
  throw Error(Exit::data, manifest::place(document, image_pointer(index) + "/camera"), "missing",
              "say which of the cameras took the image");
}

// Under a pattern no corner is where it seems to be.
bool shows_board(const manifest::Document& document, const manifest::ImageEntry& image) {
  if (image.projection.empty() || !image.board.empty() || !image.boards.empty()) return true;
  const manifest::Projection& shown = document.projections.at(image.projection);
  return image.shows && shown.frames.at(static_cast<std::size_t>(*image.shows)).show == "white";
}

// The first of the cameras that one is tied to, directly or through others, by images of one shot.
std::map<std::string, std::string> leaders(const manifest::Document& document) {
  std::map<std::string, std::string> leader, first_of_shot;
  const auto find = [&](std::string camera) {
    while (leader.at(camera) != camera) camera = leader.at(camera);
    return camera;
  };
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    if (!shows_board(document, document.images[i])) continue;
    const std::string camera = camera_id_of(document, i);
    leader.emplace(camera, camera);
    if (document.images[i].shot.empty()) continue;
    const auto [shot, fresh] = first_of_shot.emplace(document.images[i].shot, camera);
    if (fresh) continue;
    const std::string a = find(shot->second), b = find(camera);
    leader[std::max(a, b)] = std::min(a, b);
  }
  for (auto& [camera, own] : leader) own = find(camera);
  return leader;
}

std::size_t entered(std::vector<std::string>& names, const std::string& name) {
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  names.push_back(name);
  return names.size() - 1;
}

void enter_sightings(const manifest::Document& document, std::size_t index, Session& session, Picture& picture) {
  for (const std::string& id : board_ids_of(document, index)) {
    const std::size_t known = session.board_ids.size(), board = entered(session.board_ids, id);
    if (board == known) {
      session.boards.push_back(board_of(document, id));
    }
    picture.sightings.push_back({board, {}, 0});
  }
}

void look(Picture& picture, const std::vector<Board>& boards, const CalibrationRequest& request,
          const manifest::Document& document) {
  if (picture.path.empty()) return;
  DetectionOptions options = request.detection;
  options.parts = options.parts && picture.by_itself;
  std::optional<io::GreyImage> made;
  if (request.picture) made = request.picture(document, picture.entry);
  const io::GreyImage image = made ? std::move(*made) : io::read_grey(picture.path);
  picture.width_px = image.width;
  picture.height_px = image.height;
  for (Sighting& sighting : picture.sightings) {
    sighting.detection = detect_board(image, boards[sighting.board], options);
  }
}

void settle_layout(Session& session, std::size_t index, const CalibrationRequest& request,
                   const manifest::Document& document) {
  Board& board = session.boards[index];
  if (!board.layout_matters() || board.legacy) return;
  std::array<int, 2> votes{};
  std::vector<Picture*> others;
  for (const Picture& picture : session.pictures) {
    for (const Sighting& s : picture.sightings) {
      for (std::size_t k = 0; s.board == index && k < 2; ++k) votes[k] += s.detection.layout_votes[k];
    }
  }
  board.legacy = votes[1] > votes[0];
  log(LogLevel::info, std::string("the board has the ") + (*board.legacy ? "legacy" : "current") + " layout (" +
                          std::to_string(votes[0]) + " markers fit the current one, " + std::to_string(votes[1]) +
                          " the legacy one)");
  for (Picture& picture : session.pictures) {
    const bool other = std::ranges::any_of(
        picture.sightings, [&](const Sighting& s) { return s.board == index && s.detection.legacy != *board.legacy; });
    if (other) others.push_back(&picture);
  }
  parallel_for(0, others.size(), [&](std::size_t i) { look(*others[i], session.boards, request, document); });
}

void look_up(Session& session, Picture& picture, const CalibrationRequest& request,
             const manifest::Document& document) {
  const manifest::Camera& camera = document.cameras.at(session.cameras[picture.camera]);
  picture.width_px = camera.width_px, picture.height_px = camera.height_px;
  for (Sighting& own : picture.sightings) {
    std::vector<SeenBoard> seen;
    for (const Picture& p : session.pictures)
      for (const Sighting& s : p.sightings)
        if (!p.path.empty() && p.shot == picture.shot && s.board == own.board && !s.detection.corners.empty())
          seen.push_back({p.entry, p.camera, s.detection});
    own.detection = request.look_up(document, picture.entry, session.board_ids[own.board], seen);
  }
}

// A board of another size than stated would be a part of itself in every picture.
void drop_parts_of_what_is_never_whole(Session& session, std::size_t board) {
  std::vector<Detection*> parts;
  for (Picture& picture : session.pictures)
    for (Sighting& s : picture.sightings) {
      if (s.board != board || s.detection.corners.empty()) continue;
      if (!s.detection.part) return;
      parts.push_back(&s.detection);
    }
  for (Detection* d : parts) {
    const std::size_t corners = d->corners.size();
    *d = {};
    d->part = true;
    d->problem = "only a part of the checkerboard, " + std::to_string(corners) + " inner corners";
  }
}

void check_sizes(const manifest::Document& document, const Session& session) {
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    const std::string& id = session.cameras[c];
    const auto first = std::ranges::find(session.pictures, c, &Picture::camera);
    const auto size = [](int w, int h) { return std::to_string(w) + " x " + std::to_string(h); };
    for (const Picture& p : session.pictures) {
      if (p.camera != c || (p.width_px == first->width_px && p.height_px == first->height_px)) continue;
      throw Error(Exit::data, manifest::place(document, image_pointer(p.entry)),
                  size(p.width_px, p.height_px) + " pixels, others of camera " + id + " have " +
                      size(first->width_px, first->height_px),
                  "do not crop or scale photographs of one camera");
    }
    const auto [width_px, height_px] = picture_size_px(document, id);
    if (width_px == 0 || (width_px == first->width_px && height_px == first->height_px)) continue;
    throw Error(Exit::data, manifest::place(document, "/cameras/" + id + "/width_px"),
                "the camera's size differs from its images'", "give the size of the photographs in pixels");
  }
}

// Do two detections have the same corners at the same pixels?
bool same_corners(const Detection& a, const Detection& b) {
  if (a.corners.size() < enough_corners || a.corners.size() != b.corners.size()) return false;
  for (std::size_t i = 0; i < a.corners.size(); ++i) {
    if (a.corners[i].id != b.corners[i].id || norm(a.corners[i].pixel - b.corners[i].pixel) > same_corner_px)
      return false;
  }
  return true;
}

void check_duplicates(const manifest::Document& document, const Session& session) {
  for (std::size_t i = 0; i < session.pictures.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Picture &a = session.pictures[j], &b = session.pictures[i];
      for (std::size_t k = 0; k < std::min(a.sightings.size(), b.sightings.size()); ++k) {
        if (a.sightings[k].board != b.sightings[k].board) continue;
        if (!same_corners(a.sightings[k].detection, b.sightings[k].detection)) continue;
        throw Error(Exit::data, manifest::place(document, image_pointer(b.entry)),
                    document.images[b.entry].id + " is the same photograph as " + document.images[a.entry].id,
                    "leave one of them out; what is counted twice feigns certainty");
      }
    }
  }
}

// Twice the signed area of corners in the order of the board against that in the picture: positive as seen from the
// front. The best-fitting linear map's determinant, from the moments of both.
double orientation(const Board& board, const Detection& detection) {
  Vec2 from, to;
  const double n = static_cast<double>(detection.corners.size());
  for (const Corner& c : detection.corners) {
    from = from + board.corner_m(c.id) * (1 / n);
    to = to + c.pixel * (1 / n);
  }
  double xx = 0, xy = 0, yx = 0, yy = 0;
  for (const Corner& c : detection.corners) {
    const Vec2 p = board.corner_m(c.id) - from, q = c.pixel - to;
    xx += p.x * q.x, xy += p.x * q.y, yx += p.y * q.x, yy += p.y * q.y;
  }
  return xx * yy - xy * yx;
}

Error mirrored(const std::string& place, const std::string& picture) {
  return {Exit::data, place, picture + " is mirrored: its corners run the wrong way round",
          "flip the photographs, or turn off mirroring in the camera"};
}

void check_mirrored(const manifest::Document& document, const Session& session) {
  for (const Picture& picture : session.pictures) {
    for (const Sighting& s : picture.sightings) {
      if (s.detection.corners.size() < enough_corners) continue;
      if (orientation(session.boards[s.board], s.detection) < 0) {
        throw mirrored(manifest::place(document, image_pointer(picture.entry)), document.images[picture.entry].id);
      }
    }
  }
}

io::Image flipped(const io::Image& image) {
  io::Image result = image;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (std::size_t c = 0; c < image.channels.size(); ++c) {
        result.at(x, y, static_cast<int>(c)) = image.at(image.width - 1 - x, y, static_cast<int>(c));
      }
    }
  }
  return result;
}

void check_found(const manifest::Document& document, const Session& session) {
  for (std::size_t b = 0; b < session.boards.size(); ++b) {
    std::vector<Detection> detections;
    const Picture* first = nullptr;
    for (const Picture& picture : session.pictures) {
      for (const Sighting& s : picture.sightings) {
        if (s.board != b || picture.path.empty()) continue;
        if (first == nullptr) first = &picture;
        detections.push_back(s.detection);
      }
    }
    const auto shows = [](std::size_t corners) {
      return [corners](const Detection& d) { return d.corners.size() >= corners; };
    };
    if (first == nullptr || std::ranges::any_of(detections, shows(enough_corners))) continue;
    const io::Image image = io::read_picture(first->path);
    if (detect_board(flipped(image), session.boards[b], {}).corners.size() >= enough_corners) {
      throw mirrored(manifest::place(document, image_pointer(first->entry)), document.images[first->entry].id);
    }
    if (std::ranges::any_of(detections, shows(1))) continue;
    throw no_board_found(session.boards[b], image, detections,
                         manifest::place(document, "/boards/" + session.board_ids[b]));
  }
}

void check_looked_up(const manifest::Document& document, const Session& session) {
  const Picture* first = nullptr;
  for (const Picture& picture : session.pictures) {
    if (!picture.path.empty()) continue;
    if (first == nullptr) first = &picture;
    for (const Sighting& s : picture.sightings)
      if (s.detection.corners.size() >= enough_corners) return;
  }
  if (first == nullptr) return;
  throw Error(Exit::data, manifest::place(document, image_pointer(first->entry)),
              document.images[first->entry].id +
                  " has no corners, nor has any other view of it: " + first->sightings.front().detection.problem,
              "light the boards by the projector, expose so that white is not saturated, and focus it");
}

}  // namespace

std::string image_pointer(std::size_t index) {
  return "/images/" + std::to_string(index);
}

std::vector<Session> sessions_of(const manifest::Document& document, bool projector) {
  if (document.images.empty()) {
    throw Error(Exit::data, manifest::place(document, "/images"), "empty", "name photographs of the board");
  }
  std::vector<Session> list;
  std::map<std::string, std::size_t> session_of;
  std::map<std::string, std::size_t> shots;
  std::map<std::pair<std::string, std::string>, std::size_t> taken;  // camera and shot
  const std::map<std::string, std::string> leader = leaders(document);
  for (const auto& [camera, own] : leader) {
    if (session_of.emplace(own, list.size()).second) list.emplace_back();
  }
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const manifest::ImageEntry& image = document.images[i];
    if (!shows_board(document, image)) continue;
    if (image.file.empty() && !projector) {
      throw Error(Exit::data, manifest::place(document, image_pointer(i) + "/file"), "missing", "name the photograph");
    }
    const std::string camera = camera_id_of(document, i);
    if (!image.shot.empty() && !taken.emplace(std::pair{camera, image.shot}, i).second) {
      throw Error(Exit::data, manifest::place(document, image_pointer(i) + "/shot"),
                  "camera " + camera + " has another image of shot " + image.shot, "give every moment its own name");
    }
    Session& session = list[session_of.at(leader.at(camera))];
    Picture picture{i, image.file.empty() ? "" : manifest::picture_path(document, i), 0, 0, 0, 0, {}};
    picture.camera = entered(session.cameras, camera);
    picture.shot =
        image.shot.empty() ? document.images.size() + i : shots.emplace(image.shot, shots.size()).first->second;
    enter_sightings(document, i, session, picture);
    picture.by_itself = image.shot.empty() && !image.base_from_tool && image.joints_rad.empty();
    session.pictures.push_back(std::move(picture));
  }
  if (list.empty())
    throw Error(Exit::data, manifest::place(document, "/images"), "show no board without a pattern on it",
                "name the board in those that do, or calibrate the projector as well (--projector)");
  return list;
}

void look_at_all(Session& session, const CalibrationRequest& request, const manifest::Document& document) {
  {
    Progress progress("corners", session.pictures.size());
    parallel_for(0, session.pictures.size(), [&](std::size_t i) {
      look(session.pictures[i], session.boards, request, document);
      progress.advance();
    });
  }
  for (std::size_t b = 0; b < session.boards.size(); ++b) {
    settle_layout(session, b, request, document);
    if (session.boards[b].kind == BoardKind::checkerboard) drop_parts_of_what_is_never_whole(session, b);
  }
  for (Picture& picture : session.pictures)
    if (picture.path.empty()) look_up(session, picture, request, document);
}

void check_pictures(const manifest::Document& document, const Session& session) {
  check_sizes(document, session);
  check_found(document, session);
  check_looked_up(document, session);
  check_mirrored(document, session);
  check_duplicates(document, session);
}

double noise_of(const Session& session, const Picture& picture, const Sighting& sighting) {
  if (sighting.detection.noise_px > 0) return std::max(least_noise_px, sighting.detection.noise_px);
  std::vector<double> known;
  for (const Picture& p : session.pictures) {
    for (const Sighting& s : p.sightings) {
      if (p.camera == picture.camera && s.detection.noise_px > 0) known.push_back(s.detection.noise_px);
    }
  }
  if (known.empty()) return usual_noise_px;
  std::ranges::sort(known);
  return std::max(least_noise_px, known[known.size() / 2]);
}

std::vector<View> views_of(const manifest::Document& document, Session& session) {
  std::vector<View> views;
  for (Picture& picture : session.pictures) {
    for (Sighting& s : picture.sightings) {
      s.view = views.size();
      views.push_back({document.images[picture.entry].id, s.detection.corners, s.detection.noise_px, picture.camera,
                       s.board, picture.shot});
    }
  }
  return views;
}

}  // namespace gonio::camera
