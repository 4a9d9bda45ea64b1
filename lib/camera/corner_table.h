// The table of found corners through which calib-charuco hands its measurements on: one row per corner, inline in the
// manifest or a CSV file beside it. Columns: image (an id of `images`), corner, board_x_m, board_y_m, u_px, v_px,
// sigma_px, weight (may be left out); observed [u_px, v_px], sigma [sigma_px]; model "camera". Board frame and pixel
// convention: board.h. Tables made by others may say more of a corner, and explain reads it: channel (0 red, 1 green,
// 2 blue), turned_rad (by which the picture was turned before its corners were sought), time_s, temperature_K. These
// are read, not written.
#pragma once
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "manifest/sections/forward.h"

namespace gonio::camera {

inline constexpr double not_stated = std::numeric_limits<double>::quiet_NaN();

struct TableCorner {
  int id = 0;
  Vec2 board_m, pixel;
  double sigma_px = 0;  // of one coordinate
  double weight = 1;    // that a fit gave the corner; below 1: held back as an outlier
  int channel = 1;
  double turned_rad = 0, time_s = not_stated, temperature_K = not_stated;
};
struct ImageCorners {
  std::string image;
  std::vector<TableCorner> corners;
};
struct CornerTable {
  std::string camera, board;         // ids; empty where the table does not say
  std::vector<ImageCorners> images;  // in the order in which they first appear
};

// Reads `document.tables[name]`. Error(data) at the row for missing columns, values that are no numbers, sigma <= 0;
// the CSV file is checked as every file of the manifest is.
CornerTable read_corners(const manifest::Document& document, const std::string& name);

// Enters the table; rows inline, or in `csv` where that is not empty (written here, whole or not at all).
void write_corners(const CornerTable& table, const std::string& name, const std::filesystem::path& csv,
                   manifest::Document& document);

}  // namespace gonio::camera
