// Mechanisms in tables of reflectance: one file each, reflectance/<id with _>.cpp, which defines
// `const ReflectanceBinding& <id with _>()` in namespace gonio::explain::tables::reflectance; the build gathers them.
#pragma once
#include <span>
#include <vector>

#include "explain/tables/reflectance_parameters.h"
#include "mechanism/mechanism.h"

namespace gonio::explain::tables {

struct ReflectanceBinding {
  const mechanism::Mechanism& (*mechanism)() = nullptr;
  int order = 0;  // of numbers and candidates: ascending
  // mechanism: its parameters are those of a registered surface model, and act as `render` has them
  // (scene/mechanisms.h). Else the term of reflectance_surface.h that it is.
  ReflectanceSlot::Kind kind = ReflectanceSlot::Kind::mechanism;
  // Of kind mechanism: any of its numbers switches it on, and not the first alone.
  bool each_switches = false;
  // Of the others: where the rows show it on this surface, and the ranges of its numbers, one candidate of a family for
  // each; `given`: the manifest has switched it on, which leaves one range.
  bool (*shows)(const ReflectanceRows& rows, const SurfacePlaces& places) = nullptr;
  std::vector<std::vector<Parameter>> (*ranges)(const std::vector<Parameter>& declared, bool given) = nullptr;
};

std::span<const ReflectanceBinding* const> all_reflectance_bindings();  // by name; defined in a generated source

}  // namespace gonio::explain::tables
