// The light that reaches a polarization camera at sampled pixels, as functions of all that a search changes in the
// scene: what the path tracer said once, put together.
//
// Pixels: tiles of 8 x 8 with one more around, drawn at random with a fixed seed among those that show any light. With
//   S(q, t)  the Stokes vector where all screens have q times their stated degree and are turned by t
//   S = S(1, 0) + [U + q (A(t) - U)] - S(1, 0) + sum over surfaces of R(rougher) - R(0), then what films do (coat.h)
// U = S(0, .); A(t) = a + b cos 2t + c sin 2t through S(1, t) at three turns. In q that is exact; in t it is for light
// that leaves screens along their normals, and elsewhere to the third order of t. R: between the nodes of traced/nodes.
// Differences are taken between simulations with the same random numbers.
//
// Stokes vectors are those of the luminance (render/mosaic.h), in the frame of the picture (gonio-conventions(7)).
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "explain/polarization/polarization_state.h"
#include "relighting/recordings.h"

namespace gonio::scene {
struct Surface;
}

namespace gonio::explain::polarization {

using StokesVector = std::array<double, 4>;

inline constexpr int core_px = 8, side_px = core_px + 2;
inline constexpr std::size_t no_mirror = static_cast<std::size_t>(-1);

// Which of the super-pixel's four polarizers stands over a pixel.
inline std::size_t polarizer_over(int x, int y) {
  return static_cast<std::size_t>(2 * (y & 1) + (x & 1));
}

struct Tile {
  std::size_t image = 0;  // place in Recordings::images
  int x = 0, y = 0;       // of its first pixel, which is around the core
};
struct Site {
  int x = 0, y = 0;
  Vec2 radius;                     // render/polarizer_reading.h
  StokesVector stokes{};           // as stated
  double variance = 0;             // of s0, by the simulation's random numbers
  std::size_t mirror = no_mirror;  // place in Setup::mirrors of what is met first
  double s_axis_rad = 0;           // coat.h
  double incidence_rad = 0;        // of the line of sight on what is met first; NaN: nothing
};

// Pixels of all pictures, traced: Stokes vectors one after the other, and the variances of s0.
struct TracedLight {
  std::vector<StokesVector> light;
  std::vector<double> variance;
};
// What was traced before, by all that it depends on but the contents of the scene's files (known_light.h).
using KnownLight = std::map<std::string, TracedLight>;

class MosaicLight {
 public:
  // Of the images of one camera behind polarizers. What `known` has is not traced again, and what is traced is entered.
  MosaicLight(const manifest::Document& document, const std::vector<std::filesystem::path>& repeats,
              const std::string& camera, KnownLight* known);

  const Setup& setup() const { return setup_; }
  const relighting::Recordings& recordings() const { return recordings_; }
  const std::vector<Tile>& tiles() const { return tiles_; }  // those of one image follow each other
  // Row by row of the tile, side_px * side_px.
  const Site& site(std::size_t tile, std::size_t place) const { return sites_[tile * in_a_tile + place]; }
  // What the samples of a tile would read with a gain of one: side_px * side_px places, of which the core's are right.
  void readings(std::size_t tile, const State& state, std::vector<double>& to) const;

 private:
  static constexpr std::size_t in_a_tile = static_cast<std::size_t>(side_px) * side_px;
  struct Rough {
    std::vector<double> nodes;                      // of State::rougher, the first 0
    std::vector<std::vector<StokesVector>> change;  // of each node and site
  };
  using Light = std::vector<StokesVector>;  // of all sites
  void draw_tiles(const manifest::Document& document, KnownLight* known);
  Light trace(const manifest::Document& document, double paths, bool keep_variance, KnownLight* known);
  void trace_screens(const manifest::Document& document, KnownLight* known);
  void trace_roughness(const manifest::Document& document, KnownLight* known);
  void look(const manifest::Document& document);
  void ask_roughness(const manifest::Document& document, const scene::Surface& surface);
  void ask_film(const scene::Surface& surface, std::size_t place, std::vector<std::size_t>& mirror_of);
  StokesVector stokes(std::size_t site, const State& state) const;

  Setup setup_;
  relighting::Recordings recordings_;
  std::vector<Tile> tiles_;
  std::vector<Site> sites_;
  Light unpolarized_, cosine_, sine_;  // U - S, b, c; empty without screens
  std::vector<Rough> rough_;
};

}  // namespace gonio::explain::polarization
