// What non-rigid structure from motion is given, and what it gives back.
//
// P points are followed over F frames. Every matrix has a column per point; its rows go by frame:
//   tracks  2F x P   rows 2f, 2f + 1:       x (right) and y (down) of frame f in the image
//   shapes  3F x P   rows 3f, 3f + 1, 3f + 2: x, y, z of frame f in a frame of reference
//   visible  F x P
// The model of the literature is  tracks_f = K_f (R_f S_f + t_f),  R_f the upper two rows of camera_from_object (the
// camera's axes: x right, y down, z forward) and K_f the identity (orthographic), a number (weak perspective) or a
// pinhole (perspective). Lengths are metres where a file says so; solvers of orthographic models recover shapes up to
// one similarity, so that the unit of their answer is the tracks'.
#pragma once
#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gonio::nrsfm {

using Tracks = Eigen::MatrixXd;
using Shapes = Eigen::MatrixXd;
using Visible = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

enum class Projection { orthographic, perspective };

// In which frame of reference shapes stand: `object` is one for the whole sequence (the world of a camera that moves
// about a thing that deforms); `camera` is each frame's own camera, as depth estimators answer.
enum class ShapeFrame { object, camera };

// x_px = fx X / Z + cx, y_px = fy Y / Z + cy.
struct Pinhole {
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
};

// Of one frame: p_camera = rotation * p_object + translation.
struct CameraFromObject {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

// Factors of an experiment and their levels: {"deformation": "bending", "path": "circle", "camera": "perspective",
// "missing": "with"}; of a reconstruction besides {"algorithm": "pta"}.
using Factors = std::map<std::string, std::string>;

struct Sequence {
  std::string name;
  Projection projection = Projection::orthographic;
  std::optional<Pinhole> pinhole;  // where perspective and known
  Tracks tracks;                   // NaN where not visible
  Eigen::MatrixXd sigma;           // F x P, of visible tracks, each coordinate, in their unit; empty: not known
  Visible visible;                 // never empty: all true where nothing is missing
  std::optional<Shapes> truth;     // also of points that are not visible
  ShapeFrame truth_frame = ShapeFrame::object;
  std::vector<CameraFromObject> cameras;  // true ones, one per frame; empty: not known
  double unit_m = 0;                      // length of the truth's unit, metres; 0: not known
  Factors factors;

  Eigen::Index frames() const { return tracks.rows() / 2; }
  Eigen::Index points() const { return tracks.cols(); }
  bool complete() const { return visible.all(); }
  double missing_share() const { return 1 - visible.cast<double>().mean(); }
};

struct Reconstruction {
  std::string name;      // "pta", as the table of results calls it
  std::string sequence;  // name of what was reconstructed
  Shapes shapes;         // NaN where nothing was estimated
  ShapeFrame frame = ShapeFrame::object;
  std::vector<Eigen::Matrix<double, 2, 3>> rotations;  // rows of camera_from_object per frame; empty: not estimated
  Factors factors;

  Eigen::Index frames() const { return shapes.rows() / 3; }
  Eigen::Index points() const { return shapes.cols(); }
};

// One frame of shapes as a 3 x P block.
inline auto shape_of(const Shapes& shapes, Eigen::Index frame) {
  return shapes.middleRows<3>(3 * frame);
}
inline auto shape_of(Shapes& shapes, Eigen::Index frame) {
  return shapes.middleRows<3>(3 * frame);
}

// Shapes of `frame` camera as they stand in each frame's camera: R_f S_f + t_f. Needs one camera per frame.
Shapes in_cameras(const Shapes& object_shapes, const std::vector<CameraFromObject>& cameras);

// Error(data) at `place` where the sizes do not fit each other, fewer than 2 frames or 4 points are there, or a visible
// track is not finite.
void check(const Sequence& sequence, const std::string& place);

}  // namespace gonio::nrsfm
