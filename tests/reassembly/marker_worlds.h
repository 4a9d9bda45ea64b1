// Pieces with markers before cameras, with the truth beside what is seen: outlines with noise, missing and false ones,
// markers behind glass (rays refracted by Snell's law through a ball or a slab) and in a mirror. It shares no code with
// what is tested but the types.
#pragma once
#include <optional>
#include <vector>

#include "base/random.h"
#include "reassembly/place.h"

namespace gonio::tests {

using WorldFromObject = Rigid<frame::World, frame::Object>;

enum class SeenAs { directly, refracted, reflected, falsely };
struct Origin {  // of an outline
  SeenAs how = SeenAs::falsely;
  std::size_t piece = 0, marker = 0;
};

struct MarkerWorld {
  std::vector<reassembly::View> views;
  std::vector<std::vector<Origin>> origins;
  std::vector<reassembly::Piece> pieces;   // as the tomograph measured them
  std::vector<std::vector<Vec3>> centres;  // true, object frame
  std::vector<WorldFromObject> truth;
  reassembly::PlaceWish wish;
};

enum class Clutter { none, glass_ball, slab, mirror };
struct WorldWish {
  int views = 4, pieces = 1, markers = 9;
  bool stereo = true;  // pairs at 0.2 m from each other, else single
  double noise_px = 0.2, focal_px = 6500;
  double missing = 0, falsely = 0;  // shares
  Clutter clutter = Clutter::none;
  double tomograph_m = 6e-6;            // standard deviation of a marker's coordinate
  double camera_m = 0, camera_rad = 0;  // of poses
  double marker_radius_m = 0.003;
  bool radius_known = true;
  bool body_hides = true;  // a piece hides what lies behind it; glass balls show it refracted
};
WorldWish random_wish(std::uint64_t seed);  // what the brief of 500 layouts asks for
MarkerWorld make_world(const WorldWish& wish, std::uint64_t seed);
// The same with these layouts (object frame).
MarkerWorld make_world(const WorldWish& wish, const std::vector<std::vector<Vec3>>& layouts, std::uint64_t seed);

// Whether the piece's markers that are seen directly in two views or more leave one placement only: no other rotation
// puts as many of its markers on true points of the scene (virtual ones included), within `tolerance_m`. By trying all
// triples; no code of the library.
struct Unique {
  std::size_t seen = 0;
  bool only = false;
};
Unique unique_layout(const MarkerWorld& world, std::size_t piece, double tolerance_m);

}  // namespace gonio::tests
