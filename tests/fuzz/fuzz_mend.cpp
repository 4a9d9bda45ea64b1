// Any triangles between a few places of a coarse lattice, mended: a closed mesh with a volume, or Error(data).
#include <cstdint>

#include "base/error.h"
#include "mesh/verdict.h"
#include "print/mend.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size < 4 || size > 200) return 0;
  gonio::io::TriangleMesh mesh;
  const std::size_t places = 4 + bytes[0] % 12;
  std::size_t at = 1;
  for (std::size_t i = 0; i < places && at < size; ++i, ++at)
    mesh.positions_m.push_back({bytes[at] % 5 * 1.0, bytes[at] / 5 % 5 * 1.0, bytes[at] / 25 % 5 * 1.0});
  for (; at + 3 <= size; at += 3)
    mesh.triangles.push_back({static_cast<std::uint32_t>(bytes[at] % mesh.positions_m.size()),
                              static_cast<std::uint32_t>(bytes[at + 1] % mesh.positions_m.size()),
                              static_cast<std::uint32_t>(bytes[at + 2] % mesh.positions_m.size())});
  try {
    const auto mended = gonio::print::mend(mesh, {.largest_hole_m = 3}, "fuzz.stl");
    if (!(mended.volume_m3 > 0) || !gonio::mesh::soundness(mended.mesh).closed()) __builtin_trap();
  } catch (const gonio::Error& error) {
    if (error.code() != gonio::Exit::data) __builtin_trap();
  }
  return 0;
}
