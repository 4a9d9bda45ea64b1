// Devices with faults, and a book of what was really so. A camera's picture shows its own truth: its pixels are noise
// about the light that fell on them, of which the book keeps the state and the exposure.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/run/instrument.h"
#include "base/random.h"

namespace gonio::acquisition::testing {

struct Faults {                  // probabilities, each of one frame
  double stuck_exposure = 0;     // the exposure of the frame before is kept
  double late_chunk = 0;         // the figures are those of the frame before
  double silent_late_chunk = 0;  // ... and so is the frame number that they say they belong to
  double old_frame = 0;          // the frame before is sent again
  double lost_packets = 0;       // some are missing
  double no_frame = 0;           // none comes
  double dead_lamp = 0;          // says that it is on and is not
  double lamp_forgets = 0;       // goes off by itself after it was read back
  double nudged = 0;             // the table turns a little during the exposure
};

// Not a probability: noise of pixels that depends on the state and the exposure alone.
inline constexpr std::uint64_t same_noise = 0;  // as a seed

struct Truth {
  double exposure_s = 0, angle_rad = 0;
  std::vector<std::string> lamps;  // that shone
};
struct Book {
  std::map<std::vector<std::uint16_t>, Truth> shown;  // by the frame's samples
  std::map<std::string, int> injected;                // faults by name
};

// Cameras, lamps, turntables of the names given.
Instrument faulty_instrument(const std::vector<std::string>& cameras, const std::vector<std::string>& lamps,
                             const std::vector<std::string>& tables, const Faults& faults, std::uint64_t seed,
                             std::shared_ptr<Book> book);

}  // namespace gonio::acquisition::testing
