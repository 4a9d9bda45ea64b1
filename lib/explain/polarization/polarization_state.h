// The numbers of a simulation of mosaic photographs: what is beside the manifest, in the camera and in the scene.
#pragma once
#include <complex>
#include <string>
#include <vector>

#include "photograph/polarizer_array.h"

namespace gonio::explain::polarization {

struct Film {
  double thickness_m = 0, eta = 1.38;
};

struct State {
  photograph::PolarizerArray array;
  double veil = 0;                              // optics.veiling-glare: its share
  double screen_leak = 0, screen_turn_rad = 0;  // of all screens
  std::vector<double> rougher;                  // of each surface in question (surface.roughness)
  std::vector<Film> film;                       // on each mirror in question (surface.coating)
};

inline constexpr double roughest = 0.35;  // of State::rougher

struct RoughSurface {  // one whose model has a roughness, and that is seen
  std::string name;
  double alpha = 0, upper = 1;  // as stated; of its model
};

struct SmoothMirror {  // of metal, that is seen
  std::string name;
  std::complex<double> index;  // n + i k, mean of the bands
};

// What a manifest has that can be asked of.
struct Setup {
  std::string camera;                 // key in cameras
  std::vector<std::string> screens;   // keys in lights: polarized ones that were on
  std::vector<RoughSurface> rough;    // places in State::rougher
  std::vector<SmoothMirror> mirrors;  // places in State::film
};

}  // namespace gonio::explain::polarization
