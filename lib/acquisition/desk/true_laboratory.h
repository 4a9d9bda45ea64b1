// A laboratory on a desk: devices that answer as the description says they would, and pictures of what is really so.
//
// What is really so is the description, changed by a second document that no client sees: its mechanisms (any of the
// registry: those of robots act on the arms, all others on the pictures), and where it has them its own lights,
// surfaces, meshes, cameras, objects (all of them) and laboratory (mounts, lamps' places, the turntable's axis). Arms
// report the joints that they were sent to; cameras see from where the true arm holds them; what a turntable deforms
// has the shape of its angle (scene/deformed.h). Pictures are rendered by room render at that state, through the whole
// sensor chain with its noise, and become codes: code = black_code + v full, rounded, clipped at `white`;
// v = codes_per_radiance_s * exposure / full * radiance as the chain reads it, full that of the file (255 or 65535):
// amounts of the sensor's mechanisms are in the unit of the frames' linear values.
// Time is simulated: motions and exposures take what they would, and nobody waits.
//
// The pixels of a frame depend on the state, the exposure and the seed alone: a frame taken again is the same frame.
#pragma once
#include <cstdint>
#include <memory>

#include "acquisition/laboratory/laboratory.h"
#include "acquisition/run/instrument.h"
#include "manifest/sections/forward.h"

namespace gonio::acquisition {

struct DeskOptions {
  std::uint64_t seed = 1;
  int spp = 64;
};

// All devices of the document's laboratory, whatever their URLs say. The documents are copied.
// Error(data) where the truth names what the description has not.
Instrument desk_instrument(const manifest::Document& believed, const manifest::Document* truth,
                           const DeskOptions& options);

}  // namespace gonio::acquisition
