// Any bytes as a picture of tiles: a volume of numbers or one line of refusal. The first byte says how many tiles.
#include "volume_input.h"

namespace gonio::io::volumes {
const VolumeFormat& atlas();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t columns = bytes[0] & 15u, rows = bytes[0] >> 4;
  return gonio::fuzz::open_and_read(gonio::io::volumes::atlas(), bytes + 1, size - 1, {.tiles = {{columns, rows}}});
}
