// What is left between photographs and model, and how much of it is one error: neighbouring pixels, the three colours
// and photographs of one place under several lamps miss alike where shading is not what the model says. Private to
// alignment/.
//
//   E[z_a z_b] = likeness of colours * repetition * k(distance of a and b),   k(d > 0) = nugget * exp(-d / reach_px)
// for whitened, weighted residuals z of pixels of one photograph and one surface; the kernel is positive definite, and
// has the measured value nearby and the measured sum over the plane.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "alignment/picture_model.h"
#include "alignment/rim_offsets.h"

namespace gonio::alignment {

struct PictureNoise {
  std::vector<double> relative;  // [image * surfaces + surface]: of what the model shows, beside the stated noise
  double nugget = 0, reach_px = 1;
  double colours = 0;         // correlation of one pixel's colours
  double repeated = 1;        // variance of a mean, over that if photographs from one place were independent
  double inflation = 1;       // of the variance of a mean over all rows, over that if they were independent
  double correlation_px = 1;  // side of a square of pixels whose errors are one error
};

// Standard deviations of all values, three for each row.
std::vector<double> sigmas_of(const PictureModel& model, const std::vector<double>& relative,
                              const std::vector<double>& shown);
// `residual`: observed less shown; `fitted`: how many numbers were fitted to it.
PictureNoise noise_of(const PictureModel& model, const std::vector<double>& residual, const std::vector<double>& shown,
                      double fitted);
// The covariance of sum over rows g_r z_r for independent z of variance one, made of likeness as above. `slopes`: three
// rows for each of the model's, g in rows.
Eigen::MatrixXd scattered(const PictureModel& model, const PictureNoise& noise, const Eigen::MatrixXd& slopes);

// Of a whitened residual: Cauchy's, everywhere.
inline Loss picture_loss() {
  return {.width = 2.5, .reach = 1e9};
}

}  // namespace gonio::alignment
