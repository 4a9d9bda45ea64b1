// The corners of a sample that nobody marked: its outline in the picture.
//
// The sample is what differs from the picture's rim by more than six of the rim's scatters: the connected piece with
// the largest convex hull that does not touch the rim. Sides of the hull are left out one by one, each time the one
// whose absence adds the least area, until four are left. Across each of these, pixel by pixel, the place is found
// of the step whose integral the brightness has; a line goes through these places robustly
// (Tukey's biweight), in rays of the camera where it is known, so that a lens may bend the sides. Corners are where
// lines meet; their sigma is that of the two lines there, and 0.03 px for what the pixels' grid leaves of an edge.
//
// Which corner is corner 0, the pattern decides: of the four ways to lay it in, the one with which its bits go
// together with the brightness of the cells, or with which the finder of a data matrix is seen, must stand clear of the
// others. A sample whose pattern does not reach its edge fails there, too.
#pragma once
#include <array>
#include <optional>
#include <string>

#include "camera/camera_model.h"
#include "contrast/measure/pattern.h"
#include "contrast/measure/segmentation.h"

namespace gonio::contrast {

struct OutlineCorners {
  std::array<Vec2, 4> pixel;  // clockwise as seen; from number_corners: in the pattern's order
  std::array<double, 4> sigma_px{};
};
struct OutlineFound {
  std::optional<OutlineCorners> corners;
  std::string problem;  // why there are none: "the sample's outline ..."
};

// `cells`: the larger of rows and columns; edges are looked for within a third of a cell.
OutlineFound find_outline(const GreyView& view, const std::optional<camera::CameraModel>& camera, int cells);

// The same corners from the sample's corner 0 on.
OutlineFound number_corners(const GreyView& view, const CellPattern& pattern, bool data_matrix,
                            const OutlineCorners& corners);

}  // namespace gonio::contrast
