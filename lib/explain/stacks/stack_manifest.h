// What a manifest already says of a stack's camera and lamps, and how named physics is written back.
//
// A named response is undone where the pictures are read: `response` of every image becomes the table of its inverse,
// composed with what was stated before, one for each channel. A black offset found with it is taken off there, too.
// Everything else becomes a mechanism that is switched on.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "explain/stacks/stack_input.h"
#include "inference/explanation.h"
#include "mechanism/mechanism.h"
#include "render/tone_curve.h"

namespace gonio::explain::stacks {

// Is the mechanism switched on for the camera, light or surface `target` (empty: for all)?
bool is_given(const manifest::Document& document, const std::string& id, const std::string& target);
std::optional<double> given_value(const manifest::Document& document, const std::string& id, const std::string& name,
                                  const std::string& target);

// A parameter as the mechanism declares it, under `full_name`; its neutral value is what the manifest already says.
// Parameters that no mechanism declares keep the presets of Parameter.
Parameter declared(const manifest::Document& document, const std::string& id, const std::string& name,
                   const std::string& full_name, const std::string& target, double size);

void state_responses(const Stack& stack, std::span<const render::Response> by_channel, double offset,
                     manifest::Document& document);

// Switches `candidate` on with the fitted values: one number a parameter, or one for each name in `on`, target by
// target.
void switch_on(const Candidate& candidate, const std::vector<std::string>& on, const Explanation& e,
               manifest::Document& document);

bool is_named(const Problem& problem, const Explanation& e, const std::string& id);

}  // namespace gonio::explain::stacks
