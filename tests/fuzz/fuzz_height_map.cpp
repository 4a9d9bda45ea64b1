// Any bytes as a height map: as many points as its size says and steps that are lengths, or Error(data).
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "io/height_map.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  try {
    const auto map = gonio::io::parse_height_map({reinterpret_cast<const char*>(bytes), size}, "fuzz.sur");
    if (map.z_m.size() != map.width * map.height || !(map.step_x_m > 0) || !(map.step_y_m > 0)) __builtin_trap();
  } catch (const gonio::Error& error) {
    if (error.code() != gonio::Exit::data) __builtin_trap();
  }
  return 0;
}
