// A world of calibration boards that shares no code with lib/: rays are traced from bent boards through a lens given by
// the angle of the ray, corners are found with the noise of a real detector. What it makes are sealed cases: a manifest
// that a user would write, and, apart from it, the truth.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace gonio::prove {

struct LensTruth {
  // Radius on the image over focal length, of a ray at tan(angle) = t: t (1 + k1 t^2 + k2 t^4 + k3 t^6), or, where
  // `division` is set, the inverse of t = r / (1 + division r^2) (Fitzgibbon 2001): a lens that no polynomial describes
  // exactly.
  double k1 = 0, k2 = 0, k3 = 0, division = 0;
  double p1 = 0, p2 = 0;  // decentring
  double s1 = 0, s3 = 0;  // prism
  double pupil_m = 0;     // the ray at the angle a from the axis goes through (0, 0, pupil sin^2 a)
  // Red and blue are drawn larger by these at the axis, and by these more at tan(angle) = 1, with the square of the
  // radius on the image.
  double red = 0, blue = 0, red_more = 0, blue_more = 0;
};
struct BoardTruth {
  // The board is bent to a circular arc about its middle with these heights at the middle, along x and along y.
  double sag_x_m = 0, sag_y_m = 0;
  double stretch_x = 0;  // anisotropic print, share of the length
  double uneven_m = 0;   // columns stand aside by up to this, in a pattern of their own
};
struct DriftTruth {  // while the camera warms up: per kelvin
  double focal = 0, x_px = 0, y_px = 0;
};
struct CaseTruth {
  std::vector<std::string> effects;  // canonical ids; empty: nothing was left out
  bool outside = false;              // an effect that the library lacks
  LensTruth lens;
  BoardTruth board;
  double wave_px = 0;     // periodic error over the image's columns (outside the library)
  double rolling_px = 0;  // way of the board's middle over the image between the first row's reading and the last's,
                          // in a direction of its own in every view
  DriftTruth drift;
  double bias_x_px = 0;  // of the detector, along the rows of the picture that it searches
};
// How the case is recorded, and what the manifest's camera knows.
struct CaseDesign {
  int width_px = 640, height_px = 480, columns = 9, rows = 6;
  double focal_px = 540, square_m = 0.025;
  double least_noise_px = 0.06, most_noise_px = 0.16;
  double misplaced = 1.0 / 300;  // share of corners that are
  bool knows_lens = false;       // the base model has k1, k2, p1, p2
  bool coloured = false;         // every corner is found in red, green and blue
  bool frontal = false;          // all views face the board, from one range, the camera upright
  int takes = 1;                 // photographs of each pose; more than one: a fixed target, and the manifest says so
  double warming_K = 0;          // from the first photograph to the last; the manifest states temperatures
  bool turned = false;           // in every second picture the corners are sought upside down
};
struct BoardCase {
  std::string name, manifest;  // JSON text, corner table inline
  CaseTruth truth;
};

// `views` photographs, by default of a 9 x 6 board of 25 mm squares with a 640 x 480 camera. Stated sigma 0.1 px; the
// true noise differs from it, grows with obliqueness, and one corner in 300 is misplaced.
BoardCase board_case(const std::string& name, const CaseTruth& truth, std::size_t views, std::uint64_t seed,
                     const CaseDesign& design = {});

// All sealed cases of the boards domain, in a shuffled order.
std::vector<BoardCase> all_board_cases(std::uint64_t seed, std::size_t repeats);

}  // namespace gonio::prove
