// Meshes of the manifest, in and out.
#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "tools/reassemble/work.h"

namespace gonio::tools::reassemble {
namespace {

const manifest::Object& object_named(const Work& work, const std::string& id) {
  const auto& objects = work.call.document.objects;
  const auto found = std::ranges::find(objects, id, &manifest::Object::id);
  if (found == objects.end())
    throw Error(Exit::data, manifest::place(work.call.document, "/objects"), "has no \"" + id + "\"", "");
  return *found;
}

}  // namespace

PlacedPieces placed_pieces(const Work& work) {
  PlacedPieces all;
  for (std::size_t p = 0; p < work.pieces.size(); ++p) {
    const reassembly::Placed& placed = work.placement.pieces[p];
    if (placed.verdict != reassembly::Verdict::placed) continue;
    auto own = std::make_unique<PlacedPiece>();
    own->piece = &work.pieces[p], own->placed = &placed;
    own->mesh = mesh::prepare(mesh_of(work, placed.object), mesh::Shading::flat, placed.object);
    own->tree = std::make_unique<mesh::TriangleTree>(own->mesh.positions_m, own->mesh.triangles);
    all.push_back(std::move(own));
  }
  return all;
}

std::vector<reassembly::PosedMesh> posed(const PlacedPieces& pieces) {
  std::vector<reassembly::PosedMesh> meshes;
  for (const auto& p : pieces) meshes.push_back({&p->mesh, p->tree.get(), p->placed->world_from_object});
  return meshes;
}

io::TriangleMesh mesh_of(const Work& work, const std::string& object) {
  const std::string& name = object_named(work, object).mesh;
  const manifest::Document& document = work.call.document;
  const std::string at = "/meshes/" + name + "/file";
  return io::read_ply(manifest::resolve(document, document.meshes.at(name).file, at));
}

io::TriangleMesh placed_mesh(const Work& work, const std::string& object) {
  io::TriangleMesh mesh = mesh_of(work, object);
  const auto& pose = object_named(work, object).world_from_object;
  if (!pose) return mesh;
  const Mat3 turn = matrix_of(pose->rotation);
  for (Vec3& p : mesh.positions_m) p = turn * p + pose->translation_m;
  for (Vec3& n : mesh.normals) n = turn * n;
  return mesh;
}

void enter_mesh(Work& work, const std::string& name, const io::TriangleMesh& mesh, const std::string& surface) {
  manifest::Document& document = work.call.document;
  if (!work.written.contains(name)) work.written[name] = work.call.output_path(file_stem(name) + ".ply");
  const std::filesystem::path& path = work.written.at(name);
  io::write_ply(path, mesh, {.properties = {}, .labels = false});
  manifest::Mesh& entry = document.meshes[name];
  entry.file = manifest::add_file(document, path, name);
  if (surface.empty()) return;
  const auto there = std::ranges::find(document.objects, name, &manifest::Object::id);
  manifest::Object object{.id = name, .mesh = name, .surface = surface, .world_from_object = {}};
  if (there == document.objects.end())
    document.objects.push_back(std::move(object));
  else
    *there = std::move(object);
}

}  // namespace gonio::tools::reassemble
