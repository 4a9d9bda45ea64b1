// What explain makes of a stack of exposures.
#pragma once
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "data.h"
#include "explain/engine.h"
#include "explain/stacks/exposures_problem.h"
#include "explain/stacks/stack_world.h"
#include "manifest/document.h"

namespace gonio::explain::stacks {

using tests::ExposureWorld;

struct Outcome {
  manifest::Document document;
  std::unique_ptr<Problem> problem;
  Explanation explanation;
  std::vector<std::string> named;
  double value(const std::string& parameter) const {
    for (const Estimate& e : explanation.estimates)
      if (problem->parameters()[e.parameter].name == parameter) return e.value;
    return std::nan("");
  }
};

inline Outcome run(const manifest::Document& document, double smallest_effect = 0.01) {
  Outcome r;
  r.document = document;
  std::vector<std::unique_ptr<Problem>> problems = exposures_problems(document);
  r.problem = std::move(problems.at(0));
  Options options;
  options.smallest_effect = smallest_effect;
  r.explanation = explain(*r.problem, options);
  for (const std::size_t c : r.explanation.named) r.named.push_back(r.problem->candidates()[c].id());
  return r;
}

inline Outcome run(const ExposureWorld& world, double smallest_effect = 0.01) {
  const tests::ScratchFolder folder;
  return run(record(world, folder.path()), smallest_effect);
}

// A film: toe, straight part, shoulder; 1 at 1.
inline double film(double light) {
  const double x = std::pow(std::max(1e-9, light) * 6, 0.9);
  return x / (x + 1) * (std::pow(6.0, 0.9) + 1) / std::pow(6.0, 0.9);
}

}  // namespace gonio::explain::stacks
