// Pictures of cameras that are calibrated together, and what was found in them. For calibrate_document*.cpp only.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "camera/calibrate_document.h"

namespace gonio::camera {

struct Sighting {  // a board that a picture is said to show
  std::size_t board = 0;
  Detection detection;
  std::size_t view = 0;  // place among the calibration's views
};
struct Picture {
  std::size_t entry = 0;       // place in document.images
  std::filesystem::path path;  // empty: nobody took it, and its corners are looked up
  int width_px = 0, height_px = 0;
  std::size_t camera = 0, shot = 0;
  std::vector<Sighting> sightings;
  bool by_itself = true;  // no other camera and no robot says where the board stands: parts of plain boards serve
};
struct Session {
  std::vector<std::string> cameras, board_ids;
  std::vector<Board> boards;
  std::vector<Picture> pictures;
};

std::string image_pointer(std::size_t index);

// Cameras that share shots stand in one session; Error(data) for what the manifest leaves open.
// Pictures of a pattern that is shown (`projection`) count where it is white, or where they name a board. `projector`:
// images without a file are views of one.
std::vector<Session> sessions_of(const manifest::Document& document, bool projector);

// Searches all pictures; the layout of ChArUco boards is the one that the majority of all markers fit. Parts of plain
// boards count where another picture of the session shows the whole.
void look_at_all(Session& session, const CalibrationRequest& request, const manifest::Document& document);

// Error(data) for pictures of other sizes, the same picture twice, mirrored pictures, a board that no picture shows.
void check_pictures(const manifest::Document& document, const Session& session);

// Noise of one coordinate in a picture, the camera's median where there were too few corners to measure it.
double noise_of(const Session& session, const Picture& picture, const Sighting& sighting);

// One view per sighting, in order; numbers them.
std::vector<View> views_of(const manifest::Document& document, Session& session);

void store_calibration(const Session& session, const CalibrationSetup& setup, const Calibration& calibration,
                       manifest::Document& document);
void store_corners(const Session& session, const Calibration& calibration, bool alone, const std::filesystem::path& csv,
                   manifest::Document& document);

}  // namespace gonio::camera
