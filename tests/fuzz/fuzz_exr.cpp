// Any bytes as an OpenEXR file: an image or Error(data), never anything else.
#include <cstdint>
#include <string>

#include "base/error.h"
#include "io/exr.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  try {
    gonio::io::decode_exr({reinterpret_cast<const char*>(bytes), size}, "fuzz.exr");
  } catch (const gonio::Error& error) {
    if (error.code() != gonio::Exit::data) __builtin_trap();
  }
  return 0;
}
