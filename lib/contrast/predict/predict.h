// What contrast a surface will show: the experiment of contrast/predict/experiment.h carried out on a model, over
// tilts, pairs of rotations and values of the surface's parameters, with mean contrasts in the layout of Luongo et al.
// 2017, figure 8: one condition is kept constant, and all contrasts of the others are averaged.
//
// Angles in radians, parameters in the manifest's units. Signals are f cos(theta_i) in 1/sr, the mean of red, green
// and blue. Uncertainties: the surface's sigmas are drawn (normal, independent, cut at the parameters' bounds; JCGM
// 101:2008, section 7), a parameter that is varied with one error for all its values; a mean's sigma thereby holds what
// its contrasts share. Signals that come with errors of their own, as those of traced reliefs do, are drawn likewise.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "contrast/predict/experiment.h"
#include "contrast/predict/specimen.h"
#include "metric/exposure.h"

namespace gonio::contrast {

using metric::Estimate;
struct Varied {
  std::string parameter;
  std::vector<double> values;
};
struct Combination {
  std::vector<double> varied;  // one value per varied parameter
  double tilt_rad = 0;
  std::pair<double, double> pair_rad;
  Estimate first, second;          // signals at the pair's rotations
  Estimate difference, michelson;  // magnitudes
  bool first_brighter = true;
};
struct Stated {  // a number of the surface, its preset where none was given
  std::string parameter, unit;
  double value = 0;  // of a colour the mean
  std::string meaning;
};
struct Means {               // of the experiment's definition
  std::string over;          // "tilt", "rotation", or the varied parameter
  std::vector<double> at{};  // tilts, values; of rotations: their places in the list
  std::vector<std::string> label{};
  std::vector<Estimate> mean{};
};
struct Prediction {
  Experiment experiment;
  std::string surface, model;
  std::vector<Stated> stated;  // those that are not varied
  std::vector<Varied> varied;
  std::vector<Combination> combinations;
  std::vector<Means> means;            // tilt, each varied parameter, rotation
  Estimate mean;                       // of all
  std::vector<std::string> uncertain;  // parameters whose sigma entered: "ridge_rad 0.0087 rad"
  int draws = 0;
};

// Signals of every setting, tilt and rotation: of setting s, tilt t, rotation r at [(s * tilts + t) * rotations + r].
struct Signals {
  std::vector<double> value;
  std::vector<std::vector<double>> draws;  // empty: nothing is uncertain
};
std::vector<double> rotations_of(const Experiment& experiment);  // those of its pairs, each once
// Values of every combination of the varied parameters, the last running fastest; one empty setting without any.
std::vector<std::vector<double>> settings_of(const std::vector<Varied>& varied);

// Combinations and means of signals, whoever made them.
Prediction assembled(const Experiment& experiment, const std::vector<Varied>& varied, const Signals& signals);
// Independent normal errors of signals as draws.
Signals with_errors(std::vector<double> value, const std::vector<double>& sigma, int draws, std::uint64_t seed);

struct PredictOptions {
  Experiment experiment;
  std::vector<Varied> varied;
  int draws = 400;  // where parameters have a sigma
  std::uint64_t seed = 0;
};
// Error(usage) for an impossible experiment, a parameter that the model has not, values outside its bounds.
Prediction predict(const Specimen& specimen, const PredictOptions& options);

// The place of the largest mean of a condition.
std::size_t largest(const Means& means);

// Every combination, one a row: RFC 4180 with units in the names.
std::string combinations_csv(const Prediction& prediction);
std::string means_csv(const Prediction& prediction);
// ... and as entries of the manifest's section; differences and Michelson's contrasts signed there.
std::vector<manifest::Contrast> entries_of(const Prediction& prediction);

}  // namespace gonio::contrast
