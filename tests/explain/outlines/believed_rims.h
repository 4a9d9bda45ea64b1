// A simulated world's rims (alignment/alignment_world.h) beside a model of it in which something is wrong.
#pragma once
#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "alignment/alignment_world.h"
#include "explain/outlines/outlines_problem.h"

namespace gonio::tests {

// What somebody would have who knows where everything stands, but not `wrong`.
inline explain::OutlinesInput believed(alignment::testing::World& world,
                                       const std::function<void(alignment::Setting&)>& wrong, bool lamps_held = false) {
  using alignment::Block;
  alignment::AlignmentInput& in = world.input;
  in.stated = world.truth;
  for (std::size_t b = 0; b < in.stated.bodies.size(); ++b) in.stated.bodies[b].shape = &in.shapes[b];
  wrong(in.stated);
  std::erase_if(in.question.freedoms, [&](const alignment::Freedom& f) {
    return f.block == Block::body_scale || (lamps_held && f.block == Block::lamp_shift);
  });
  in.question.contacts.clear();
  in.question.stated = in.stated;
  in.ground = "table", in.bodies = {"solid"}, in.cameras = {"camera"};
  in.lamps.clear(), in.images_of_station.clear();
  for (std::size_t l = 0; l < in.stated.lamps_m.size(); ++l) in.lamps.push_back("lamp-" + std::to_string(l));
  for (std::size_t s = 0; s < in.stated.stations.size(); ++s)
    in.images_of_station.push_back({"view-" + std::to_string(s)});
  for (std::size_t k = 0; k < in.rims.size(); ++k) {
    const auto& subject = in.question.sightings[k].subject;
    in.rims[k].image = "view-" + std::to_string(subject.station) +
                       (subject.lamp ? "-" + std::to_string(*subject.lamp) : std::string());
  }
  return explain::outlines_of(std::move(in), std::vector<double>(world.truth.lamps_m.size(), 0.0));
}

}  // namespace gonio::tests
