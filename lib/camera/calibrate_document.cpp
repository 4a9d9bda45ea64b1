// From the manifest's images to its cameras.
#include "camera/calibrate_document.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include "base/parallel.h"
#include "base/progress.h"
#include "camera/corner_table.h"
#include "camera/detection_failure.h"
#include "io/grey.h"
#include "io/picture.h"

namespace gonio::camera {
namespace {

constexpr double usual_noise_px = 0.1;  // where too few corners allow no estimate
constexpr double least_noise_px = 0.01;

struct Shot {
  std::size_t entry = 0;  // place in document.images
  std::filesystem::path path;
  int width_px = 0, height_px = 0;
  Detection detection;
};

struct Session {  // the images of one camera
  std::string camera, board_id;
  Board board;
  std::vector<Shot> shots;
};

std::string image_pointer(std::size_t index) {
  return "/images/" + std::to_string(index);
}

std::string board_id_of(const manifest::Document& document, std::size_t index) {
  const std::string& given = document.images[index].board;
  if (!given.empty()) return given;
  if (document.boards.size() == 1) return document.boards.begin()->first;
  throw Error(Exit::data, manifest::place(document, image_pointer(index) + "/board"), "missing",
              "say which of the boards the image shows");
}

std::string camera_id_of(const manifest::Document& document, std::size_t index) {
  const std::string& given = document.images[index].camera;
  if (!given.empty()) return given;
  if (document.cameras.size() == 1) return document.cameras.begin()->first;
  if (document.cameras.empty()) return "camera";
  throw Error(Exit::data, manifest::place(document, image_pointer(index) + "/camera"), "missing",
              "say which of the cameras took the image");
}

std::vector<Session> sessions_of(const manifest::Document& document) {
  if (document.images.empty()) {
    throw Error(Exit::data, manifest::place(document, "/images"), "empty", "name photographs of the board");
  }
  std::map<std::string, Session> sessions;
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    if (document.images[i].file.empty()) {
      throw Error(Exit::data, manifest::place(document, image_pointer(i) + "/file"), "missing", "name the photograph");
    }
    const std::string camera = camera_id_of(document, i), board = board_id_of(document, i);
    Session& session = sessions[camera];
    if (session.shots.empty()) {
      const auto found = document.boards.find(board);
      const std::string place = manifest::place(document, "/boards/" + board);
      if (found == document.boards.end()) throw Error(Exit::data, place, "missing", "describe the board");
      session.camera = camera;
      session.board_id = board;
      session.board = board_of(found->second, place);
    } else if (session.board_id != board) {
      throw Error(Exit::data, manifest::place(document, image_pointer(i) + "/board"),
                  "camera " + camera + " sees two boards, " + session.board_id + " and " + board,
                  "calibrate with one board at a time");
    }
    session.shots.push_back(
        {i, manifest::resolve(document, document.images[i].file, image_pointer(i) + "/file"), 0, 0, {}});
  }
  std::vector<Session> list;
  for (auto& entry : sessions) list.push_back(std::move(entry.second));
  return list;
}

void look(Shot& shot, const Board& board, const DetectionOptions& options) {
  const io::GreyImage image = io::read_grey(shot.path);
  shot.width_px = image.width;
  shot.height_px = image.height;
  shot.detection = detect_board(image, board, options);
}

// All pictures, then once more those that took another layout than the majority of all markers.
void look_at_all(Session& session, const DetectionOptions& options) {
  {
    Progress progress("corners", session.shots.size());
    parallel_for(0, session.shots.size(), [&](std::size_t i) {
      look(session.shots[i], session.board, options);
      progress.advance();
    });
  }
  if (!session.board.layout_matters() || session.board.legacy) return;
  std::array<int, 2> votes{};
  for (const Shot& shot : session.shots) {
    for (std::size_t k = 0; k < 2; ++k) votes[k] += shot.detection.layout_votes[k];
  }
  session.board.legacy = votes[1] > votes[0];
  log(LogLevel::info, std::string("the board has the ") + (*session.board.legacy ? "legacy" : "current") + " layout (" +
                          std::to_string(votes[0]) + " markers fit the current one, " + std::to_string(votes[1]) +
                          " the legacy one)");
  parallel_for(0, session.shots.size(), [&](std::size_t i) {
    if (session.shots[i].detection.legacy != *session.board.legacy) look(session.shots[i], session.board, options);
  });
}

void check_sizes(const manifest::Document& document, const Session& session) {
  const Shot& first = session.shots.front();
  for (const Shot& shot : session.shots) {
    if (shot.width_px == first.width_px && shot.height_px == first.height_px) continue;
    throw Error(Exit::data, manifest::place(document, image_pointer(shot.entry)),
                std::to_string(shot.width_px) + " x " + std::to_string(shot.height_px) + " pixels, others of camera " +
                    session.camera + " have " + std::to_string(first.width_px) + " x " +
                    std::to_string(first.height_px),
                "do not crop or scale photographs of one camera");
  }
  const auto known = document.cameras.find(session.camera);
  if (known == document.cameras.end() || known->second.width_px == 0) return;
  if (known->second.width_px == first.width_px && known->second.height_px == first.height_px) return;
  throw Error(Exit::data, manifest::place(document, "/cameras/" + session.camera + "/width_px"),
              "the camera's size differs from its images'", "give the size of the photographs in pixels");
}

// Noise of one coordinate in a picture, estimated without a lens model; the pictures' median where there were too few
// corners.
std::vector<double> noise_of(const Session& session) {
  std::vector<double> known;
  for (const Shot& shot : session.shots) {
    if (shot.detection.noise_px > 0) known.push_back(shot.detection.noise_px);
  }
  std::ranges::sort(known);
  const double usual = known.empty() ? usual_noise_px : known[known.size() / 2];
  std::vector<double> noise;
  for (const Shot& shot : session.shots) {
    noise.push_back(std::max(least_noise_px, shot.detection.noise_px > 0 ? shot.detection.noise_px : usual));
  }
  return noise;
}

manifest::Value covariance_of(const Calibration& calibration) {
  if (calibration.covariance.empty()) return {};
  const std::size_t n = calibration.order.size();
  manifest::Value order = manifest::Value::array(), values = manifest::Value::array();
  for (std::size_t i = 0; i < n; ++i) {
    order.push_back(calibration.order[i]);
    manifest::Value row = manifest::Value::array();
    for (std::size_t j = 0; j < n; ++j) row.push_back(calibration.covariance[i * n + j]);
    values.push_back(row);
  }
  return manifest::Value::object({{"order", order}, {"values", values}});
}

void store_camera(const Session& session, const std::string& model, const Calibration& calibration,
                  manifest::Document& document) {
  manifest::Camera& camera = document.cameras[session.camera];
  camera.model = model;
  camera.width_px = session.shots.front().width_px;
  camera.height_px = session.shots.front().height_px;
  store(calibration.lens, camera);
  camera.rms_px = calibration.rms_px;
  camera.covariance = covariance_of(calibration);
  camera.sigma.clear();
  for (const std::string& name : calibration.order) {
    const auto sigma = calibration.sigma(name);
    if (sigma && !name.starts_with("sag_")) camera.sigma[name] = {*sigma};
  }
}

void store_board(const Session& session, bool warped, const Calibration& calibration, manifest::Document& document) {
  manifest::Board& board = document.boards[session.board_id];
  if (session.board.layout_matters()) board.legacy_layout = session.board.legacy;
  if (!warped) return;
  board.warp = {{"x_m", calibration.warp.sag_x_m}, {"y_m", calibration.warp.sag_y_m}};
  board.sigma.clear();
  if (const auto s = calibration.sigma("sag_x_m")) board.sigma["x_m"] = {*s};
  if (const auto s = calibration.sigma("sag_y_m")) board.sigma["y_m"] = {*s};
}

void store_views(const Session& session, const Calibration& calibration, manifest::Document& document) {
  for (std::size_t i = 0; i < session.shots.size(); ++i) {
    manifest::ImageEntry& entry = document.images[session.shots[i].entry];
    const CalibratedView& view = calibration.views[i];
    entry.camera = session.camera;
    entry.board = session.board_id;
    entry.weight = view.weight;
    entry.camera_from_board.reset();
    entry.rms_px.reset();
    if (session.shots[i].detection.corners.empty() || view.rms_px == 0) continue;
    entry.rms_px = view.rms_px;
    manifest::Pose<frame::Camera, frame::Board> pose;
    static_cast<BoardPose&>(pose) = view.camera_from_board;
    const auto& s = view.sigma;
    if (view.weight > 0 && !calibration.covariance.empty()) {
      pose.sigma = manifest::PoseSigma{{s[0], s[1], s[2]}, {s[3], s[4], s[5]}};
    }
    entry.camera_from_board = pose;
  }
}

void store_corners(const Session& session, const std::string& name, const std::filesystem::path& csv,
                   manifest::Document& document) {
  CornerTable table{session.camera, session.board_id, {}};
  const std::vector<double> noise = noise_of(session);
  for (std::size_t i = 0; i < session.shots.size(); ++i) {
    ImageCorners group{document.images[session.shots[i].entry].id, {}};
    for (const Corner& corner : session.shots[i].detection.corners) {
      group.corners.push_back({corner.id, session.board.corner_m(corner.id), corner.pixel, noise[i]});
    }
    if (!group.corners.empty()) table.images.push_back(std::move(group));
  }
  write_corners(table, name, csv, document);
}

void tell(const Session& session, const Calibration& calibration, const manifest::Document& document) {
  for (std::size_t i = 0; i < session.shots.size(); ++i) {
    const Detection& detection = session.shots[i].detection;
    const std::string& id = document.images[session.shots[i].entry].id;
    const std::string& note = detection.problem.empty() ? calibration.views[i].note : detection.problem;
    if (!note.empty()) log(LogLevel::warning, id + ": " + note);
    if (detection.gross_errors > 0) {
      log(LogLevel::warning,
          id + ": " + std::to_string(detection.gross_errors) + " corners left out that do not fit their neighbours");
    }
  }
  char text[200];
  std::snprintf(
      text, sizeof text, "camera %s: rms %.3f px over %d corners of %zu views, noise %.3f px", session.camera.c_str(),
      calibration.rms_px, calibration.corners,
      static_cast<std::size_t>(std::ranges::count_if(calibration.views, [](const auto& v) { return v.weight > 0; })),
      calibration.noise_px);
  log(LogLevel::info, text);
  if (calibration.set_aside > 0) {
    log(LogLevel::warning,
        std::to_string(calibration.set_aside) + " corners lie beyond six sigmas and do not count in the rms");
  }
}

CalibrationOptions options_for(const Session& session, const CalibrationRequest& request,
                               const manifest::Document& document) {
  CalibrationOptions options = request.calibration;
  const manifest::Parameters& warp = document.boards.at(session.board_id).warp;
  if (warp.contains("x_m")) options.warp.sag_x_m = warp.at("x_m").scalar();
  if (warp.contains("y_m")) options.warp.sag_y_m = warp.at("y_m").scalar();
  const auto known = document.cameras.find(session.camera);
  if (known == document.cameras.end()) return options;
  const std::string place = manifest::place(document, "/cameras/" + session.camera);
  if (!request.model_given) options.model = known->second.model;
  if (!camera_model_info(options.model, place).perspective) {
    throw Error(Exit::data, place + "/model", "\"" + options.model + "\" cannot be calibrated from a board",
                "use pinhole, radial-tangential, rational, thin-prism or fisheye");
  }
  if (known->second.fx_px.given() && !options.fixed.empty()) {
    const CameraModelInfo& model = camera_model_info(options.model, place);
    Intrinsics lens = intrinsics_of(known->second, place);
    for (std::size_t i = 0; i < LensTerm::fisheye; ++i) {  // terms that the new model lacks are cut off
      if (!model.terms.has(i)) lens.distortion[i] = 0;
    }
    if (options.model != known->second.model) lens.distortion[LensTerm::fisheye] = model.fisheye;
    options.start = lens;
  }
  return options;
}

}  // namespace

void enter_board(const Board& board, manifest::Document& document) {
  document.boards["board"] = section_of(board);
}

void enter_pictures(const std::vector<std::string>& paths, const std::string& model, manifest::Document& document) {
  if (document.cameras.empty()) document.cameras["camera"].model = model;
  const std::string camera = document.cameras.size() == 1 ? document.cameras.begin()->first : "camera";
  for (const std::string& path : paths) {
    if (std::error_code error; !std::filesystem::is_regular_file(path, error)) {
      throw Error(Exit::no_input, path, error ? error.message() : "not a file", "name photographs of the board");
    }
    const std::string stem = std::filesystem::path(path).stem().string();
    std::string id = stem;
    for (int k = 2; std::ranges::find(document.images, id, &manifest::ImageEntry::id) != document.images.end(); ++k) {
      id = stem + "-" + std::to_string(k);
    }
    manifest::ImageEntry entry;
    entry.id = id;
    entry.file = manifest::add_file(document, path, id);
    entry.camera = camera;
    if (document.boards.size() == 1) entry.board = document.boards.begin()->first;
    document.images.push_back(entry);
  }
}

void check_calibration(const manifest::Document& document) {
  sessions_of(document);
}

Exit calibrate_document(manifest::Document& document, const CalibrationRequest& request) {
  Exit worst = Exit::done;
  std::vector<Session> sessions = sessions_of(document);
  for (Session& session : sessions) {
    const CalibrationOptions options = options_for(session, request, document);
    look_at_all(session, request.detection);
    for (const Shot& shot : session.shots) {
      if (request.note_input) request.note_input(shot.path);
    }
    check_sizes(document, session);
    std::vector<View> views;
    std::vector<Detection> detections;
    for (const Shot& shot : session.shots) {
      views.push_back({document.images[shot.entry].id, shot.detection.corners});
      detections.push_back(shot.detection);
    }
    if (std::ranges::all_of(views, [](const View& view) { return view.corners.empty(); })) {
      throw no_board_found(session.board, io::read_picture(session.shots.front().path), detections,
                           manifest::place(document, "/boards/" + session.board_id));
    }
    Calibration calibration =
        calibrate(views, session.board, session.shots.front().width_px, session.shots.front().height_px, options);
    if (const std::string doubt = board_doubt(session.board, detections); !doubt.empty()) {
      calibration.complaints.push_back(doubt);
    }
    tell(session, calibration, document);
    store_camera(session, options.model, calibration, document);
    store_board(session, options.board_warp, calibration, document);
    store_views(session, calibration, document);
    const std::string table = sessions.size() == 1 ? "corners" : "corners-" + session.camera;
    std::filesystem::path csv = request.corners_csv;
    if (!csv.empty() && sessions.size() > 1) csv.replace_filename(table + ".csv");
    store_corners(session, table, csv, document);
    for (const std::string& complaint : calibration.complaints) {
      log(LogLevel::error, "camera " + session.camera + ": " + complaint);
      worst = Exit::quality;
    }
  }
  return worst;
}

}  // namespace gonio::camera
