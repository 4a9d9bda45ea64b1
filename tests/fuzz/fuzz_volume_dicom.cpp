// Any bytes as a file of this format: a volume of numbers or one line of refusal.
#include "volume_input.h"

namespace gonio::io::volumes {
const VolumeFormat& dicom();
}

// GDCM's JPEG decoder keeps its tables where it gives up; the program ends there.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libgdcmjpeg";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return gonio::fuzz::open_and_read(gonio::io::volumes::dicom(), bytes, size);
}
