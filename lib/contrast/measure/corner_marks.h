// Corners of the sample, as somebody marked them in a few of the images: columns image (an id), corner (0 .. 3, see
// contrast/measure/pattern.h), u_px, v_px, and if known sigma_px (of one coordinate). Pixel centres lie at integers.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "manifest/sections/forward.h"

namespace gonio::contrast {

struct CornerMark {
  std::string image;
  int corner = 0;
  Vec2 pixel;
  double sigma_px = 0;  // 0: not stated
  std::string place;    // "corners.csv:3", for messages
};

// Error(data) at the line for missing columns, unknown corners, images that `document` does not have, corners outside
// their camera's picture, a corner marked twice in one image.
std::vector<CornerMark> read_marks(const std::filesystem::path& csv, const manifest::Document& document);
// From `tables[name]`: a CSV file of the manifest, or inline rows.
std::vector<CornerMark> table_marks(const manifest::Document& document, const std::string& name);

// The same corner of the same image twice among all of them, or four corners that are no convex quadrangle in clockwise
// order: Error(data).
void check_marks(const std::vector<CornerMark>& marks);

}  // namespace gonio::contrast
