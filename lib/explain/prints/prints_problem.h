// Maps of a printed surface against the simulation of what was sent to the printer.
//
// Observations: mean heights over the points of each pixel, in layers, each with the noise that even fields show from
// pixel to pixel, and by how much a wall's place is uncertain (0.02 pixel). What matters is a share of a layer. Groups:
// sixteen patches of each map; blocks of 4 x 4 pixels. What the printer adds at random (explain/prints/ground.h) is
// asked before, and where it is there it is noise of the readings, and blocks are larger.
//
// Base model: what "prints" states of growth (white's height to 0.3 %), bleed (and a twentieth of a pixel by which
// resins spread light themselves) and overcure (print/cure.h); for each map a plane, where it lies (by some tenths of a
// pixel) and the instrument's lateral resolution. Hypotheses: print.* (explain/prints/terms), one file each.
//
// Frame of the platform (manifest/sections/print.h), metres.
#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "explain/domain.h"
#include "explain/engine.h"
#include "explain/prints/printed_field.h"
#include "io/height_map.h"
#include "manifest/parameter.h"
#include "manifest/sections/forward.h"

namespace gonio::explain {

struct PrintedMap {
  std::string relief, place;  // in "reliefs"; for messages
  io::HeightMap map;
  Vec2 at_m{};  // of its first point
  double turn_rad = 0;
  // Of a point of the map, on the platform.
  Vec2 at(std::size_t column, std::size_t row) const;
};
struct PrintsInput {
  std::string name, place;  // in "prints"; for messages
  prints::Sent sent;
  std::vector<PrintedMap> maps;
  std::map<std::string, manifest::Parameters> given;  // mechanisms that the manifest has switched on
};

// Prints that name measured maps.
bool has_prints(const manifest::Document& document);
std::vector<PrintsInput> prints_inputs(const manifest::Document& document, const ProblemOptions& options);
std::unique_ptr<Problem> prints_problem(PrintsInput input);
std::vector<std::filesystem::path> prints_files(const manifest::Document& document);

}  // namespace gonio::explain
