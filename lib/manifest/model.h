// Registered models of surfaces, lights and cameras, as the manifest sees them: names, units, bounds, defaults. One
// file per model declares its ModelInfo beside its equations; the build gathers them (cmake/registry.cmake), and
// reading, validation, schemas and man pages walk the list. The functions are defined in generated sources.
#pragma once
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "manifest/parameter.h"

namespace gonio::manifest {

struct ParameterInfo {
  std::string name;    // as in JSON, unit included: "radius_m"
  std::string unit;    // "m", "rad", "1", "W/sr", "px", ...
  int components = 1;  // 1, or 3 for RGB or a vector; an RGB parameter also takes one number for all three
  bool rgb = false;
  std::optional<double> preset;  // value when left out; nullopt: required
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  std::string meaning;
};
enum class Family { surface, light, law, microstructure };
enum class Attachment { none, picture, table };  // the file that a model needs: pixels, or a table that it reads itself
struct ModelInfo {
  Family family;
  std::string id;        // "diffuse", "point", ...
  std::string sentence;  // what it is, in one plain sentence
  std::string source;    // paper, equation
  std::vector<ParameterInfo> parameters;
  Attachment attachment = Attachment::none;
  std::string attachment_meaning{};  // what the file holds
  // A picture's values are those of its file; else those of whole numbers are sRGB.
  bool attachment_as_sent = false;
  bool takes_base = false;         // surfaces: lies on another surface, `base`
  bool takes_environment = false;  // lights: the attachment may be one of the manifest's environments
  bool takes_expression = false;   // micro-structures: says itself what it is, `expression`
};

std::span<const ModelInfo* const> models(Family family);            // sorted by id
const ModelInfo* find_model(Family family, const std::string& id);  // null pointer where there is none

// Values in the order of model.parameters, presets filled in, a single number spread over all three components.
// Error(data) at `place` for unknown names, missing ones, wrong counts, and values outside the bounds.
std::vector<Vec3> values_of(const ModelInfo& model, const Parameters& parameters, const std::string& place);

}  // namespace gonio::manifest
