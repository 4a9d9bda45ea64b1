// What an explanation says of things that moved in a stack of exposures.
#pragma once
#include <string>

#include "explain/engine.h"
#include "explain/stacks/moved.h"

namespace gonio::explain::stacks {

// Readings in the boxes that the manifest's own scene.moved states count no longer. Error(data) at a number that is
// missing or lies outside the picture.
void leave_out_stated(const manifest::Document& document, Stack& stack);

void conclude_moved(const Problem& problem, const Moved& moved, std::size_t candidate, Explanation& e);
std::string moved_remark(const Stack& stack, const Moved& moved);  // empty where nothing moved
// Each box with its surroundings, once as its picture shows it and once as the next picture does, at equal exposure.
void add_moved(const Stack& stack, const Moved& moved, Illustration& result);

}  // namespace gonio::explain::stacks
