// One candidate's fit as numbers: which are free, residuals of rows, and normal equations that know which number moves
// which band.
//
// Unknowns x: first what bands share, S of them, then C colours of band 0, of band 1, ...: a residual of band b depends
// on S + C numbers, and the normal equations are gathered as blocks S x S, S x C and C x C per band.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "goniometry/fit/fit.h"

namespace gonio::goniometry {

struct Slot {  // one free parameter of a model
  std::size_t parameter = 0;
  double lower = 0, upper = 1;
  bool logarithmic = false;  // steps are taken of its logarithm
  bool periodic = false;     // an azimuth: beyond a bound it goes on at the other
};

struct Candidate {
  const surface::Model* model = nullptr;
  std::string variant;
  int lobes = 1;
  surface::Values held;  // of what is not free
  std::vector<Slot> shared, colours;
  std::size_t unknowns(std::size_t bands) const { return shared.size() + bands * colours.size(); }
  const std::string& name(const Slot& slot) const { return model->info().parameters[slot.parameter].name; }
  std::vector<surface::Values> triples(const std::vector<double>& x, std::size_t bands) const;
};

using Rows = std::vector<std::uint32_t>;

struct Normal {  // of 1/2 sum r^2: H = J'J, g = -J'r is downhill; in natural units
  Eigen::MatrixXd h;
  Eigen::VectorXd downhill;
  double cost = 0;  // sum r^2
  std::size_t observations = 0;
};

class Problem {
 public:
  Problem(const Samples& samples, Scale scale);

  const Samples& samples() const { return *samples_; }
  Scale scale() const { return scale_; }
  std::size_t bands() const { return samples_->bands(); }
  const Rows& rows() const { return rows_; }
  bool used(std::size_t row, std::size_t band) const { return inverse_spread_[row * bands() + band] > 0; }

  // What the model may be wrong by beside the noise, `share` of tolerance(), about these values; `noise` alone.
  void set_model_error(double share, const std::vector<double>& about);
  // (1 + w m) / w with w = 100 ci co: what is one on the scale log(1 + w m). Relative where there is light, absolute
  // where the model has none and the sample has some.
  double tolerance(std::size_t row, double m) const { return 1 / weight_[row] + std::max(0.0, m); }
  std::vector<double> predictions(const Candidate& candidate, const std::vector<double>& x) const;
  double model_error() const { return model_error_; }

  Normal normal(const Candidate& candidate, const std::vector<double>& x, const Rows& rows) const;
  // That J: a row for each of rows() and bands, zero where it takes no part.
  Eigen::MatrixXd slopes(const Candidate& candidate, const std::vector<double>& x) const;
  // Residual of the fit's scale; prediction m.
  double residual(std::size_t row, std::size_t band, double m) const;
  // Predictions of every band of a row.
  void predict(const Candidate& candidate, const std::vector<surface::Values>& triples, std::size_t row,
               std::vector<double>& m) const;
  double log1p_residual(std::size_t row, std::size_t band, double m) const;

 private:
  struct Gather;
  void gather(const Candidate& candidate, const std::vector<surface::Values>& triples, std::size_t row,
              Gather& sum) const;
  double slope(std::size_t row, std::size_t band, double m) const;  // -d residual / d m

  const Samples* samples_;
  Scale scale_;
  Rows rows_;                           // with anything to fit
  std::vector<double> weight_;          // 100 ci co
  std::vector<double> scaled_;          // what the scale makes of f
  std::vector<double> inverse_spread_;  // of the noise scale; 1 otherwise; 0: does not take part
  double model_error_ = 0;
};

struct Solution {
  std::vector<double> x;
  Normal at;
  bool converged = false;
  int iterations = 0;
};
// Bounded Levenberg-Marquardt (Marquardt 1963): columns scaled to unit length, what presses against a bound held there.
Solution solve(const Problem& problem, const Candidate& candidate, std::vector<double> x, const Rows& rows,
               int iterations);

// Slot of unknown i.
const Slot& slot_of(const Candidate& candidate, std::size_t i);

}  // namespace gonio::goniometry
