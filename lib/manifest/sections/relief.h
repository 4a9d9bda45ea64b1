// "reliefs": maps of heights, measured or designed, with what their roughness and their lobes are.
//
// Frame of a map: x along its rows, y up the picture, z out of the surface; azimuths counter-clockwise from x.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manifest/parameter.h"

namespace gonio::manifest {

struct ReliefTreatment {                         // what was taken off the heights before they were looked at
  std::string levelling;                         // "none" | "plane" | "quadratic"
  std::vector<double> tilt;                      // slopes [x, y] of the plane that was taken off
  std::optional<double> s_filter_m, l_filter_m;  // nesting indices; left out: no filter
};
struct RoughnessFigure {
  double value = 0;
  std::string unit;  // "m" | "1"
  std::optional<double> sigma;
};
struct NormalsFit {                                  // a distribution of microfacet theory over the slopes of a map
  std::string distribution;                          // "ggx" | "beckmann"
  double alpha_u = 0, alpha_v = 0, azimuth_rad = 0;  // alpha_u >= alpha_v; azimuth of u
  Sigmas sigma;
  std::optional<double> log_likelihood;  // per slope
};
struct ReliefLobe {  // light from one direction, as paths over the map send it back
  double incidence_rad = 0, azimuth_rad = 0;
  ReliefTreatment treatment;
  std::string tiling, facets;                // "mirrored" | "repeated"; surface model of the facets
  Parameters parameters;                     // of the facets
  std::vector<double> reflected, lost, cut;  // shares, red green blue; they add up to 1
  std::vector<double> by_facets;             // shares of `reflected` that met 1, 2, 3 and more facets
  std::vector<double> peak;                  // 1/sr, of the table's largest cell
  double peak_theta_rad = 0, peak_phi_rad = 0;
  Sigmas sigma;
  std::optional<std::int64_t> paths;
  std::string picture;  // file id
};
struct ReliefMap {                                    // "reliefs"
  std::string file;                                   // file id of the map
  std::optional<std::int64_t> width, height;          // points
  std::vector<double> step_m;                         // [x, y]
  std::optional<double> unit_m;                       // of pictures: what a height of 1 means
  std::string channel;                                // of an OpenEXR
  std::string kind;                                   // "noise" | "ridges" | "sinusoid"; left out: measured
  std::map<std::string, std::vector<double>> design;  // what it was made from
  std::optional<std::int64_t> missing;                // points without a height
  std::optional<ReliefTreatment> treatment;           // of the figures and normals below
  std::map<std::string, RoughnessFigure> parameters;
  std::optional<double> independent_areas;
  std::optional<bool> long_waves;   // structure as long as the map: sigmas are too small
  std::vector<NormalsFit> normals;  // the likelier first
  std::vector<ReliefLobe> lobes;
  std::string table, surface;  // of the lobes: name in tables; what the normals make of the facets: name in surfaces
};

}  // namespace gonio::manifest
