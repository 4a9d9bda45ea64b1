// Poses, lamps and what else is free by rims and pictures together: least squares about an answer of the rims.
//
//   minimise  d' C^-1 d  +  1 / inflation  sum over pixels and colours  rho((y - exp(a + b) L(s)) / sigma)  +  (a, b)
//   priors
//
// d: change of the freedoms from the rims' answer, C its covariance (fit.h); L: picture_model.h; a: a factor for each
// surface and colour, of its albedo; b: one for each unknown brightness and colour. sigma: the recording's noise and,
// by what is left, a share of what is shown, for each photograph and surface; `inflation` makes of pixels as many as
// are independent (picture_noise.h). rho is Cauchy's. Slopes by settings are central differences of pictures half a
// pixel apart.
//
// The covariance is H^-1 M H^-1 with M by the likeness of neighbours, colours and photographs, as for rims.
#pragma once
#include <Eigen/Core>

#include "alignment/fit.h"
#include "alignment/picture_model.h"
#include "alignment/picture_noise.h"

namespace gonio::alignment {

struct PictureFit {
  Setting setting;
  Eigen::MatrixXd covariance;  // of the freedoms' numbers; zeros for what is held
  Eigen::MatrixXd rims;        // C^-1 of the rims' answer
  double cost = 0;
  std::size_t numbers = 0;  // of the freedoms, that were free
  PictureNoise noise;
  std::vector<double> relative_before, relative_after;  // of each image: rms of what is left over rms of what is seen
};

// Central differences of the pictures by each number of the freedoms: [number][3 * row + colour]; empty for numbers
// that `free` leaves out.
std::vector<std::vector<double>> picture_slopes(const PictureModel& model, const Setting& at,
                                                const std::vector<Freedom>& freedoms, const std::vector<bool>& free);

// What settings leave of the pictures, rms over what is seen, where each surface's colours under each brightness have
// the factor that suits them best: for settings far apart.
double share_left(const PictureModel& model, const Setting& setting);

// From `rims`, whose covariance is that of `freedoms`. `most_steps` of the last descent. The noise is measured, or
// taken from another fit to the same model, so that costs can be compared.
PictureFit fit_pictures(const PictureModel& model, const Fitted& rims, const std::vector<Freedom>& freedoms,
                        const PictureNoise* noise = nullptr);

}  // namespace gonio::alignment
