// The grey values about an outline, fitted: a cone, one blur and the shading of a limb for all of it, two planes of
// grey for each sector. For detect*.cpp only.
//
// The sum of squares over all pixels near the outline is minimised over four numbers (axis across, axis down, half
// angle, blur); everything else enters linearly and is eliminated exactly (variable projection: Golub & Pereyra, SIAM
// J. Numer. Anal. 10, 1973, with Kaufman's Jacobian). How much a sector may depart from what is common is learnt.
// Pixels are never interpolated, so their noise stays independent and its covariance is what the normal equations say;
// what is correlated beyond that shows in the sectors' own positions.
#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "optim/descent.h"
#include "reassembly/detect_edge_model.h"
#include "reassembly/detect_parts.h"

namespace gonio::reassembly {

struct FinePixel {
  Vec3 ray;
  double value = 0, along = 0;  // along: of the sector, tangentially, in its half lengths
  double weight = 1;            // less where the shading's model is coarser than the noise
  double t = 0;                 // from the outline inwards, blur's shift counted
  Blurred step, ramp, limb;
};
// Greys of a sector: 1, t, along; and inside: 1, t, along, limb. All but the two constants vary smoothly along most
// outlines: what they have in common is a constant and one wave round the outline, and each sector departs from that.
constexpr std::size_t local_terms = 7, cone_terms = 4, waves = 3;
constexpr std::array<std::size_t, 5> smooth_terms{1, 2, 4, 5, 6};
constexpr std::size_t common_terms = smooth_terms.size() * waves;

struct FineSector {
  double turn = 0, px_per_rad = 0, bend_px = 0;  // bend: radius of curvature of the outline; pixels of the level
  std::vector<FinePixel> pixels;
  std::array<double, local_terms> mean{};  // what the outline has in common there,
  std::array<double, local_terms> part{};  // and how the sector departs from it
  bool active = false;                     // takes part in the fit
  bool agrees = false;
  double variance = 1;                    // of its pixels about the fit
  double squares = 0;                     // their sum
  double move_px = 0, move_sigma_px = 0;  // by which this sector alone would move the outline inwards
  double contrast = 0;                    // inside less outside, grey levels
};

class FineFit final : public optim::Descent {
 public:
  FineFit(const Pyramid& pyramid, const camera::CameraModel& camera, const Cone& cone, int level, double blur_px);

  // Pixels about the cone as it stands; the sectors that were active stay so.
  bool gather();
  // To the least squares of the active sectors; false where they do not determine a cone.
  bool descend_all(int most_steps);
  // How steep the planes of grey are, by those of all sectors: where the background is even, no sector needs a slope of
  // its own, and the outline is known the better for it.
  void learn_slopes();
  // Each sector's own opinion, by which the caller chooses the active ones.
  void judge_sectors();
  void expect_contrast(double grey_levels) { contrast_ = grey_levels; }  // for the next gather()

  const Cone& cone() const { return cone_; }
  double blur_px() const { return blur_; }
  double scale() const { return level_.scale; }
  std::vector<FineSector>& sectors() { return sectors_; }
  // Of the axis across and down and the half angle, by the pixels' noise alone. False: not determined.
  bool covariance(Mat3& rad2);

  void linearise() override;
  optim::Proposal propose(double damping) override;
  double evaluate() override;
  void accept() override;

 private:
  double solve_linear();
  std::array<double, local_terms> ridge(const FineSector& sector) const;
  std::array<double, common_terms> common_ridge() const;
  void fill(const Cone& cone, double blur);
  void derivative(const FineSector& sector, const FinePixel& pixel, double& by_t, double& by_blur) const;
  double grey(const FineSector& sector, const FinePixel& pixel) const;

  const camera::CameraModel& camera_;
  const PictureLevel& level_;
  cv::Mat values_, usable_;  // the part of the level about the outline
  int x0_ = 0, y0_ = 0;
  Cone cone_, next_cone_;
  double blur_ = 1, next_blur_ = 1, noise_ = 1;
  double contrast_ = 0;  // grey levels
  double window_in_ = 0, window_out_ = 0, radius_ = 0;
  std::vector<FineSector> sectors_;
  std::array<double, common_terms> common_{};
  std::array<double, local_terms> hold_;  // 1 / variance of how sectors depart; 0: free
  Eigen::Matrix4d normal_;
  Eigen::Vector4d downhill_, change_;
};

}  // namespace gonio::reassembly
