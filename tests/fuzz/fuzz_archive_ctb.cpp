// Any bytes as an archive of this format: layers of one size or one line of refusal.
#include "archive_input.h"

namespace gonio::print::archives {
const ArchiveFormat& ctb();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return gonio::fuzz::open_and_read(gonio::print::archives::ctb(), bytes, size);
}
