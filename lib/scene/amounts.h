// The numbers of a mechanism as a manifest states them, for one of the targets that it names.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "mechanism/mechanism.h"

namespace gonio::scene {

using Amounts = std::vector<double>;  // one per parameter of the mechanism, in its order

std::string place_of(const std::string& place, const std::string& name);

// One target's amounts: number `index` of `count` names; what is left out is neutral. Error(data) at `place` for
// parameters that the mechanism does not have and for wrong counts.
Amounts amounts_of(const mechanism::Mechanism& mechanism, const manifest::MechanismUse& use, std::size_t index,
                   std::size_t count, const std::string& place);

// Those of target `name`, where the manifest has the mechanism switched on for it (or for all, naming none).
std::optional<Amounts> amounts_on(const manifest::Document& document, const mechanism::Mechanism& mechanism,
                                  const std::string& name);

bool neutral(const mechanism::Mechanism& mechanism, std::span<const double> amounts);

}  // namespace gonio::scene
