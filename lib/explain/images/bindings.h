// The numbers of the search and what each of them sets: free parameters of the base model (surfaces, lights, images,
// mechanisms that the manifest switches on) and the amounts of candidate terms.
#pragma once
#include <string>
#include <vector>

#include "explain/engine.h"
#include "explain/images/model.h"
#include "manifest/sections/forward.h"
#include "relighting/scene_state.h"
#include "relighting/term.h"

namespace gonio::explain::images {

// One number in the scene's state.
struct Place {
  enum class Kind { surface, intensity, gain, amount } kind = Kind::surface;
  std::size_t target = 0;     // surface, light, image or use
  std::size_t parameter = 0;  // of the surface's model; of the use's amounts
  int component = -1;         // of an RGB value; -1: all three
};
double value_at(const SceneState& state, const Place& place);
void set_value(SceneState& state, const Place& place, double value);

// Where a parameter's fitted value goes in the manifest: surfaces/NAME/KEY, lights/NAME/KEY, images/N/gain,
// mechanisms/ID/KEY.
struct Origin {
  enum class Section { surfaces, lights, images, mechanisms } section = Section::surfaces;
  std::string name, key;
  std::size_t entry = 0;  // images
  std::size_t component = 0;
};

struct Bindings {
  std::vector<Parameter> parameters;
  std::vector<std::vector<Place>> places;    // what each sets (several where parameters share a name)
  std::vector<std::vector<Origin>> origins;  // empty for candidates' parameters
  std::vector<std::size_t> base;
  std::vector<Candidate> candidates;
  std::vector<std::size_t> use_of;  // candidate -> place among the uses

  void set(SceneState& state, std::span<const double> values) const;
};

// `uses`: the first `given` of them are the manifest's, the others are candidates.
Bindings bind_parameters(const manifest::Document& document, const Recordings& recordings, const SceneLayout& layout,
                         std::span<const Use> uses, std::size_t given);

// Fitted values, their sigmas and the named mechanisms into the document's sections.
void write_back(const Bindings& bindings, std::span<const Use> uses, const Explanation& explanation,
                manifest::Document& document);

}  // namespace gonio::explain::images
