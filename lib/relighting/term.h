// Optional terms of the simulator of images. A mechanism that acts on images is one file, terms/<id with _>.cpp, which
// defines `const Term& <id with _>()` in namespace gonio::relighting::terms; the build gathers them. Mechanisms of
// surfaces need none where a registered surface model has their parameters (the rule of scene/mechanisms.h); a file
// replaces that rule.
//
// A term is bound to a problem as one or more uses: the targets that it acts on and its numbers, one set of the
// mechanism's parameters for each target or one for all. The amounts of every use are part of the scene's state. A use
// whose amounts are all neutral is passed over, so that the prediction is that of the base model to the last bit.
//
// Four hooks, from the scene to the file; a term has those that it needs:
//   edit    parameters of surfaces, lights, images: the state that the image is simulated with
//   shade   direct light of facets, per unit of the lamps' intensity (relighting/shading.h)
//   add     radiance of pixels, before the camera: what needs geometry of its own
//   record  values of pixels as the camera writes them; links of render/sensor_chain.h, in its order
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mechanism/mechanism.h"
#include "relighting/recordings.h"
#include "relighting/scene_state.h"
#include "render/ray_caster.h"
#include "scene/scene.h"

namespace gonio::relighting {

class ImageModel;
struct Shading;
struct Term;
struct ViewCache;

// What a term builds once from geometry and recordings for one use of it.
struct Prepared {
  virtual ~Prepared() = default;
};

// A number of the search: one of the mechanism's parameters for one set of targets.
struct Number {
  double neutral = 0, start = 0, lower = 0, upper = 0;
  bool free = true;                      // false: `start` is known from the recordings and goes with the others
  std::vector<std::size_t> groups{};     // images on which it acts; empty: all
  std::optional<std::size_t> same_as{};  // an earlier free number of the use, whose value it has
};

struct Use {
  const mechanism::Mechanism* mechanism = nullptr;
  const Term* term = nullptr;
  std::vector<std::string> on{};       // names of the targets
  std::vector<std::size_t> targets{};  // their places: surfaces, lights, instances, cameras' views
  std::size_t sets = 1;                // of parameters: one, or one for each target
  std::vector<Number> numbers{};       // [set][parameter]
  std::string family{};                // of the candidate; empty: the mechanism and its targets
  bool finer = false;                  // Candidate::finer
  std::shared_ptr<const Prepared> prepared{};
  std::size_t place = 0;  // among the model's uses: SceneState::amounts[place]
  bool in_play = false;   // the manifest has it switched on; else a hypothesis

  std::size_t set_of(std::size_t target) const { return sets == 1 ? 0 : target; }
  // The parameters of the target number `target` in `on`, in the mechanism's order.
  std::span<const double> amounts(const SceneState& state, std::size_t target = 0) const {
    const std::size_t n = mechanism->parameters.size();
    return {state.amounts[place].data() + n * set_of(target), n};
  }
  // Has it no effect? What is no hypothesis but known of one (a reference, a period read off the recordings) has none
  // while all that is free is neutral.
  bool neutral(const SceneState& state) const;
  std::span<const double> neutral_amounts() const { return neutral_; }
  std::vector<double> neutral_{};  // one set, in the mechanism's order
};

class FineViews;
struct Places;
struct EdgeSlopes;
// What several terms need: built by the first that asks.
struct Shared {
  std::shared_ptr<const FineViews> fine;  // relighting/fine_views.h
  std::shared_ptr<const Places> places;   // relighting/shifted_views.h
  std::shared_ptr<EdgeSlopes> edges;      // the same; filled once pixels are picked
};

// What a term may look at when it says where it applies and what it builds.
struct Setting {
  const manifest::Document& document;
  const scene::Scene& scene;
  const render::RayCaster& caster;
  const Recordings& recordings;
  const SceneLayout& layout;
  const ImageModel& model;             // of the base
  const SceneState* fitted = nullptr;  // where amounts are settled: what is built need hold for these alone
  Shared* shared = nullptr;
};

// The pixels of one image that are simulated together.
struct Frame {
  std::size_t number = 0;  // of the image
  const Recording& image;
  const ViewCache& cache;
  std::span<const std::uint32_t> picked;
  const SceneState& state;  // edited
  const ImageModel& model;
};

// How much of a prediction has to be computed anew where an amount changes.
enum class Reach { record, add, shade, compose, surfaces, all };

struct Term {
  const mechanism::Mechanism& (*mechanism)() = nullptr;
  Reach reach = Reach::record;
  int order = 0;  // of `add` and `record` hooks: ascending
  // Where these recordings give it something to act on. Uses that the manifest has switched on are not offered again.
  std::vector<Use> (*candidates)(const Setting&) = nullptr;
  std::shared_ptr<const Prepared> (*prepare)(const Setting&, const Use&) = nullptr;
  void (*edit)(const Use&, std::size_t image, const SceneLayout&, const Recordings&, SceneState&) = nullptr;
  void (*shade)(const Use&, const Frame&, Shading&) = nullptr;
  void (*add)(const Use&, const Frame&, std::span<double> radiance) = nullptr;
  void (*record)(const Use&, const Frame&, std::span<double> values) = nullptr;
  bool anew = false;                               // add: cheap, done anew wherever what it is added to changes
  bool pointwise = false;                          // record: of a value it asks no other one
  bool gradual = false;                            // Candidate::gradual
  std::optional<std::size_t> share_of_readings{};  // Candidate's: which of a set's numbers
  // Terms whose `add` is costly: derivatives of what they add by their own numbers, one column for each of `numbers`.
  void (*slopes)(const Use&, const Frame&, std::span<const std::size_t> numbers, std::span<double> columns) = nullptr;
};

std::span<const Term* const> all_terms();  // sorted by name; defined in a generated source
const Term* find_term(const std::string& id);

}  // namespace gonio::relighting
