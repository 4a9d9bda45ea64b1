// Simulated photographs for align(): eight shapes of genus 0 to 5 on a ground, seen by 1 to 4 cameras under 1 to 4
// lamps.
//
// Masks are made by filling triangles on a grid sixteen times as fine, through no code of lib/alignment but its
// projections; their rims err by a smooth random field, and some are spoiled by blobs.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "alignment/alignment_input.h"
#include "alignment/fit.h"

namespace gonio::alignment::testing {

struct Solid {
  std::string name;
  std::vector<Vec3> positions_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  int genus = 0;
  bool symmetric = false;
};
const std::vector<Solid>& solids();

// How often each place of a grid `factor` times as fine as the picture is covered: 0 or 1.
std::vector<std::uint8_t> filled(const Setting& setting, const RimSubject& subject, int width, int height, int factor);

struct WorldWish {
  std::size_t solid = 0;
  int views = 1, lamps = 1;
  std::uint64_t seed = 1;
  double error_px = 0.3, outliers = 0.02;
  bool from_nothing = false;  // else 5 degrees and 10 mm off, and lamps by a centimetre
  double scale_sigma = 0;     // of the solid's three true scales about 1, which are free then
  int size_px = 480;
  // What is done to a photograph's masks before rims are taken of them; empty: nothing.
  std::function<void(struct Labels&, std::size_t station, std::mt19937_64&)> spoil{};
};
struct World {
  AlignmentInput input;  // its stated setting is where the search begins
  Setting truth;
};
World world_of(const WorldWish& wish);

// Its masks, with their errors: of one photograph, and their rims as sightings of the world's input.
constexpr std::uint8_t ground = 0, object = 1, shadow = 2;
struct Labels {
  std::vector<std::uint8_t> of;  // per pixel
};
Labels photographed(const Setting& setting, std::size_t station, std::size_t lamp, const WorldWish& wish,
                    std::mt19937_64& random);
void add_rims(World& world, const Labels& labels, std::size_t station, std::size_t lamp, const WorldWish& wish);

// Truth minus found, and the standard deviations: of all free numbers.
struct Miss {
  std::vector<double> error, sigma;
  double turn_rad = 0, shift_m = 0;
};
Miss miss_of(const World& world, const Fitted& fitted);

}  // namespace gonio::alignment::testing
