// Mechanisms in a stack of exposures: one file each, exposures/<id with _>.cpp, which defines
// `const ExposureBinding& <id with _>()` in namespace gonio::explain::stacks::exposures; the build gathers them.
#pragma once
#include <span>

#include "explain/stacks/hot_pixels.h"
#include "explain/stacks/moved.h"
#include "explain/stacks/overflow.h"
#include "explain/stacks/reading_chain.h"
#include "explain/stacks/stack_binding.h"

namespace gonio::explain::stacks {

struct ExposureFacts {                       // of a stack, for bounds and starts
  double shortest_s = 0;                     // exposure
  bool timed = false;                        // every picture states its time
  std::span<const double> readings, linear;  // the latter: what a linear sensor would have read
  std::span<const MovedRegion> moved;
  const Overflow& overflow;
  const HotPixels& hot;
  std::span<const double> standing_out;  // by picture: odd_pictures.h
};

struct ExposureBinding {
  const mechanism::Mechanism& (*mechanism)() = nullptr;
  int order = 0;  // of numbers and candidates: ascending
  Written written = Written::as_mechanism;
  void (*enter)(StackEntry& entry, const ExposureFacts& facts) = nullptr;
  // What was entered, with these values, into the chain.
  void (*set)(std::span<const double> numbers, const Stack& stack, ReadingChain& chain) = nullptr;
};

std::span<const ExposureBinding* const> all_exposure_bindings();  // by name; defined in a generated source

}  // namespace gonio::explain::stacks
