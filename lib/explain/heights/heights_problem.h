// A height map as a problem for the engine: is the surface isotropic and rough, or has it a lay, a grating, ridges?
//
// Observations: ln of the power spectra of its tiles (explain/heights/tile_spectra.h), one group per tile; noise
// pi / sqrt(6) as of any spectrum. Base model: an isotropic spectrum, a free curve over the frequency, a level of its
// own for every tile, and rows that the instrument has shifted. Hypotheses: surface.anisotropy, surface.micro-ridges
// (explain/heights/spectrum_model.h). Structure longer than half a tile, or shorter than a fortieth of it or four
// points, is not looked at. Score: root mean square of ln P about its prediction; 1.28 is that of the right model.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "explain/engine.h"
#include "io/height_map.h"
#include "manifest/parameter.h"
#include "manifest/sections/forward.h"

namespace gonio::explain {

struct HeightsInput {
  std::string table, surface, place;  // names in "tables" and "surfaces"; for messages
  io::HeightMap map;
  manifest::Parameters ridges, lay;  // as the manifest has switched on: surface.micro-ridges, surface.anisotropy
  bool has_ridges = false, has_lay = false;
};

// Tables of the model "heights".
bool has_heights(const manifest::Document& document);
std::vector<HeightsInput> heights_inputs(const manifest::Document& document);
std::unique_ptr<Problem> heights_problem(HeightsInput input);

}  // namespace gonio::explain
