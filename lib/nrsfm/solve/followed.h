// A sequence of tracks and a solver's reconstruction of it, in the form in which `explain` tests what the solver's
// camera model left out (the model itself: deforming_model.h). Outliers were found beforehand and are excluded
// (outliers.h). Rooms above include this header, so no matrix library is in it.
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

struct Run {  // outliers of one point in consecutive frames, first and last included; counted from 0
  std::size_t point = 0, first = 0, last = 0;
  std::array<double, 2> offset{};  // mean distance from the prediction
  double sigma = 0;                // standard error of one coordinate of that mean
};
struct Outliers {
  std::vector<Run> runs;         // by point, then frame
  std::size_t observations = 0;  // that were tested
  std::size_t found = 0;         // outliers among them
  double p = 1;                  // probability, under normal noise, of an observation as far out as the farthest
  double rms_offset = 0;         // of the outliers from their predictions
  std::size_t components = 0;  // basis shapes that the model lacks: shared by many points and frames, made by no camera
  double noise = 0;            // standard deviation of a coordinate, see robust_tracks.h
  // RMS distance of inliers in one half of a point's frames from their prediction by the other half, which was fitted
  // with or without the outliers.
  double held_out_with = 0, held_out_without = 0;
};

inline constexpr double beyond_noise = 1.5;  // RMS residual over noise from which on the model lacks something

// Test of perspective in the presence of as many basis shapes as the solver has, and of one more; see near_camera.h.
// Errors are RMS, in the tracks' unit.
struct NearCamera {
  static constexpr std::size_t stretches = 8;  // consecutive parts of the sequence, each judged by itself
  struct Step {
    std::size_t shapes = 0;
    double fitted_without = 0, fitted_with = 0, held_out_without = 0, held_out_with = 0;
    double log_gain = 0;                         // mean over points of log(held_out_without / held_out_with)
    double t_of_points = 0, t_of_stretches = 0;  // its t statistic over points, and over stretches of frames
    double kappa = 0, sigma = 0;
    double depth = 0;            // of the object along the line of sight, its largest value
    double surviving_share = 0;  // of perspective's signature that shapes and poses cannot imitate, 0 to 1
    double visible_from = 0;     // depth over distance from which on perspective would be significant
  };
  bool lacking = false;  // the model lacks basis shapes; if not, nothing else was computed
  std::vector<Step> steps;
  double of_a_shape = 0;                                // log gain of one more basis shape without perspective
  bool stands = false;                                  // perspective is named
  double sigma = 0, lower = 0, upper = 0;               // of kappa in the last step: standard error, 95 % interval
  std::vector<double> residual_without, residual_with;  // of the first step, (u, v) for each of seen(), point by point
};

class Followed {
 public:
  struct Parts;
  explicit Followed(std::shared_ptr<const Parts> parts);

  std::string sequence, reconstruction;          // ids
  bool free_scales = false;                      // the solver gave every frame a scale of its own
  std::optional<double> inverse_focal;           // of tracks.perspective, where the manifest has switched it on
  bool perspective = false;                      // the sequence states a perspective camera
  std::optional<std::array<double, 4>> pinhole;  // fx, fy, cx, cy in px, where the sequence states them
  std::size_t all_frames = 0, all_points = 0;
  std::vector<std::size_t> frames, points;  // that are used
  std::size_t terms = 0;                    // number of basis shapes
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
  const NearCamera& near_camera() const;   // computed at the first call
  const NearCamera* asked_nearby() const;  // null before that, or where no basis shapes are lacking

 private:
  std::shared_ptr<const Parts> parts_;
};

// Reconstructions in one frame of reference for the whole sequence, whose camera is (scaled) orthographic.
bool has_followed(const manifest::Document& document);
// One for each sequence, from its reconstruction with the smallest reprojection error among those that have few enough
// shapes for something to be asked of the tracks. `false_alarm`: probability that a sequence without outliers has one
// named. Error(data) where none of them does.
std::vector<Followed> followed_tracks(const manifest::Document& document, double false_alarm);
std::vector<std::filesystem::path> followed_files(const manifest::Document& document);

// How the mechanism tracks.outliers names what is hidden: "walking/point-7/frame-12", "walking/point-7/frames-12-40".
std::string hidden_name(const std::string& sequence, std::size_t point, std::size_t first, std::size_t last);

}  // namespace gonio::nrsfm
