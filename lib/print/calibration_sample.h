// A sample that a printer prints to be measured: what its voxels make of grey values, what they resolve, how steep they
// build; and the reading of a height map of it.
//
// On a slab of white layers, in one layer:
//   checkers   repeated with growing white (Luongo et al. 2020, section 4.1, let the light grow): four quadrants each,
//              whose squares are 8, 4, 2 and 1 pixels wide
//   gradients  repeated: strips of fields from black to white, every second the other way round, so that a tilt of the
//              instrument does not look like growth; bare slab about each
// and, higher than that, wedges: ramps of stated slopes, of several layers.
// Sizes follow from the picture: as many repetitions as fit, 36 at most.
//
// Frame of the platform, as in manifest/sections/print.h. Boxes in pixels.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "io/height_map.h"
#include "print/growth.h"
#include "print/slicer.h"

namespace gonio::print {

struct SampleField {
  PixelBox box{};
  double grey = 0;     // gradients: of the field; checkers: of their white
  int repetition = 0;  // from 0
  int square_px = 0;   // checkers: of the quadrant
};
struct SampleWedge {
  PixelBox box{};
  double slope_rad = 0;  // rises along x
};
struct CalibrationSample {
  PixelBox slab{};
  std::size_t slab_layers = 0, layers = 0;  // of the slab; in all
  std::vector<SampleField> gradients, checkers;
  std::vector<SampleWedge> wedges;
  int repetitions = 0;  // of the gradients
};
struct SampleWish {
  std::size_t slab_layers = 20;
  int greys = 32;                     // of a gradient
  int repetitions = 36;               // of each
  double darkest = 0, brightest = 1;  // of the gradients
};
// Error(data) at the printer where not even four repetitions fit.
CalibrationSample calibration_sample(const Printer& printer, const SampleWish& wish = {});
// Grey values 0 to 1 of the slab's box, row by row.
std::vector<float> sample_layer(const CalibrationSample& sample, const Printer& printer, std::size_t layer);

// Where a height map lies on the platform: its point (x, y), rows from the top, stands at
//   at_m + turn (x step_x, -y step_y).
struct MapPlace {
  Vec2 at_m{};  // of the map's first point, top left
  double turn_rad = 0;
};
struct SampleReading {
  MapPlace place;       // found near the one that was said
  double likeness = 0;  // correlation of measured and expected heights there
  PrintedGradient gradient;
  int incomplete = 0;             // repetitions of which a field lies outside of the map or has too few points
  std::array<double, 3> plane{};  // of the bare slab: height at the map's middle, slopes along x and y
};
// Heights of gradients' fields above the bare slab about them. The place is looked for within `search_px` pixels of
// the printer along either axis. Error(data) at `place`.
SampleReading read_gradients(const io::HeightMap& map, const CalibrationSample& sample, const Printer& printer,
                             const MapPlace& near, double search_px, const std::string& place);

}  // namespace gonio::print
