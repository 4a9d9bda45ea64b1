// Any bytes as an OBJ file: a mesh whose triangles name vertices that exist, or Error(data).
#include <cmath>
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "io/obj.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  try {
    const auto mesh = gonio::io::parse_obj({reinterpret_cast<const char*>(bytes), size}, "fuzz.obj");
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
