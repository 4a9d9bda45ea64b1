// From the manifest's images to its cameras.
#include "camera/calibrate_document.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/progress.h"
#include "base/text.h"
#include "camera/calibrate_document_session.h"
#include "camera/detection_failure.h"
#include "camera/model_choice.h"
#include "camera/moved_corners.h"
#include "camera/picture_names.h"
#include "camera/quality/quality.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"

namespace gonio::camera {
namespace {

constexpr std::size_t most_named = 5;  // corners and views that a message lists
constexpr double worth_telling = 2;    // variance between shots over the noise of corners

// What the manifest knows of a camera, as a start and for what is held.
CameraSetup camera_setup(const Session& session, std::size_t index, const CalibrationRequest& request,
                         const manifest::Document& document) {
  const std::string& id = session.cameras[index];
  const auto picture = std::ranges::find(session.pictures, index, &Picture::camera);
  CameraSetup setup{id, picture->width_px, picture->height_px, request.model, request.fixed, {}};
  const auto known = document.cameras.find(id);
  const std::string place = manifest::place(document, "/cameras/" + id);
  if (known == document.cameras.end() || !known->second.fx_px.given()) {
    if (request.fixed.contains("intrinsics")) {
      throw Error(Exit::data, place + "/fx_px", "missing", "hold intrinsics that the manifest gives");
    }
  }
  if (known == document.cameras.end()) return setup;
  if (!request.model_given || request.fixed.contains("intrinsics")) setup.model = known->second.model;
  const CameraModelInfo& model = camera_model_info(setup.model, place);
  if (!model.perspective) {
    throw Error(Exit::data, place + "/model", "\"" + setup.model + "\" cannot be calibrated from a board",
                "use pinhole, radial-tangential, rational, thin-prism or fisheye");
  }
  if (!known->second.fx_px.given() || setup.fixed.empty()) return setup;
  Intrinsics lens = intrinsics_of(known->second, place);
  for (std::size_t i = 0; i < LensTerm::fisheye; ++i) {  // terms that the new model lacks are cut off
    if (!model.terms.has(i)) lens.distortion[i] = 0;
  }
  if (setup.model != known->second.model) lens.distortion[LensTerm::fisheye] = model.fisheye;
  setup.start = lens;
  return setup;
}

CalibrationSetup setup_for(const Session& session, const CalibrationRequest& request,
                           const manifest::Document& document) {
  CalibrationSetup setup;
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    setup.cameras.push_back(camera_setup(session, c, request, document));
  }
  for (std::size_t b = 0; b < session.boards.size(); ++b) {
    BoardSetup board{session.board_ids[b], session.boards[b], request.board_warp, {}};
    const manifest::Parameters& warp = document.boards.at(session.board_ids[b]).warp;
    if (warp.contains("x_m")) board.warp.sag_x_m = warp.at("x_m").scalar();
    if (warp.contains("y_m")) board.warp.sag_y_m = warp.at("y_m").scalar();
    setup.boards.push_back(board);
  }
  return setup;
}

// Models are names for what the request leaves open; "auto" is settled before the setup is made.
void check_models(const Session& session, const CalibrationRequest& request, const manifest::Document& document) {
  CalibrationRequest checked = request;
  if (checked.model == "auto") checked.model = "radial-tangential";
  Session sized = session;
  for (std::size_t c = 0; c < sized.cameras.size(); ++c) camera_setup(sized, c, checked, document);
}

// A term that moves corners and that this fit does not have would end in the lens, or in the board's poses.
void refuse_mechanisms(const manifest::Document& document) {
  for (const auto& [id, use] : document.mechanisms)
    if (moves_corners(id, use))
      throw Error(Exit::data, manifest::place(document, "/mechanisms/" + id),
                  "moves the corners of boards and is no part of this fit",
                  "explain(1) fits corners with it; or take it out of the manifest");
}

void tell_views(const Session& session, const Calibration& calibration, const manifest::Document& document) {
  for (const Picture& picture : session.pictures) {
    for (const Sighting& s : picture.sightings) {
      const CalibratedView& view = calibration.views[s.view];
      const std::string id = document.images[picture.entry].id + ": ";
      const std::string& note = s.detection.problem.empty() ? view.note : s.detection.problem;
      if (!note.empty()) log(LogLevel::warning, id + note);
      if (s.detection.part && !s.detection.corners.empty())
        log(LogLevel::info, id + std::to_string(s.detection.corners.size()) +
                                " corners of a part of the board; which part is told by its colours and the picture's "
                                "border alone");
      if (s.detection.gross_errors > 0) {
        log(LogLevel::warning,
            id + std::to_string(s.detection.gross_errors) + " corners left out that do not fit their neighbours");
      }
      // The same limit as for the root mean square: twice the loss's, six sigmas.
      std::string list;
      std::size_t count = 0;
      for (std::size_t k = 0; k < view.corner_weights.size(); ++k) {
        if (view.weight == 0 || view.corner_weights[k] > 0.5) continue;
        if (++count > most_named) continue;
        list += format("%s%d (%.1f px)", count > 1 ? ", " : "", s.detection.corners[k].id, norm(view.residuals[k]));
      }
      if (count > most_named) list += ", and " + std::to_string(count - most_named) + " more";
      if (count > 0) log(LogLevel::warning, id + "outlying corners " + list);
    }
  }
}

void tell(const Session& session, const Calibration& calibration, const manifest::Document& document) {
  tell_views(session, calibration, document);
  if (calibration.excess > worth_telling) {
    log(LogLevel::info,
        format("shots scatter by %.1f times what the corners' noise explains; standard deviations are widened by it",
               std::sqrt(calibration.excess)));
  }
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    const CalibratedCamera& camera = calibration.cameras[c];
    std::size_t used = 0;
    for (const Picture& picture : session.pictures) {
      for (const Sighting& s : picture.sightings) {
        used += picture.camera == c && calibration.views[s.view].weight > 0;
      }
    }
    log(LogLevel::info, format("camera %s: rms %.3f px over %d corners of %zu views, noise %.3f px",
                               session.cameras[c].c_str(), camera.rms_px, camera.corners, used, camera.noise_px));
    if (camera.focal_doubt > 0) {
      log(LogLevel::info, format("camera %s: focal length to %.2f %% (noise, and a sag of a thousandth of the board)",
                                 session.cameras[c].c_str(), 100 * camera.focal_doubt));
    }
    if (camera.set_aside > 0) {
      log(LogLevel::warning, "camera " + session.cameras[c] + ": " + std::to_string(camera.set_aside) +
                                 " corners lie beyond six sigmas and do not count in the rms");
    }
    if (!camera.tied) continue;
    log(LogLevel::info, format("camera %s stands %.2f mm (sigma %.2f mm) from %s", session.cameras[c].c_str(),
                               1e3 * norm(camera.rig_from_camera.translation_m),
                               1e3 * std::hypot(camera.rig_sigma[3], camera.rig_sigma[4], camera.rig_sigma[5]),
                               session.cameras[0].c_str()));
  }
  for (const std::string& line : calibration.advice) log(LogLevel::info, line);
  for (std::size_t b = 0; b < session.boards.size(); ++b) {
    const CalibratedBoard& board = calibration.boards[b];
    if (!board.flatness_m) continue;
    log(LogLevel::info, format("board %s: %.3f mm from valley to peak (sigma %.3f mm)", session.board_ids[b].c_str(),
                               1e3 * *board.flatness_m, 1e3 * board.flatness_sigma_m.value_or(0)));
  }
}

void add_doubts(const Session& session, Calibration& calibration) {
  for (std::size_t b = 0; b < session.boards.size(); ++b) {
    std::vector<Detection> detections;
    for (const Picture& picture : session.pictures) {
      for (const Sighting& s : picture.sightings) {
        if (s.board == b) detections.push_back(s.detection);
      }
    }
    const std::string doubt = board_doubt(session.boards[b], detections);
    if (!doubt.empty()) calibration.complaints.push_back(doubt);
  }
}

void enter_picture(const std::string& path, const std::string& camera, const std::string& id, const std::string& shot,
                   manifest::Document& document) {
  if (std::error_code error; !std::filesystem::is_regular_file(path, error)) {
    throw Error(Exit::no_input, path, error ? error.message() : "not a file", "name photographs of the board");
  }
  manifest::ImageEntry entry;
  entry.id = id;
  for (int k = 2; manifest::index_of_image(document, entry.id); ++k) entry.id = id + "-" + std::to_string(k);
  entry.file = manifest::add_file(document, path, entry.id);
  entry.camera = camera;
  entry.shot = shot;
  if (document.boards.size() == 1) entry.board = document.boards.begin()->first;
  document.images.push_back(entry);
}

}  // namespace

void enter_board(const Board& board, manifest::Document& document) {
  manifest::Board section = section_of(board);
  if (board.own_dictionary) {
    section.dictionary_file = manifest::add_file(document, board.own_dictionary->file, "dictionary");
  }
  document.boards["board"] = section;
}

void enter_pictures(const std::vector<std::string>& paths, const std::string& model, manifest::Document& document) {
  if (document.cameras.empty()) document.cameras["camera"].model = model;
  const std::string camera = document.cameras.size() == 1 ? document.cameras.begin()->first : "camera";
  for (const std::string& path : paths) {
    enter_picture(path, camera, std::filesystem::path(path).stem().string(), "", document);
  }
}

void enter_rig(const std::vector<std::string>& cameras, const std::vector<std::string>& paths, const std::string& model,
               manifest::Document& document) {
  std::map<std::string, std::map<std::string, std::string>> shots;  // shot -> camera -> path
  for (const std::string& camera : cameras) {
    if (const auto [known, fresh] = document.cameras.try_emplace(camera); fresh) known->second.model = model;
  }
  for (const std::string& path : paths) {
    const std::filesystem::path whole(path);
    std::string shot = whole.stem().string();
    const std::string in_name = camera_in_name(shot, cameras), camera = camera_of_picture(whole, cameras);
    if (!in_name.empty()) shot.erase(shot.find(in_name), in_name.size());
    if (camera.empty()) {
      throw Error(Exit::usage, path, "is the picture of none, or of several, of the cameras that --rig names",
                  "name pictures after their camera, left01.jpg or left/01.jpg, or write a manifest with images");
    }
    if (const auto [place, fresh] = shots[shot].emplace(camera, path); !fresh) {
      throw Error(Exit::usage, path, "is taken by " + camera + " at the same shot as " + place->second,
                  "number the pictures of a camera, the same number for the same moment");
    }
    enter_picture(path, camera, camera + "-" + (shot.empty() ? "picture" : shot), shot, document);
  }
  for (const std::string& camera : cameras) {
    const bool shares = std::ranges::any_of(
        shots, [&](const auto& shot) { return shot.second.contains(camera) && shot.second.size() > 1; });
    if (shares) continue;
    throw Error(Exit::usage, "--rig", camera + " shares no shot with another camera",
                "name pictures of the same moment alike, as left01.jpg and right01.jpg");
  }
}

void check_calibration(const manifest::Document& document, bool projector) {
  refuse_mechanisms(document);
  sessions_of(document, projector);
}

namespace {

// How well every camera predicts: into the document, files and a sentence each.
void judge_cameras(const std::vector<View>& views, const CalibrationSetup& setup, Calibration& calibration,
                   const CalibrationRequest& request, manifest::Document& document) {
  for (std::size_t c = 0; c < setup.cameras.size(); ++c) {
    const CameraResult camera{views, setup, calibration, c};
    const std::optional<Quality> quality = judge_quality(camera, request.distances_m);
    if (!quality) continue;
    const std::string& name = setup.cameras[c].name;
    document.cameras.at(name).quality = section_of(*quality);
    if (request.report) request.report(camera, *quality, document.cameras.size() == 1 ? "" : "-" + name, document);
    log(LogLevel::info, "camera " + name + ": " + quality->verdict);
    if (quality->halves.refused.empty() && !quality->halves.agree)
      calibration.complaints.push_back((setup.cameras.size() == 1 ? "" : name + ": ") + disagreement(quality->halves));
  }
}

}  // namespace

Exit calibrate_document(manifest::Document& document, const CalibrationRequest& request) {
  Exit worst = Exit::done;
  std::vector<Session> sessions = sessions_of(document, request.look_up != nullptr);
  for (Session& session : sessions) {
    check_models(session, request, document);
    look_at_all(session, request, document);
    for (const Picture& picture : session.pictures) {
      if (request.note_input && !picture.path.empty()) request.note_input(picture.path);
    }
    check_pictures(document, session);
    const std::vector<View> views = views_of(document, session);
    CalibrationRequest settled = request;
    if (request.model == "auto") settled.model = "radial-tangential";
    CalibrationSetup setup = setup_for(session, settled, document);
    if (request.model == "auto") choose_model(views, setup);
    Calibration calibration = calibrate(views, setup);
    add_doubts(session, calibration);
    tell(session, calibration, document);
    store_calibration(session, setup, calibration, document);
    store_corners(session, calibration, sessions.size() == 1, request.corners_csv, document);
    if (request.judge) judge_cameras(views, setup, calibration, request, document);
    for (const std::string& complaint : calibration.complaints) {
      log(LogLevel::error,
          (session.cameras.size() == 1 ? "camera " + session.cameras[0] + ": " : std::string("rig: ")) + complaint);
      worst = Exit::quality;
    }
  }
  return worst;
}

}  // namespace gonio::camera
