// Lists that people type on the command line: `-20deg,0deg,20deg`, `0deg:90deg,90deg:180deg`,
// `ridge_rad=5deg,10deg`, `alpha_u=0.02:0.3`. Parameters take the unit that their model states. Error(usage) at the
// option names the piece that is wrong.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "base/assignment.h"
#include "base/error.h"
#include "base/quantity.h"
#include "manifest/model.h"

namespace gonio::tools::contrast {

std::vector<double> quantities(const std::string& text, Dimension dimension, const std::string& option);
std::vector<std::pair<double, double>> angle_pairs(const std::string& text, const std::string& option);

struct Assignment {
  std::string parameter;
  std::vector<double> values;
};
// NAME=VALUE,...; with `separator` ':' NAME=LOW:HIGH.
std::vector<Assignment> assignments(const std::vector<std::string>& texts, const std::string& option,
                                    const manifest::ModelInfo& model, char separator = ',');

// Error(usage) at --model with the known ones.
const manifest::ModelInfo& model_named(const std::string& id);

}  // namespace gonio::tools::contrast
