// "patterns": flat samples whose cells form a binary pattern.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "manifest/pose.h"

namespace gonio::manifest {

// "patterns": a flat sample whose cells form a binary pattern (a data matrix, a checker), as it lay before the camera.
// Its frame: origin at the outer corner top left, x along the columns, y along the rows downwards, z into the sample.
struct PatternPlacement {           // the sample as it was put down once
  std::string name;                 // "before", "after"
  std::vector<std::string> images;  // ids; left out: the images whose `group` is this name
  std::optional<Pose<frame::World, frame::Object>> world_from_pattern;
};
struct PatternDefect {  // a cell that behaves unlike its class
  int row = 0, column = 0;
  double score = 0, p = 1;
};
struct Pattern {
  std::string kind = "grid";   // "grid" | "data-matrix"
  int rows = 0, columns = 0;   // of cells
  std::vector<double> cell_m;  // width and height of a cell; one number: square
  std::string file, text;      // file id: bits, as a picture or as text; data-matrix: what it says
  std::string corners;         // name of a table: image, corner, u_px, v_px, sigma_px
  std::vector<PatternPlacement> placements;
  std::vector<PatternDefect> defects;
};

}  // namespace gonio::manifest
