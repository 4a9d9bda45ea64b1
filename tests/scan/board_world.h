// A checkerboard that a projector lights and a camera sees, both with lenses that bend, by closed forms that share
// nothing with the library. Metres; axes x right, y down, z forward; the camera is the world.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "camera/board.h"
#include "camera/calibration.h"
#include "scan/decode.h"
#include "scan/projector_corners.h"
#include "scan/sequence.h"

namespace gonio::tests {

struct BentLens {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0, k1 = 0, k2 = 0;
  std::array<double, 2> pixel(std::array<double, 3> p) const;
  std::array<double, 3> direction(double u, double v) const;  // z is 1
};
struct Turned {  // p' = R(axis * angle) p + t, Rodrigues
  std::array<double, 3> turn{}, shift{};
  std::array<double, 3> operator()(std::array<double, 3> p) const;
};

struct BoardWorld {
  BentLens camera{320, 240, 416, 417, 162, 118, -0.12, 0.05};
  BentLens projector{480, 360, 700, 703, 236, 300, -0.09, 0.04};  // its axis leaves the picture low, as of most
  Turned projector_from_camera{{0.03, 0.28, 0.02}, {-0.165, -0.085, 0.03}};
  int columns = 9, rows = 6;  // inner corners
  double square = 0.022;
  double white = 0.8, black = 0.05, around = 0.3;  // albedo; about the board a wall in its plane
  double projected = 0.75, ambient = 0.05;         // what white reads; 1 is full
  double gain = 600, read = 0.004;                 // electrons at 1
  int across = 3, at_edges = 16;                   // places of a pixel that light is summed over, a side
  bool mirrored = false, exchanged = false;        // what the projector truly does with the picture's columns
  // Of board poses: tilted all round, over the whole picture.
  std::vector<Turned> poses(int count) const;
  camera::Board board() const;
};

// What the camera reads of every frame but for noise, as shares of full light; one after the other.
std::vector<std::vector<float>> light_of(const BoardWorld& world, const Turned& camera_from_board,
                                         const scan::Sequence& sequence);
// With noise; the frame's number decides it, too.
scan::CameraFrame read_with_noise(const BoardWorld& world, const std::vector<float>& light, std::uint64_t seed);

// Camera 0 and projector 1 over all poses, from frames with the noise of this seed.
class BoardSession {
 public:
  BoardSession(BoardWorld world, scan::Sequence sequence, int poses);
  std::vector<camera::View> views(std::uint64_t seed) const;
  scan::CameraFrame frame(std::size_t pose, std::size_t frame, std::uint64_t seed) const;
  // Of one pose: what the camera's white picture shows, what its pixels are told, and what follows for the projector.
  camera::Detection seen(std::size_t pose, std::uint64_t seed) const;
  scan::Codes codes(std::size_t pose, std::uint64_t seed) const;
  scan::ProjectorCorners corners(std::size_t pose, std::uint64_t seed) const;
  camera::CalibrationSetup setup() const;
  const BoardWorld& world() const { return world_; }

 private:
  BoardWorld world_;
  scan::Sequence sequence_;
  std::vector<std::vector<std::vector<float>>> light_;  // pose, frame
};

// Cosines with numbers of periods, columns and rows, and a white picture at the end.
scan::Sequence cosines_and_white(const BoardWorld& world, std::vector<double> periods, int shifts);

}  // namespace gonio::tests
