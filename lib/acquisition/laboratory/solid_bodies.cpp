// See solid_bodies.h.
#include "acquisition/laboratory/solid_bodies.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/ply.h"
#include "io/stl.h"
#include "manifest/document.h"
#include "manifest/sections/laboratory.h"

namespace gonio::acquisition {

Solid solid_of(const manifest::Document& document, const manifest::SolidBody& body, const std::string& pointer) {
  const std::string place = manifest::place(document, pointer);
  const int shapes = (body.box_m.empty() ? 0 : 1) + (body.ball_m ? 1 : 0) + (body.cylinder_m.empty() ? 0 : 1) +
                     (body.mesh.empty() ? 0 : 1);
  if (shapes != 1)
    throw Error(Exit::data, place, "has " + std::to_string(shapes) + " shapes where 1 is expected",
                "give one of box_m, ball_m, cylinder_m, mesh");
  Solid solid;
  solid.name = body.name;
  if (!body.box_m.empty()) {
    if (body.box_m.size() != 3)
      throw Error(Exit::data, place + "/box_m",
                  "has " + std::to_string(body.box_m.size()) + " numbers where 3 are expected", "give its full sides");
    solid.sides_m = {body.box_m[0], body.box_m[1], body.box_m[2]};
  } else if (body.ball_m) {
    solid.shape = Solid::Shape::ball;
    solid.sides_m.x = *body.ball_m;
  } else if (!body.cylinder_m.empty()) {
    if (body.cylinder_m.size() != 2)
      throw Error(Exit::data, place + "/cylinder_m",
                  "has " + std::to_string(body.cylinder_m.size()) + " numbers where 2 are expected",
                  "give [radius, length]");
    solid.shape = Solid::Shape::cylinder;
    solid.sides_m = {body.cylinder_m[0], body.cylinder_m[1], 0};
  } else {
    put_mesh(manifest::resolve(document, body.mesh, pointer + "/mesh"), solid);
  }
  return solid;
}

void put_mesh(const std::filesystem::path& path, Solid& solid) {
  const std::string file = read_file(path), name = path.filename().string();
  io::TriangleMesh mesh = file.starts_with("ply") ? io::parse_ply(file, name) : io::parse_stl(file, name);
  if (mesh.triangles.empty()) throw Error(Exit::data, name, "has no triangles", "export it again");
  solid.shape = Solid::Shape::mesh;
  solid.vertices_m = std::move(mesh.positions_m);
  solid.triangles = std::move(mesh.triangles);
}

}  // namespace gonio::acquisition
