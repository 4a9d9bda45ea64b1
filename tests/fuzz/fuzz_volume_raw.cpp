// Any bytes as raw samples, described by their first ones: a volume of numbers or one line of refusal.
#include "volume_input.h"

namespace gonio::io::volumes {
const VolumeFormat& raw();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size < 6) return 0;
  gonio::io::VolumeWish wish;
  wish.size = {{bytes[0], bytes[1], bytes[2]}};
  wish.type = static_cast<gonio::io::VoxelType>(bytes[3] & 7);
  wish.big_endian = (bytes[3] & 8) != 0;
  wish.skip_bytes = bytes[4];
  return gonio::fuzz::open_and_read(gonio::io::volumes::raw(), bytes + 5, size - 5, wish);
}
