// Any bytes as an STL file: a mesh whose triangles name vertices that exist, or Error(data).
#include <cmath>
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "io/stl.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  try {
    const auto mesh = gonio::io::parse_stl({reinterpret_cast<const char*>(bytes), size}, "fuzz.stl");
    for (const auto& triangle : mesh.triangles)
      for (const auto vertex : triangle)
        if (vertex >= mesh.positions_m.size()) __builtin_trap();
    for (const auto& p : mesh.positions_m)
      if (!gonio::is_finite(p)) __builtin_trap();
  } catch (const gonio::Error& error) {
    if (error.code() != gonio::Exit::data) __builtin_trap();
  }
  return 0;
}
