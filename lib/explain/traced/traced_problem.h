// Pictures of what the path tracer alone can simulate, as a problem for the engine.
//
// Observations: sampled pixels, three colours each (explain/traced/sampled.h says which, and what the groups are).
// Prediction: explain/traced/traced_model.h. Noise: the recording's, at the local mean of the picture, the tracer's
// own, and half a percent of the radiance. The score is the relative RMSE.
//
// Free in the base model: what the manifest frees (brightnesses of lamps and of pictures, numbers of surfaces and of
// mechanisms), and what it states to a sigma, within it: poses of objects and places of lamps. Asked: what light does
// in the thing (volume.absorption, volume.index, surface.directional-subsurface), the roughness of its surface and how
// that varies, and what was stated without a sigma.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "explain/domain.h"
#include "explain/engine.h"
#include "manifest/sections/forward.h"

namespace gonio::explain::traced {

struct Options {
  std::vector<std::filesystem::path> repeats{};  // further takes, from which noise is measured
  std::size_t pixels = 1800;                     // in all pictures together
  double paths = 4e6;                            // of the scene as it was given, in all pictures together
};
// A scene has the directional dipole or the standard one: a small share of it is something else's.
std::optional<Testimony> traced_objection(const Problem& problem, const Explanation& e, std::size_t candidate);
std::unique_ptr<Problem> traced_problem(const manifest::Document& document, const Options& options = {});

}  // namespace gonio::explain::traced
