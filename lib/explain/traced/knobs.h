// The numbers of the search and how each changes pictures.
//
// For each that changes more than a pixel by itself the tracer makes the pictures anew at some values, its nodes; in
// between they are interpolated. What is true of pictures that differ in one number alone is taken to add up (or, of
// what takes light away on its path, to multiply) where several differ; the answer is held against a picture that is
// traced with all of them (Problem::bias).
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "explain/engine.h"
#include "explain/traced/roughness.h"
#include "manifest/sections/forward.h"
#include "relighting/recordings.h"
#include "scene/scene.h"

namespace gonio::explain::traced {

// A series of pictures: what changes in the scene, and where it is looked at. `set` is not called at the node that is
// `stated`, where the scene is as it was given.
struct Response {
  std::vector<double> nodes;  // ascending
  double stated = 0;
  std::function<void(manifest::Document&, double)> set;
  bool fine = false;  // of roughness, whose pictures share no noise with the stated one: more samples
  std::vector<std::vector<double>> radiance{};  // [node][row], once it was traced
};

enum class Acts {
  adds,        // what the response says less that at its stated node
  multiplies,  // the same, as a factor
  brightness,  // a factor by itself, 1 as stated
  alpha,       // Roughness, and so on in its order
  more,
  slopes,
  layers,
  layer_m,
  layer_offset_m,
  reach_m,
  polish
};

struct Knob {
  Parameter parameter;
  Acts acts = Acts::adds;
  std::size_t response = 0;           // of what adds or multiplies
  int channel = -1;                   // -1: all three
  std::size_t surface = 0;            // of a roughness: place among those in question
  std::vector<std::size_t> images{};  // of a brightness: places in Recordings::images
};

// What is free in the base model (no mechanism), or asked. `write`: into the manifest, the values and sigmas of its
// knobs; empty: a roughness, which is written for all its knobs together.
struct Question {
  const mechanism::Mechanism* mechanism = nullptr;
  std::vector<std::string> on{};
  std::vector<std::size_t> knobs{};
  std::function<void(manifest::Document&, std::span<const double>, std::span<const double>)> write{};
};

// A surface in question.
struct Asked {
  std::string name;
  std::size_t surface = 0;  // place in scene.appearance.surfaces
  bool rough = false;       // its alpha is one number
  Roughness stated{};
  std::size_t response = 0;  // of its alpha, where it is rough
};

struct Knobs {
  std::vector<Asked> surfaces;
  std::vector<Response> responses;
  std::vector<Knob> knobs;
  std::vector<Question> questions;
};
Knobs knobs_of(const manifest::Document& document, const relighting::Recordings& recordings, const scene::Scene& scene,
               std::span<const std::size_t> surfaces);

}  // namespace gonio::explain::traced
