// Field tables of the sections about patterns of cells and their contrasts.
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/contrast.h"
#include "manifest/sections/pattern.h"

namespace gonio::manifest {

const std::vector<Field<PatternPlacement>>& pattern_placement_fields() {
  static const std::vector<Field<PatternPlacement>> table{
      field("name", &PatternPlacement::name, "", "before, after").needed(),
      field("images", &PatternPlacement::images, "", "ids; left out: the images whose group is this name"),
      field("world_from_pattern", &PatternPlacement::world_from_pattern, "", "takes pattern to world coordinates")};
  return table;
}

const std::vector<Field<PatternDefect>>& pattern_defect_fields() {
  static const std::vector<Field<PatternDefect>> table{
      field("row", &PatternDefect::row, "", "of the cell, from 0 at the top").needed(),
      field("column", &PatternDefect::column, "", "of the cell, from 0 at the left").needed(),
      field("score", &PatternDefect::score, "", "robust distance from the cells of its class").range(0, infinite),
      field("p", &PatternDefect::p, "", "that any sound cell lies as far, over all cells").range(0, 1)};
  return table;
}

const std::vector<Field<Pattern>>& pattern_fields() {
  static const std::vector<Field<Pattern>> table{
      field("kind", &Pattern::kind, "", "grid or data-matrix").one_of({"grid", "data-matrix"}),
      field("rows", &Pattern::rows, "", "of cells").range(1, 1000).needed(),
      field("columns", &Pattern::columns, "", "of cells").range(1, 1000).needed(),
      field("cell_m", &Pattern::cell_m, "m", "width and height of a cell; one number: square").positive(),
      field("file", &Pattern::file, "", "file id of the bits: a picture or text, one pixel or character a cell"),
      field("text", &Pattern::text, "", "data-matrix: what it says"),
      field("corners", &Pattern::corners, "", "name of a table with the columns image, corner, u_px, v_px, sigma_px"),
      field("placements", &Pattern::placements, "", "how the sample lay: once before, once after it was turned"),
      field("defects", &Pattern::defects, "", "cells that behave unlike their class, as contrast found")};
  return table;
}

const std::vector<Field<Contrast>>& contrast_fields() {
  static const std::vector<Field<Contrast>> table{
      field("action", &Contrast::action, "", "predict or measure").one_of({"predict", "measure"}).needed(),
      field("surface", &Contrast::surface, "", "name of the surface"),
      field("image", &Contrast::image, "", "id of the image"),
      field("pair_rad", &Contrast::pair_rad, "rad", "the two rotations of the sample that are compared"),
      field("tilt_rad", &Contrast::tilt_rad, "rad", "of the camera against the normal"),
      field("light_rad", &Contrast::light_rad, "rad", "of the light against the camera"),
      field("parameters", &Contrast::parameters, "", "of the surface, by name"),
      field("signals", &Contrast::signals, "", "[s1, s2]: radiances of the first and the second"),
      field("difference", &Contrast::difference, "", "s1 - s2"),
      field("michelson", &Contrast::michelson, "", "(s1 - s2) / (s1 + s2)"),
      sigma_field(&Contrast::sigma),
      field("pattern", &Contrast::pattern, "", "measure: name of the pattern"),
      field("placement", &Contrast::placement, "", "measure: how the sample lay"),
      field("partner", &Contrast::partner, "", "measure: id of the same view after the turn"),
      field("right", &Contrast::right, "", "measure: share of cells on their side of the threshold").range(0, 1),
      field("cells", &Contrast::cells, "", "measure: cells that counted")};
  return table;
}

GONIO_RECORD(PatternPlacement, pattern_placement_fields);
GONIO_RECORD(PatternDefect, pattern_defect_fields);
GONIO_RECORD(Pattern, pattern_fields);
GONIO_RECORD(Contrast, contrast_fields);

}  // namespace gonio::manifest
