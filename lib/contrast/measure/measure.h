// Contrast of a binary pattern of cells, measured from photographs of the sample before and after it was turned
// (Regi et al. 2019, "Functionality characterization of injection moulded micro-structured surfaces").
//
// In: a manifest with `images` (linear, or with a response), `cameras`, and one of `patterns` with two placements.
// Where the cells lie in a picture follows from the camera, its pose and the sample's pose
// (contrast/measure/sample_pose.h), which the manifest states or which corners marked in a few of the images determine;
// or, where an image has no camera pose, from the corners marked in it.
//
// One view: it is laid onto the pattern, as far as its pose leaves that open (contrast/measure/view_shift.h). The
// pixels whose centres lie in the inner share of a cell are averaged (contrast/measure/segmentation.h). Of a cell of w
// pixels whose place is known to sigma the share is
//     min(inner, 1 - 2 (1/2 + q sigma) / w),
// half a pixel for the pixel's own extent and q for the whole series: by as much as q sigma no coordinate of any view
// is off in 1 - (alarm rate) of all sessions (Bonferroni). Neighbours then do not mix, whatever the pose. Through the
// cells of bit 1, and through those of bit 0, goes a smooth polynomial of the place on the sample, fitted robustly
// (contrast/measure/cell_classes.h), so that neither uneven light nor a few bad cells bend the result. s1 and s2 are
// the means of the two polynomials over the whole pattern,
//     difference = s1 - s2,     michelson = (s1 - s2) / (s1 + s2),
// signed: positive where bit 1 is the brighter. A pattern that works by its orientation changes the sign when it is
// turned by a quarter. The turn of one class compares the same cells in the same view before and after:
// (before - after) / (before + after).
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "contrast/measure/corner_marks.h"
#include "contrast/measure/defects.h"
#include "contrast/measure/pattern.h"
#include "contrast/measure/sample_pose.h"
#include "contrast/measure/segmentation.h"
#include "manifest/sections/forward.h"
#include "metric/exposure.h"

namespace gonio::contrast {

struct MeasureOptions {
  double inner = 0.6;             // share of a cell's width and height that counts, at most
  double corner_sigma_px = 0.5;   // of one coordinate of a marked corner that states none
  double robot_sigma_m = 1e-4;    // repeatability of camera poses that state none, one coordinate
  double robot_sigma_rad = 2e-4;  //   and about one axis
  double full_scale = std::numeric_limits<double>::infinity();  // linear values from here on are saturated
  double alarm_rate = 0.05;                                     // of finding any defect on a sample without one
  bool refine = true;  // lay every view onto the pattern, within what its pose leaves open
  std::uint64_t seed = 1;
  std::function<void(const std::filesystem::path&)> note_input;
};

struct MeasuredView {
  std::string image;
  int placement = 0;                     // 0 before, 1 after the turn
  std::vector<std::string> lights{};     // that are on; empty: all
  double tilt_rad = 0, azimuth_rad = 0;  // of the camera, in the pattern's frame; tilt 0: along the normal
  double along_rad = 0;                  // tilt, signed along the cameras' main direction: the axis of curves
  CellMeans means;                       // of the cells
  double place_px = 0;                   // one sigma of where a cell lies in this picture
  double inner = 0;                      // share of the cells that counts in this view
  double margin_px = 0, needed_px = 0;   // narrowest strip left out beside cells' borders, and what the place asks for
  Vec2 shift_px;                         // by refinement, at the pattern's middle
  metric::Estimate bright, dark;         // s1: cells of bit 1; s2: cells of bit 0
  metric::Estimate difference, michelson;
  double degrees = 0;                  // of freedom of the sigmas: Student's t
  double right = 0;                    // share of cells on their class's side of the threshold half way
  std::vector<double> ratio;           // of each cell to its class's polynomial; NaN where it does not count
  std::optional<std::size_t> partner;  // the same view in the other placement
};

// The same view before and after the turn: contrast of one class against itself.
struct Turn {
  std::size_t before = 0, after = 0;          // places in views
  std::array<metric::Estimate, 2> michelson;  // of bit 0 and bit 1
};

struct MeasuredCode {  // of a data matrix
  std::string text;
  int wrong_modules = 0;  // of all, that differ from the code after its error correction
  int quarter_turns = 0;  // clockwise, by which the code stands turned in the pattern's frame
  bool inverted = false;  // what was taken for 1 is 0 in the code
  int views_read = 0;     // single views from which it could be read alone
};

struct Measured {
  std::string pattern_name;
  CellPattern pattern;      // with bits
  bool bits_found = false;  // from the pictures and not given
  std::array<std::string, 2> placement;
  std::array<std::optional<SamplePose>, 2> pose;
  std::optional<double> turn_rad;  // between the two poses, about the normal
  std::vector<MeasuredView> views;
  std::vector<Turn> turns;
  std::vector<metric::Estimate> cell_turn;  // per cell: mean over the turns of (before - after) / (before + after)
  Defects defects;
  std::optional<MeasuredCode> code;
  std::vector<std::string> notes;    // what a reader must know
  std::vector<std::string> dropped;  // images left out, each with the reason
  // Of the signed contrast over the views of a placement.
  metric::Estimate mean_michelson(int placement) const;
};

// `name`: of the pattern; empty: the only one. `marks`: beside those of the pattern's table. Error(data) in one line
// where there is no image of a placement, a corner outside the picture, a grid that does not fit the pattern, cells
// below 3 pixels, saturated cells in every view, ...
Measured measure(const manifest::Document& document, const std::string& name, const std::vector<CornerMark>& marks,
                 const MeasureOptions& options);

}  // namespace gonio::contrast
