// What a calibration says, into the manifest.
#include <algorithm>
#include <cmath>

#include "camera/board_place.h"
#include "camera/calibrate_document_session.h"
#include "camera/corner_table.h"
#include "manifest/document.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/rig.h"

namespace gonio::camera {
namespace {

using Kind = SharedParameter::Kind;

template <class To, class From>
manifest::Pose<To, From> pose_with_sigma(const Rigid<To, From>& pose, const std::array<double, 6>& s, bool known) {
  manifest::Pose<To, From> written;
  static_cast<Rigid<To, From>&>(written) = pose;
  if (known) written.sigma = manifest::PoseSigma{{s[0], s[1], s[2]}, {s[3], s[4], s[5]}};
  return written;
}

// The camera's own block of the covariance, with the sags of boards that it was fitted with.
manifest::Value covariance_of(const Calibration& calibration, std::size_t camera) {
  if (calibration.covariance.empty()) return {};
  std::vector<std::size_t> places = calibration.lens_parameters(camera);
  if (places.empty()) return {};
  for (std::size_t i = 0; i < calibration.shared.size() && calibration.boards.size() == 1; ++i) {
    if (calibration.shared[i].kind == Kind::board) places.push_back(i);
  }
  manifest::Value order = manifest::Value::array(), values = manifest::Value::array();
  for (const std::size_t i : places) {
    order.push_back(calibration.shared[i].name);
    manifest::Value row = manifest::Value::array();
    for (const std::size_t j : places) row.push_back(calibration.covariance[i * calibration.shared.size() + j]);
    values.push_back(row);
  }
  return manifest::Value::object({{"order", order}, {"values", values}});
}

// Has none of this camera's pictures been calibrated before? Then its numbers come from others.
bool are_fresh(const Session& session, std::size_t camera, const manifest::Document& document) {
  return std::ranges::none_of(session.pictures, [&](const Picture& picture) {
    return picture.camera == camera && document.images[picture.entry].camera_from_board;
  });
}

void store_camera(const Session& session, const CameraSetup& setup, std::size_t index, const Calibration& calibration,
                  manifest::Document& document) {
  manifest::Camera& camera = document.cameras[session.cameras[index]];
  const CalibratedCamera& found = calibration.cameras[index];
  camera.rms_px = found.rms_px;
  if (setup.fixed.contains("intrinsics")) {  // with all that is known about them
    if (are_fresh(session, index, document)) camera.held = true;
    return;
  }
  camera.held.reset();
  camera.model = setup.model;
  camera.width_px = setup.width_px;
  camera.height_px = setup.height_px;
  store(found.lens, camera);
  camera.covariance = covariance_of(calibration, index);
  camera.sigma.clear();
  for (const std::size_t i : calibration.lens_parameters(index)) {
    const std::string& name = calibration.shared[i].name;
    if (const auto sigma = calibration.sigma(name, index)) camera.sigma[name] = {*sigma};
  }
}

void store_board(const Session& session, std::size_t index, bool warped, const Calibration& calibration,
                 manifest::Document& document) {
  manifest::Board& board = document.boards[session.board_ids[index]];
  if (session.boards[index].layout_matters()) board.legacy_layout = session.boards[index].legacy;
  if (!warped) return;
  const CalibratedBoard& found = calibration.boards[index];
  board.warp = {{"x_m", found.warp.sag_x_m}, {"y_m", found.warp.sag_y_m}};
  board.flatness_m = found.flatness_m;
  board.sigma.clear();
  if (const auto s = calibration.sigma("sag_x_m", index)) board.sigma["x_m"] = {*s};
  if (const auto s = calibration.sigma("sag_y_m", index)) board.sigma["y_m"] = {*s};
  if (found.flatness_sigma_m) board.sigma["flatness_m"] = {*found.flatness_sigma_m};
}

void store_picture(const Session& session, const Picture& picture, const Calibration& calibration,
                   manifest::Document& document) {
  manifest::ImageEntry& entry = document.images[picture.entry];
  entry.camera = session.cameras[picture.camera];
  const bool several = !entry.boards.empty();
  for (std::size_t k = 0; k < picture.sightings.size(); ++k) {
    const CalibratedView& view = calibration.views[picture.sightings[k].view];
    const bool seen = !picture.sightings[k].detection.corners.empty() && view.rms_px > 0;
    manifest::SeenBoard said{session.board_ids[picture.sightings[k].board], {}, {}, view.weight};
    if (seen) {
      said.rms_px = view.rms_px;
      said.camera_from_board =
          pose_with_sigma(view.camera_from_board, view.sigma, view.weight > 0 && !calibration.covariance.empty());
    }
    if (several) {
      entry.boards[k] = said;
      continue;
    }
    entry.board = said.board;
    entry.weight = said.weight;
    entry.camera_from_board = said.camera_from_board;
    entry.rms_px = said.rms_px;
  }
}

// The rig of these cameras that the manifest knows, else a new one.
void store_rig(const Session& session, const Calibration& calibration, manifest::Document& document) {
  if (session.cameras.size() < 2) return;
  std::string id = document.rigs.empty() ? "rig" : "rig-" + session.cameras.front();
  for (const auto& [name, rig] : document.rigs) {
    if (std::ranges::any_of(rig.cameras, [&](const auto& m) { return m.camera == session.cameras.front(); })) id = name;
  }
  manifest::Rig& rig = document.rigs[id];
  rig.cameras.clear();
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    const CalibratedCamera& camera = calibration.cameras[c];
    rig.cameras.push_back({session.cameras[c], pose_with_sigma(camera.rig_from_camera, camera.rig_sigma,
                                                               camera.tied && !calibration.covariance.empty())});
  }
  rig.rms_px = calibration.rms_px;
}

}  // namespace

void store_calibration(const Session& session, const CalibrationSetup& setup, const Calibration& calibration,
                       manifest::Document& document) {
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    store_camera(session, setup.cameras[c], c, calibration, document);
  }
  for (std::size_t b = 0; b < session.boards.size(); ++b) {
    store_board(session, b, setup.boards[b].free_warp, calibration, document);
  }
  for (const Picture& picture : session.pictures) store_picture(session, picture, calibration, document);
  store_rig(session, calibration, document);
  place_images(document, "calib-charuco");
}

void store_corners(const Session& session, const Calibration& calibration, bool alone, const std::filesystem::path& csv,
                   manifest::Document& document) {
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    for (std::size_t b = 0; b < session.boards.size(); ++b) {
      CornerTable table{session.cameras[c], session.board_ids[b], {}};
      for (const Picture& picture : session.pictures) {
        for (const Sighting& s : picture.sightings) {
          if (picture.camera != c || s.board != b || s.detection.corners.empty()) continue;
          ImageCorners group{document.images[picture.entry].id, {}};
          const CalibratedView& view = calibration.views[s.view];
          const double noise = noise_of(session, picture, s);
          for (std::size_t k = 0; k < s.detection.corners.size(); ++k) {
            const Corner& corner = s.detection.corners[k];
            const double weight = k < view.corner_weights.size() ? view.weight * view.corner_weights[k] : 0;
            group.corners.push_back({corner.id, session.boards[b].corner_m(corner.id), corner.pixel, noise, weight});
          }
          table.images.push_back(std::move(group));
        }
      }
      const std::string own = session.boards.size() > 1 ? "-" + session.board_ids[b] : "";
      const std::string name =
          alone && session.cameras.size() == 1 ? "corners" + own : "corners-" + session.cameras[c] + own;
      std::filesystem::path path = csv;
      if (!csv.empty()) path.replace_filename(name + ".csv");
      if (!table.images.empty()) write_corners(table, name, path, document);
    }
  }
}

}  // namespace gonio::camera
