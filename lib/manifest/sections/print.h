// "prints": a printer that cures layers by light, and what is sent to it.
//
// Frame of the platform: x along the rows of the projector's pixels, y along its columns, z away from the platform, the
// origin at the centre of the picture.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manifest/parameter.h"

namespace gonio::manifest {

struct PrintGrowth {  // how high a voxel grows by the grey value (print/growth.h)
  double alpha_m = 0, beta_m = 0, gamma = 0;
  Sigmas sigma;
  std::vector<double> covariance;        // 3 x 3 of alpha, beta, gamma
  std::vector<double> greys, heights_m;  // where the law fails: what was measured, rising
  std::optional<double> lack_of_fit_p, rms_m;
  std::optional<std::int64_t> repetitions;  // of the gradient that it was fitted to
};
struct PrintBleed {                          // light that reaches neighbours (print/bleed.h)
  double sigma_m = 0;                        // of the Gaussian core
  std::optional<double> tail_share, tail_m;  // of the light, and its half width
  Sigmas sigma;
};
struct MicrostructureUse {  // a registered micro-structure (relief/microstructure.h) and its parameters
  std::string model = "none";
  Parameters parameters;
  std::string file{};        // of a model that has a picture: its file id
  std::string expression{};  // of a model that has one
};
struct PrintedPart {
  std::string mesh;                           // name in meshes
  std::vector<double> at_m;                   // of the mesh's own origin, on the platform
  double turn_rad = 0;                        // about z, before it is set down
  std::string microstructure{};               // name in the print's microstructures
  std::map<std::string, std::string> labels;  // of the mesh's faces -> micro-structure
  std::vector<std::string> repaired;          // what was done to the mesh, in words
  std::optional<double> volume_m3, facing_m2, hidden_m2, hidden_printed_m2;
};
struct MeasuredPrint {       // a map of the printed surface, seen from the projector; heights from any plane
  std::string relief;        // name in reliefs
  std::vector<double> at_m;  // where its first point, of the uppermost row, lies on the platform [x, y]
  double turn_rad = 0;       // of its rows about z, on the platform
};
struct Print {  // "prints"
  std::vector<double> pixel_m;
  std::int64_t width_px = 0, height_px = 0;
  double layer_m = 0;
  std::vector<double> layers_m;  // thickness of each, where they differ
  std::optional<PrintGrowth> growth;
  std::optional<PrintBleed> bleed;
  std::optional<double> overcure_m;  // depth in which light falls to 1/e
  std::string ground;                // name in ground_noises
  std::map<std::string, MicrostructureUse> microstructures;
  std::vector<PrintedPart> parts;
  std::string layers;                     // file id of what is sent
  std::map<std::string, double> process;  // of the machine: exposure_s, lift_m, ...; units end the names
  std::map<std::string, double> figures;  // of the job: printed_layers, volume_m3, time_s, ...
  std::string relief, mesh;               // predicted: names in reliefs, meshes
  std::vector<MeasuredPrint> measured;
};

}  // namespace gonio::manifest
