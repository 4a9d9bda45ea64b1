// Objects of glass-make's families with their truth, for tests and proofs of the refinement: views as a person has them
// (turned_views.h), what a network might say (the truth with errors that hang together), and angles to the truth.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "glass/refine/refine.h"
#include "glass/set.h"
#include "glass/turned_views.h"

namespace gonio::glass {

struct World {
  std::vector<View> views;
  manifest::Document document;
  std::vector<std::vector<Vec3>> front, back;  // of each view's pixels, in the camera's frame; zero: not met
  double index = 0;                            // of the glass at 550 nm
  std::string form, glass;
};

struct WorldWish {
  std::string form = "lathe";
  std::uint64_t seed = 1;
  std::size_t object = 0, views = 7;
  int size_px = 64, spp = 64;
  double relative_error = 0.1;
  bool clear = true;  // no roughness, no bubbles, nothing filled in
};
World make_world(const WorldWish& wish, const std::filesystem::path& folder);

// The truth turned by a smooth random rotation vector; rms angle `front_deg`, `back_deg`, stated as sigma. Errors hang
// together over `reach_px`.
void add_stand_in(World& world, double front_deg, double back_deg, double reach_px, std::uint64_t seed);
// What glass-net(1) says with the weights in a folder, called as a person calls it (GLASS_NET in the environment names
// the program, else it is looked for); with `masks` of its own the outlines are the network's, too. `folder` is the
// world's.
void ask_network(World& world, const std::filesystem::path& weights, bool masks, const std::filesystem::path& folder);
// Outlines as a network draws them: displaced by a smooth random distance of this standard deviation.
void shake_masks(World& world, double sigma_px, std::uint64_t seed);

struct Angles {  // mean, degrees; over pixels of all views but the one held out that lie in the true mask
  double front = 0, back = 0, held_front = 0, held_back = 0;
};
// `normal(view, x, y, front)` in the world's frame; the zero vector counts as 90 degrees.
Angles angles(const World& world, std::size_t held_out, const std::function<Vec3(std::size_t, int, int, bool)>& normal);
Angles angles_of(const World& world, const Stage& stage, std::size_t held_out);
Angles angles_of_network(const World& world, std::size_t held_out);

// Of the maps that are written (answer.h), in all views but the one held out: mean angles, and how many normals lie
// within their stated deviation, within two, beyond three.
struct MapsJudged {
  double front = 0, back = 0, within = 0, within_two = 0, beyond_three = 0;
};
MapsJudged judge_maps(const World& world, const Refined& refined, std::size_t held_out);

}  // namespace gonio::glass
