// glTF files of other programs, sound and damaged.
#include "base/error.h"
#include "exchange_cases.h"
#include "io/ply.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"

namespace gonio::scene {
namespace {

using testing::HasSubstr;

// A triangle under a mirror-scaled, sheared node, as binary glTF with 16-bit indices and interleaved vertices.
std::string binary_gltf(std::string json, const std::string& bytes) {
  const auto word = [](std::size_t v) {
    std::string w(4, '\0');
    for (std::size_t i = 0; i < 4; ++i) w[i] = static_cast<char>(v >> 8 * i & 0xff);
    return w;
  };
  while (json.size() % 4 != 0) json += ' ';
  const std::string body = word(json.size()) + "JSON" + json + word(bytes.size()) + std::string("BIN\0", 4) + bytes;
  return "glTF" + word(2) + word(12 + body.size()) + body;
}

std::string triangle_bytes() {
  std::string bytes;
  const auto add = [&bytes](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const float v : {0.f, 0.f, 0.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f})
    add(v);
  for (const std::uint16_t v : {0, 1, 2, 0}) add(v);
  return bytes;
}

const std::string triangle_json = R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
 "nodes": [{"scale": [-2, 1, 1], "translation": [1, 2, 3], "mesh": 0}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
               {"bufferView": 0, "byteOffset": 12, "componentType": 5126, "count": 3, "type": "VEC3"},
               {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
 "bufferViews": [{"buffer": 0, "byteLength": 72, "byteStride": 24}, {"buffer": 0, "byteOffset": 72, "byteLength": 6}],
 "buffers": [{"byteLength": 80}]})";

Imported read_binary(const std::string& json, const std::string& bytes) {
  tests::ScratchFolder folder;
  write_file(folder / "t.glb", binary_gltf(json, bytes));
  return importer_of(folder / "t.glb").read(folder / "t.glb");
}

TEST(ExchangeGltf, ForeignFilesWithMirrorsAndStrides) {
  const Imported imported = read_binary(triangle_json, triangle_bytes());
  ASSERT_EQ(imported.document.objects.size(), 1u);
  const Vec3 at = imported.document.objects[0].world_from_object->translation_m;
  EXPECT_LT(norm(at - Vec3{1, -3, 2}), 1e-12);
  const io::TriangleMesh mesh = io::parse_ply(imported.files.at(0).content, "t.ply");
  // (x, y, z) of the file at (-2 x, -z, y); the mirror turns the corners.
  EXPECT_LT(norm(mesh.positions_m[1] - Vec3{-2, 0, 0}) + norm(mesh.positions_m[2] - Vec3{0, 0, 1}), 1e-6);
  EXPECT_LT(norm(mesh.normals[0] - Vec3{0, -1, 0}), 1e-6);
  const auto& t = mesh.triangles.at(0);
  const Vec3 facing =
      cross(mesh.positions_m[t[1]] - mesh.positions_m[t[0]], mesh.positions_m[t[2]] - mesh.positions_m[t[0]]);
  EXPECT_GT(dot(facing, mesh.normals[0]), 0);
  EXPECT_EQ(imported.document.surfaces.begin()->second.model, "metal");  // the specification's own material
}

TEST(ExchangeGltf, DamagedFilesAreRefusedAtTheirPlace) {
  const auto refused = [](const std::string& from, const std::string& to, const char* place) {
    std::string json = triangle_json;
    json.replace(json.find(from), from.size(), to);
    try {
      read_binary(json, triangle_bytes());
      ADD_FAILURE() << to;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      EXPECT_THAT(error.what(), HasSubstr(std::string("t.glb#") + place)) << error.what();
    }
  };
  refused("\"count\": 3", "\"count\": 4", "/accessors/0/count");
  refused("\"count\": 3", "\"count\": 9007199254740991", "/accessors/0/count");
  refused("\"byteLength\": 72", "\"byteLength\": 7200", "/bufferViews/0/byteLength");
  refused("\"byteStride\": 24", "\"byteStride\": 8", "/bufferViews/0/byteStride");
  refused("\"byteLength\": 80", "\"byteLength\": 81", "/buffers/0/byteLength");
  refused("\"mesh\": 0", "\"mesh\": 7", "/nodes/0/mesh");
  refused("\"mesh\": 0", "\"mesh\": 0, \"children\": [0]", "/nodes/0/children/0");
  refused("\"indices\": 2", "\"indices\": 0", "/meshes/0/primitives/0/indices");
  refused(
      "\"indices\": 2}]}]",
      R"("indices": 2, "material": 0}]}], "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [-1, 0, 0, 1]}}])",
      "/materials/0");
  refused("[-2, 1, 1]", "[1e31, 1, 1]", "/nodes/0/scale/0");
  refused("\"version\": \"2.0\"", "\"version\": \"1.0\"", "/asset/version");
  refused("\"translation\": [1, 2, 3]", "\"translation\": [1, 2]", "/nodes/0/translation");
  refused("\"buffers\": [{", "\"buffers\": [{\"uri\": \"../b.bin\", ", "/buffers/0/uri");
  refused("\"asset\"", "\"extensionsRequired\": [\"KHR_draco_mesh_compression\"], \"asset\"", "/extensionsRequired/0");
  const std::string whole = binary_gltf(triangle_json, triangle_bytes());
  for (const std::size_t length : {0ul, 3ul, 11ul, 19ul, 200ul, whole.size() - 1}) {
    tests::ScratchFolder folder;
    write_file(folder / "t.glb", whole.substr(0, length));
    EXPECT_THROW(importer_of("t.glb").read(folder / "t.glb"), Error) << length;
  }
}

}  // namespace
}  // namespace gonio::scene
