// Any bytes as a MERL table: as many numbers as its bins say, all finite, or Error(data).
#include <cmath>
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "io/merl.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  try {
    const auto table = gonio::io::parse_merl({reinterpret_cast<const char*>(bytes), size}, "fuzz.binary");
    if (table.brdf_per_sr.size() != 3 * table.cells()) __builtin_trap();
    for (const float value : table.brdf_per_sr)
      if (!std::isfinite(value)) __builtin_trap();
  } catch (const gonio::Error& error) {
    if (error.code() != gonio::Exit::data) __builtin_trap();
  }
  return 0;
}
