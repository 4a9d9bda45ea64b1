// What prints name.
#include "manifest/codec.h"
#include "manifest/document_references_parts.h"
#include "manifest/sections/file.h"
#include "manifest/sections/ground_noise.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/print.h"
#include "manifest/sections/relief.h"

namespace gonio::manifest {

void check_prints(const Document& d) {
  for (const auto& [name, print] : d.prints) {
    const std::string at = place(d, "/prints/" + name);
    must_exist(d.files, "files", print.layers, at + "/layers");
    must_exist(d.ground_noises, "ground_noises", print.ground, at + "/ground");
    must_exist(d.reliefs, "reliefs", print.relief, at + "/relief");
    must_exist(d.meshes, "meshes", print.mesh, at + "/mesh");
    if (print.pixel_m.size() != 2)
      throw Error(Exit::data, at + "/pixel_m", "has " + std::to_string(print.pixel_m.size()) + " numbers",
                  "give two lengths [x, y]");
    for (std::size_t i = 0; i < print.measured.size(); ++i) {
      const std::string map = at + "/measured/" + std::to_string(i);
      must_exist(d.reliefs, "reliefs", print.measured[i].relief, map + "/relief");
      if (print.measured[i].at_m.size() != 2)
        throw Error(Exit::data, map + "/at_m", "has " + std::to_string(print.measured[i].at_m.size()) + " numbers",
                    "give two lengths [x, y]");
    }
    for (const auto& [key, use] : print.microstructures)
      must_exist(d.files, "files", use.file, at + "/microstructures/" + key + "/file");
    for (std::size_t i = 0; i < print.parts.size(); ++i) {
      const std::string part = at + "/parts/" + std::to_string(i);
      must_exist(d.meshes, "meshes", print.parts[i].mesh, part + "/mesh");
      must_exist(print.microstructures, "microstructures", print.parts[i].microstructure, part + "/microstructure");
      for (const auto& [label, use] : print.parts[i].labels)
        must_exist(print.microstructures, "microstructures", use, part + "/labels/" + label);
    }
  }
}

}  // namespace gonio::manifest
