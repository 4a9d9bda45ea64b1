// The two arms of the studio round an empty table, on which something is to deform: its drive is a turntable of the
// laboratory, so that plans turn it and every frame says how far; what it deforms is the truth's matter, which no
// client sees. World: as in the studio.
#include "acquisition/desk/specimen_laboratory.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"

namespace gonio::acquisition {

manifest::Document specimen_stage(const std::filesystem::path& out) {
  manifest::Document document = specimen_studio(out);
  std::filesystem::remove(out / "knot.ply");
  document.files.erase("knot");
  document.meshes.erase("knot");
  document.surfaces.erase("knot");
  std::erase_if(document.objects, [](const manifest::Object& object) { return object.id == "knot"; });
  manifest::Laboratory& lab = document.laboratory.entry.front();
  manifest::LaboratoryTurntable& drive = lab.turntables["drive"];
  drive.url = "sim://";
  drive.deforms = {"sheet", "sheet-rig"};
  drive.speed_rad_per_s = 0.5;
  drive.acceleration_rad_per_s2 = 1;
  lab.obstacles.back() = box_body("stage", {0.32, 0.2, 0.14}, {0, 0, 0.07});
  return document;
}

}  // namespace gonio::acquisition
