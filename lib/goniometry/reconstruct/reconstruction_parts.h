// Inside of reconstruction.cpp: observations as rows of a basis, their estimator, and its calibration. Notation:
// goniometry/reconstruct/reconstruction.h.
#pragma once
#include <Eigen/Core>
#include <cstdint>

#include "goniometry/reconstruct/reconstruction.h"

namespace gonio::goniometry {

struct Observed {
  Eigen::MatrixXd q;         // m x K
  Eigen::VectorXd y, noise;  // 1 / W
  Eigen::VectorXd own;       // variance of the samples alone, without what the basis leaves open
  std::vector<Cells::Blend> blend;
};
// One band of the samples; what is unusable goes to `dropped`.
Observed observe(const Basis& basis, const Samples& samples, std::size_t band, const ReconstructOptions& options,
                 std::vector<Dropped>& dropped);

// c ~ N(mean, factor factor').
struct Prior {
  Eigen::VectorXd mean;
  Eigen::MatrixXd factor;
};
Prior standard_prior(std::size_t components);

// c = prior.mean + gain (y - q prior.mean); its covariance is factor factor'.
struct Estimator {
  Eigen::MatrixXd gain, factor;
  Eigen::VectorXd estimate(const Observed& observed, const Prior& prior, const Eigen::VectorXd& y) const {
    return prior.mean + gain * (y - observed.q * prior.mean);
  }
};
Estimator map_estimator(const Observed& observed, const Prior& prior);
Estimator tikhonov_estimator(const Observed& observed, const Prior& prior, double eta_per_sample);
Estimator estimator(const Observed& observed, const Prior& prior, const ReconstructOptions& options,
                    std::size_t samples);

// y' (Q' L L' Q'' + 1 / W)^-1 y.
double chi2_of(const Observed& observed, const Prior& prior, const Eigen::VectorXd& y);
// By what the variances of the components and of noise and rest are multiplied; at least 1 each.
struct PriorScales {
  double prior = 1, noise = 1;
};
PriorScales likely_scales(const Observed& observed, const Prior& prior, const Eigen::VectorXd& y);
Observed scaled(const Observed& observed, const PriorScales& scales);
Prior scaled(const Prior& prior, const PriorScales& scales);

struct Calibration {
  Widening widening;
  double covered = 0;
};
Calibration calibrate(const Basis& basis, const Observed& observed, const ReconstructOptions& options);

}  // namespace gonio::goniometry
