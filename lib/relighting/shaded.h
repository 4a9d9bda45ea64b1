// A picture's shading, and what it depends on: the key under which it is remembered (image_memo.h).
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "relighting/scene_state.h"
#include "relighting/shading.h"
#include "relighting/term.h"

namespace gonio::relighting {

struct Shaded {
  Shading plain;                   // of the surfaces and lamps alone
  std::optional<Shading> changed;  // by terms that shade, where one is in play
  const Shading& whole() const { return changed ? *changed : plain; }
};

// Every number of an edited state on which its shading depends. Without a term that shades that leaves out what scales
// light; with one, nothing but the numbers of terms that act later.
std::vector<double> shading_key(const SceneState& edited, std::span<const Use> uses);

}  // namespace gonio::relighting
