// The covariance of a fit to rims, whose errors are alike along them (fit.h). Private to alignment/.
#pragma once
#include <Eigen/Core>

#include "alignment/fit.h"

namespace gonio::alignment {

// Fills covariance and correlation_px of `f`, whose setting and sightings stand. `h`: J'WJ of all terms,
// and `by_points` that of the points alone.
void find_covariance(Fitted& f, const Question& q, Eigen::MatrixXd h, const Eigen::MatrixXd& by_points);

}  // namespace gonio::alignment
