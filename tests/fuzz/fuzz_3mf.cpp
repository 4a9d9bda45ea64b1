// Any bytes as the XML of a 3MF model: a mesh whose triangles name vertices that exist, or Error(data).
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "io/model_3mf.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  try {
    const auto mesh = gonio::io::parse_3mf_model({reinterpret_cast<const char*>(bytes), size}, "fuzz.3mf");
    for (const auto& triangle : mesh.triangles)
      for (const auto vertex : triangle)
        if (vertex >= mesh.positions_m.size()) __builtin_trap();
  } catch (const gonio::Error& error) {
    if (error.code() != gonio::Exit::data) __builtin_trap();
  }
  return 0;
}
