// Uses of terms: those that the manifest switches on, those that may be asked, and the rule for surfaces.
#pragma once
#include <optional>

#include "relighting/term.h"

namespace gonio::relighting {

// A use with one set of numbers for the whole scene, from the mechanism's own bounds and start.
Use scene_use(const mechanism::Mechanism& mechanism);
// One use for several targets; `shared`: one set of numbers for all.
Use target_use(const mechanism::Mechanism& mechanism, std::vector<std::string> on, std::vector<std::size_t> targets,
               bool shared);

// The same use in each of its mechanism's forms, alternatives of one family; itself where there is one alone.
std::vector<Use> in_forms(const Use& use);

// A use for the lamps that `fits` and on which the manifest has not switched the mechanism on; nothing where none is.
std::optional<Use> lamps_use(const Setting& setting, const mechanism::Mechanism& mechanism, bool shared,
                             bool (*fits)(const Setting& setting, std::size_t light));

// Do distant lamps stand for surroundings: three or more at once in a picture?
bool lamps_surround(const Setting& setting);

// Terms that move the same lamps are alternatives.
inline constexpr const char* lamps_place = "place of the lamps";

// Alternatives of one family: each of the lamps with numbers of its own, one lamp of several alone and, where asked,
// all with the same numbers, as if they hung on one frame. Numbers act on the pictures that their lamp is on in.
std::vector<Use> all_or_one_lamp(const Setting& setting, const mechanism::Mechanism& mechanism,
                                 const std::string& family, bool on_one_frame,
                                 bool (*fits)(const Setting& setting, std::size_t light));

// The images on which a light is on; empty: all.
std::vector<std::size_t> lit_by(const Recordings& recordings, std::size_t light);
// Has the manifest this mechanism on the target (or at all)?
bool switched_on(const manifest::Document& document, const std::string& id, const std::string& target = "");

// What the manifest's `mechanisms` section says. Their numbers' `start` is the manifest's value. Mechanisms of boards
// and of the lens, which have acted when rays are known, are left out.
std::vector<Use> given_uses(const Setting& setting);
// What explain may ask, in the order of their ids.
std::vector<Use> candidate_uses(const Setting& setting);

}  // namespace gonio::relighting
