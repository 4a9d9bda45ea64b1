// Options of dlp-slice, and what its call asks for.
#pragma once
#include <string>
#include <vector>

#include "cli/program.h"
#include "geom/vector.h"

namespace gonio::tools::dlp_slice {

std::vector<cli::Option> options();

enum class Action { slice, sample, growth, predict, wish };
Action action_of(const cli::Invocation& call);
// Error(usage) for options that the action does not take, or lacks.
void check_options(const cli::Invocation& call, Action action);

std::vector<double> lengths_of(const std::string& text, std::size_t count, const std::string& place);  // "1mm,2mm", m
Vec3 direction_of(const cli::Invocation& call);  // --direction, where --axes asks for one; Error(usage)
// "HEIGHT:THICKNESS,...": from a height on layers of that thickness; m.
struct LayerStep {
  double from_m = 0, layer_m = 0;
};
std::vector<LayerStep> layer_steps(const std::string& text, const std::string& place);

}  // namespace gonio::tools::dlp_slice
