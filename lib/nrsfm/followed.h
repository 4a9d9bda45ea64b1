// A sequence with a solver's answer, brought to the form in which it can be asked what the solver's camera left out
// (deforming_model.h; no matrix library here, for the rooms above). Observations that do not follow have been found and
// take no part (outlying.h).
#pragma once
#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"

namespace gonio::nrsfm {

// Where each number stands in a vector of parameters.
struct Layout {
  std::size_t rotation = 0, shift = 0;  // of frame 0: three, two; those of frame f follow
  std::size_t scale = 0;                // logarithm of frame 1's (that of frame 0 is minus the sum)
  std::size_t weight = 0;               // of shapes over time, those that the solver's model does not fix
  std::size_t basis = 0;                // of point 0: 3 K, shape after shape
  std::size_t perspective = 0;          // kappa
  std::size_t count = 0;
};

struct Run {  // of one point, frames that follow each other; counted from 0
  std::size_t point = 0, first = 0, last = 0;
  std::array<double, 2> offset{};  // mean
  double sigma = 0;                // of a coordinate of the mean
};
struct Outliers {
  std::vector<Run> runs;         // by point, then frame
  std::size_t observations = 0;  // among so many ...
  std::size_t found = 0;         // ... so many lie outside
  double p = 1;                  // chance of one as far out as the farthest, where noise is normal
  double rms_offset = 0;         // of those found
  std::size_t components = 0;    // that many points have in many frames and no camera makes: of shapes that are lacking
  double noise = 0;              // one sigma of a coordinate, see robust_tracks.h
  // RMS distance of sound observations on one half of a point's frames from where the other half, with and without
  // those found, puts the point.
  double held_out_with = 0, held_out_without = 0;
};

inline constexpr double beyond_noise = 1.5;  // root mean square of what is left, over the noise: something is

// Perspective on top of as many shapes as the solver has, and one more; see near_camera.h. Distances are root mean
// squares, in the tracks' unit.
struct NearCamera {
  static constexpr std::size_t stretches = 8;  // of frames: witnesses over time
  struct Step {
    std::size_t shapes = 0;
    double fitted_without = 0, fitted_with = 0, held_out_without = 0, held_out_with = 0;
    double log_gain = 0;                         // held out, mean over points of log(without / with)
    double t_of_points = 0, t_of_stretches = 0;  // of that, by points and by stretches of frames
    double kappa = 0, sigma = 0;
    double depth = 0;            // largest, along the line of sight
    double surviving_share = 0;  // of its signature, after all that the shapes and frames can imitate
    double visible_from = 0;     // share of the distance that depths must reach for perspective to show
  };
  bool lacking = false;  // shapes, with weights free in every frame; nothing else is known where none is
  std::vector<Step> steps;
  double of_a_shape = 0;  // log gain of the next shape by itself
  bool stands = false;
  double sigma = 0, lower = 0, upper = 0;               // of the last step's kappa; 95 %
  std::vector<double> residual_without, residual_with;  // of the first step: two numbers for each of seen(), by points
};

class Followed {
 public:
  struct Parts;
  explicit Followed(std::shared_ptr<const Parts> parts);

  std::string sequence, reconstruction;          // ids
  bool free_scales = false;                      // the solver gave every frame a scale of its own
  std::optional<double> inverse_focal;           // switched on in the manifest: tracks.perspective
  bool perspective = false;                      // as the sequence says
  std::optional<std::array<double, 4>> pinhole;  // fx, fy, cx, cy, px; as the sequence says
  std::size_t all_frames = 0, all_points = 0;
  std::vector<std::size_t> frames, points;  // those that take part
  std::size_t terms = 0;                    // shapes
  std::array<double, 2> centre{};           // c0
  std::vector<double> shape_size;           // root mean square of a coordinate, of every shape
  Layout layout;
  std::vector<double> start;  // the solver's answer as parameters; kappa is 0
  Outliers outliers;

  const std::vector<std::size_t>& seen(std::size_t point) const;  // places of frames
  std::vector<double> observed(std::size_t point) const;          // two numbers for each of them
  void predict(std::span<const double> values, std::size_t point, std::span<double> prediction) const;
  void jacobian(std::span<const double> values, std::size_t point, std::span<const std::size_t> columns,
                std::span<double> derivatives) const;
  struct Place {
    std::array<double, 3> camera{};   // s q, from the shape's origin
    std::array<double, 2> picture{};  // without perspective, from c0
  };
  std::vector<Place> places(std::span<const double> values, std::size_t point) const;
  const NearCamera& near_camera() const;   // found at the first call
  const NearCamera* asked_nearby() const;  // null where nobody has called, or no shapes are lacking

 private:
  std::shared_ptr<const Parts> parts_;
};

// Reconstructions in one frame of reference for the whole sequence, whose camera is (scaled) orthographic.
bool has_followed(const manifest::Document& document);
// One for each sequence: of its reconstructions the one that reprojects best. `false_alarm`: of observations that do
// not follow, a sequence.
std::vector<Followed> followed_tracks(const manifest::Document& document, double false_alarm);
std::vector<std::filesystem::path> followed_files(const manifest::Document& document);

// How the mechanism tracks.outliers names what is hidden: "walking/point-7/frame-12", "walking/point-7/frames-12-40".
std::string hidden_name(const std::string& sequence, std::size_t point, std::size_t first, std::size_t last);

}  // namespace gonio::nrsfm
