// A projector and cameras about a plane, a step or a ball, by closed forms and pinholes that share nothing with the
// library. Metres; camera axes x right, y down, z forward.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "scan/decode.h"
#include "scan/triangulate.h"

namespace gonio::tests {

struct Pinhole {
  int width = 0, height = 0;
  double f = 0;                                               // px; principal point in the middle
  std::array<double, 3> at{};                                 // in the world
  double toe_rad = 0;                                         // turn about y: positive looks towards +x
  std::array<double, 3> direction(double x, double y) const;  // in the world, not of unit length
  std::array<double, 2> pixel(std::array<double, 3> p) const;
};

struct ScanWorld {
  enum class Shape { plane, step, ball } shape = Shape::plane;
  double tilt = 0.2, distance = 0.7;  // z = distance + tilt x (left of x = 0.01 the step stands 12 mm nearer)
  double ball_x = 0, radius = 0.08;   // of the ball, whose middle lies at the distance and at ball_x
  Pinhole left{320, 240, 640, {-0.06, 0, 0}, 0.0873}, right{320, 240, 640, {0.06, 0, 0}, -0.0873};
  Pinhole projector{480, 360, 700, {0, -0.02, 0}, 0};
  double white = 0.7, ambient = 0.05;  // what the camera reads, 1: full
  double gain = 8000, read = 0.002;    // electrons at 1; of 1
  double gamma = 1;                    // of the projector
  double dark = 0, bright = 1;         // levels of what is sent beyond which it shows all alike
  int bits = 0;                        // of codes; 0: floats
  int across = 5;                      // places of a pixel that light is summed over, a side
  std::uint64_t seed = 1;
};

// Where a camera's ray meets the shape; nothing found: z is 0.
std::array<double, 3> met(const ScanWorld& world, const Pinhole& camera, double x, double y);
// Distance from the shape's surface along its normal, towards the cameras.
double off_shape(const ScanWorld& world, std::array<double, 3> p);
// Frame by frame what the camera reads: the mean over places of its pixel of what the projector shows there,
// whose pixels blend into their neighbours (linearly, a lens a little out of focus).
class Recorder {
 public:
  Recorder(const ScanWorld& world, const Pinhole& camera, const scan::Sequence& sequence);
  scan::CameraFrame operator()(std::size_t frame) const;

 private:
  ScanWorld world_;
  bool second_ = false;
  int width_ = 0, height_ = 0;
  scan::Sequence sequence_;
  std::vector<std::pair<float, float>> lit_;  // column and row of the projector; below -1: none
};
// Where the projector's pixel is that lights the camera's pixel.
std::array<double, 2> lit_by(const ScanWorld& world, const Pinhole& camera, int x, int y);

scan::Codes decoded(const ScanWorld& world, const Pinhole& camera, const scan::Sequence& sequence,
                    bool noise_stated = true);
scan::Station station_of(const Pinhole& camera);
// The cameras left, right and projector as a rig, and the sequence as the projection `name`.
std::string manifest_of(const ScanWorld& world);

}  // namespace gonio::tests
