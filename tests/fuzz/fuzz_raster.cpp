// Any bytes as a PNG, JPEG, TIFF, BMP or TGA file: an image or Error(data), never anything else.
#include <cstdint>
#include <string>

#include "base/error.h"
#include "io/raster.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  try {
    gonio::io::decode_raster({reinterpret_cast<const char*>(bytes), size}, "fuzz.png");
  } catch (const gonio::Error& error) {
    if (error.code() != gonio::Exit::data) __builtin_trap();
  }
  return 0;
}
