// The sections about flat samples and how they scatter light: what goniometer images show, fits of surfaces to measured
// reflectances, patterns of cells, contrasts. A part of sections.h, which explains frames and units.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "manifest/parameter.h"
#include "manifest/value.h"

namespace gonio::manifest {

// "goniometer": a flat sample that images show, or a white tile: one whose reflectance is stated. Its frame: z the
// normal, x from where azimuths count.
struct FlatPatch {
  std::optional<Pose<frame::World, frame::Object>> world_from_sample;
  std::vector<std::vector<double>> polygon_m;  // corners [x, y] in its frame; or a disc:
  std::optional<double> radius_m;
  std::vector<double> centre_m;          // of the disc, [x, y]; empty: the origin
  std::vector<std::string> images;       // ids of the images that show it; empty: all
  std::string tile;                      // of a sample: name of the patch that its readings refer to
  std::vector<double> reflectance;       // of a tile that is Lambertian (but for reference.tile): 1 or 3
  std::string surface;                   // of a tile that is not: name of the surface that says how it reflects
  std::optional<double> relative_sigma;  // of what a tile reflects, common to all readings
  std::string values;  // of the images: "radiance" (default), or "exposure": radiance times exposure_s
};

// "surface_fits": how the surface of the same name was told from measured reflectances.
struct AlternativeFit {
  std::string model;
  std::optional<std::int64_t> parameters;
  std::optional<double> rms, held_out_rms;  // on the scale log(1 + 100 f cos theta_i cos theta_o)
  std::string reason;                       // why it was not chosen
};
struct DroppedRows {
  std::string reason, first;  // where the first of them stands
  std::int64_t rows = 0;
};
struct SurfaceFit {
  std::string model, verdict, sentence;
  std::map<std::string, std::vector<double>> parameters;  // one number, or one per band
  Sigmas sigma;
  Value covariance;                        // {"order": [...], "values": [[...]]} or null
  std::vector<std::string> bands;          // of the measurement
  std::vector<double> wavelengths_m;       // of the bands, where known
  std::vector<std::string> written_bands;  // that surfaces/NAME takes for red, green and blue
  std::optional<std::int64_t> rows;
  std::vector<DroppedRows> dropped;
  std::optional<double> rms, held_out_rms, rms_decades;  // rms as above; of log10 f
  std::optional<double> energy, reciprocity;             // largest reflectance; largest |f(i, o) / f(o, i) - 1|
  std::optional<bool> converged;
  std::vector<AlternativeFit> alternatives;
  std::vector<std::string> refusals, notes;
  std::string mirror;                  // the convention found: "phi_i + pi" | "phi_i"
  std::optional<double> mirror_ratio;  // brightness at phi_i + pi over brightness at phi_i
  std::string source, basis;           // what was measured; what a reconstruction rests on
  std::map<std::string, std::string> files;
};

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
struct Contrast {                      // "contrasts": of two signals, as `contrast` predicts or measures it
  std::string action, surface, image;  // "predict" | "measure"; name of the surface, id of the image
  std::vector<double> pair_rad;        // rotations of the sample about its normal that are compared
  std::optional<double> tilt_rad, light_rad;
  std::map<std::string, double> parameters;     // of the surface
  std::vector<double> signals;                  // [s1, s2]
  std::optional<double> difference, michelson;  // s1 - s2, (s1 - s2) / (s1 + s2); signed
  Sigmas sigma;
  std::string pattern, placement, partner;  // measure: names of both; id of the image after the turn
  std::optional<double> right;              // measure: share of cells on the right side of the threshold
  std::optional<std::int64_t> cells;        // measure: that counted
};

}  // namespace gonio::manifest
