// See errors.h.
#include "nrsfm/evaluate/errors.h"

#include <cmath>

#include "base/error.h"

namespace gonio::nrsfm {
namespace {

struct Sums {
  Eigen::Index points = 0;
  double distance = 0, square = 0;  // of x - q
  double truth_square = 0;          // of q
};

// Over the points of a frame that are finite in both.
Sums sums_of(const Aligned& a, Eigen::Index frame) {
  Sums s;
  const auto x = shape_of(a.shapes, frame), q = shape_of(a.truth, frame);
  for (Eigen::Index p = 0; p < x.cols(); ++p) {
    const double d2 = (x.col(p) - q.col(p)).squaredNorm();
    if (!std::isfinite(d2)) continue;
    ++s.points;
    s.square += d2;
    s.distance += std::sqrt(d2);
    s.truth_square += q.col(p).squaredNorm();
  }
  return s;
}

Sums sums_of(const Aligned& a) {
  Sums all;
  for (Eigen::Index f = 0; f < a.shapes.rows() / 3; ++f) {
    const Sums s = sums_of(a, f);
    all.points += s.points, all.distance += s.distance, all.square += s.square;
  }
  return all;
}

// Mean over frames and axes of the population standard deviation of the truth.
double sigma_of(const Shapes& truth) {
  double sum = 0;
  Eigen::Index axes = 0;
  for (Eigen::Index row = 0; row < truth.rows(); ++row) {
    double n = 0, mean = 0, square = 0;
    for (Eigen::Index p = 0; p < truth.cols(); ++p)
      if (std::isfinite(truth(row, p))) n += 1, mean += truth(row, p);
    if (n == 0) continue;
    mean /= n;
    for (Eigen::Index p = 0; p < truth.cols(); ++p)
      if (std::isfinite(truth(row, p))) square += (truth(row, p) - mean) * (truth(row, p) - mean);
    sum += std::sqrt(square / n);
    ++axes;
  }
  if (axes == 0 || sum <= 0)
    throw Error(Exit::data, "truth", "has no extent, so that errors have nothing to be relative to");
  return sum / static_cast<double>(axes);
}

}  // namespace

double e3d(const Aligned& aligned) {
  return mean_distance(aligned) / sigma_of(aligned.truth);
}

double nrmse(const Aligned& aligned) {
  double sum = 0;
  Eigen::Index frames = 0;
  for (Eigen::Index f = 0; f < aligned.shapes.rows() / 3; ++f) {
    const Sums s = sums_of(aligned, f);
    if (s.points == 0) continue;
    if (s.truth_square <= 0)
      throw Error(Exit::data, "truth", "has no extent in frame " + std::to_string(f), "nrmse is relative to it");
    sum += std::sqrt(s.square / s.truth_square);
    ++frames;
  }
  return sum / static_cast<double>(frames);
}

double rmse(const Aligned& aligned) {
  const Sums s = sums_of(aligned);
  return std::sqrt(s.square / static_cast<double>(s.points));
}

double mean_distance(const Aligned& aligned) {
  const Sums s = sums_of(aligned);
  return s.distance / static_cast<double>(s.points);
}

double e3d(const Shapes& x, const Shapes& truth, Alignment alignment) {
  return e3d(align(x, truth, alignment));
}
double nrmse(const Shapes& x, const Shapes& truth, Alignment alignment) {
  return nrmse(align(x, truth, alignment));
}
double rmse(const Shapes& x, const Shapes& truth, Alignment alignment) {
  return rmse(align(x, truth, alignment));
}
double mean_distance(const Shapes& x, const Shapes& truth, Alignment alignment) {
  return mean_distance(align(x, truth, alignment));
}

}  // namespace gonio::nrsfm
