// What patterns are written with: directions about a target, steps that are only asked, brackets of exposures.
#pragma once
#include <string>
#include <vector>

#include "acquisition/plan/view_pattern.h"

namespace gonio::acquisition {

struct Direction {  // from the target: zenith counted from `up`, azimuth about it, 0 along the world's x for up = z
  double zenith_rad = 0, azimuth_rad = 0;
};

// The point `distance_m` from the scene's target, and a camera there that looks at it. Over the pole the picture's
// right is the azimuth's direction of growth, as beside it.
Vec3 place_at(const PatternScene& scene, Direction direction, double distance_m);
manifest::Pose<frame::World, frame::Camera> camera_at(const PatternScene& scene, Direction direction,
                                                      double distance_m);
manifest::Pose<frame::World, frame::Camera> camera_looking(const PatternScene& scene, Vec3 position_m);

// A regular grid on a sphere: rings of constant zenith from `first_zenith_rad` on in steps, each with azimuths from
// `first_azimuth_rad` on in steps, both ends included where the step meets them; of a full circle the last azimuth,
// which is the first again, is left out, and a ring at the pole has one direction. `even`: rings have as many azimuths
// as keep them at least one step of arc apart, so that directions lie about equally dense.
struct SphereGrid {
  double step_rad = 0, first_zenith_rad = 0, last_zenith_rad = 0, first_azimuth_rad = 0, last_azimuth_rad = 2 * pi;
  bool even = false;
};
std::vector<Direction> directions(const SphereGrid& grid);

// first, first + step .. last, the last included where it is met to 1e-9 of a step.
std::vector<double> stepped(double first, double last, double step);

// Exposures from `shortest_s` up to `longest_s`, each 2^stops as long as the one before.
std::vector<double> bracket(double shortest_s, double longest_s, double stops);

// A step of purpose "view" with the scene's camera, lamps and exposures.
manifest::PlanStep view_step(const PatternScene& scene, const std::string& image);
// "hemisphere-0007"
std::string image_name(const std::string& pattern, std::size_t index);

// Error(usage) that says what `pattern` needs.
void need_lamps(const PatternScene& scene, const std::string& pattern, std::size_t least = 1);

// Every step of a camera's way past the scene (geom/view_path.h).
std::vector<manifest::PlanStep> path_steps(const std::string& path, const PatternScene& scene,
                                           const PatternNumbers& numbers);
std::vector<PatternParameter> path_parameters();

// The camera on a grid between two azimuths, under every place of the first lamp where that is given a radius.
std::vector<manifest::PlanStep> grid_steps(const std::string& pattern, const PatternScene& scene,
                                           const PatternNumbers& numbers, double first_azimuth_rad, double span_rad);
// radius, step, lowest, highest, even, roll; lamp-radius, lamp-step, lamp-lowest, lamp-azimuth, lamp-span
std::vector<PatternParameter> grid_parameters();

}  // namespace gonio::acquisition
