// OBJ and 3MF files, and remarks in STL: small ones whose every number is known, bad ones, and those of others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "io/model_3mf.h"
#include "io/obj.h"
#include "io/stl.h"
#include "io/zip_file.h"

namespace gonio::io {
namespace {

using testing::HasSubstr;

double volume_of(const TriangleMesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six += dot(mesh.positions_m[a], cross(mesh.positions_m[b], mesh.positions_m[c]));
  return six / 6;
}
std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "was read";
}
std::string obj_refusal(const std::string& text) {
  return refusal([&] { parse_obj(text, "a.obj"); });
}

TEST(Obj, NumbersCountFromTheFirstAndBackFromTheLast) {
  const std::string places = "# a tetrahedron\nv 0 0 0\nv 1 0 0 1.0\r\nv 0 1 0\rv +0 0 1e0\nvn 0 0 1\nvt 0 0\n";
  const TriangleMesh forward = parse_obj(places + "f 1 3 2\nf 1/1/1 2/1/1 4/1/1\nf 2//1 3//1 4//1\nf 3/1 1/1 4/1", "a");
  const TriangleMesh back =
      parse_obj(places + "g top\nusemtl x\nf -4 -2 -3\nf -4 -3 -1\nf -3 \\\n -2 -1\nl 1 2\nf -2 -4 -1\n", "a");
  EXPECT_EQ(forward.triangles, back.triangles);
  EXPECT_NEAR(volume_of(forward), 1.0 / 6, 1e-15);
}

TEST(Obj, PolygonsAreFanned) {
  const TriangleMesh mesh = parse_obj("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 0 2 0\nf 1 2 3 4 5\n", "a");
  ASSERT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.triangles[2], (std::array<std::uint32_t, 3>{0, 3, 4}));
}

TEST(Obj, RefusesByLine) {
  EXPECT_THAT(obj_refusal(""), HasSubstr("has no faces"));
  EXPECT_THAT(obj_refusal("v 0 0\n"), HasSubstr("a.obj: line 1 has \"\" where a number belongs"));
  EXPECT_THAT(obj_refusal("v 0 nan 0\n"), HasSubstr("line 1 has \"nan\""));
  EXPECT_THAT(obj_refusal("v 0 0 0\nv 1 0 0\nf 1 2\n"), HasSubstr("line 3 has a face of 2 corners"));
  EXPECT_THAT(obj_refusal("v 0 0 0\nf 1 2 3\n"), HasSubstr("line 2 names place 2, and 1 stand before it"));
  EXPECT_THAT(obj_refusal("v 0 0 0\nf 0 1 1\n"), HasSubstr("names place 0"));
  EXPECT_THAT(obj_refusal("v 0 0 0\nf -2 1 1\n"), HasSubstr("names place -2"));
  EXPECT_THAT(obj_refusal("v 0 0 0\nf a b c\n"), HasSubstr("has \"a\" where the number of a place belongs"));
  EXPECT_THAT(obj_refusal("v 0 0 0\nf 99999999999999999999 1 1\n"), HasSubstr("where the number of a place belongs"));
}

TEST(Stl, WordsBehindKeywordsAreRemarks) {
  const std::string facet =
      "facet normal +inf x 0 outer loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop%s\nendfacet%s\n";
  const auto with = [&](const std::string& loop, const std::string& end) {
    std::string text = facet;
    text.replace(text.find("%s"), 2, loop);
    text.replace(text.find("%s"), 2, end);
    return "solid a b\n" + text + text + "endsolid some words\n";
  };
  for (const auto& [loop, end] : {std::pair{"", ""}, {" foo", " bar "}, {" facet", " vertex 1 2 3"}})
    EXPECT_EQ(parse_stl(with(loop, end), "a").triangles.size(), 2u) << loop;
  const std::string line =
      "solid x facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet ";
  EXPECT_EQ(parse_stl("solid\n" + line.substr(8) + line.substr(8) + "endsolid", "a").triangles.size(), 2u);
}

std::string model(const std::string& resources, const std::string& build, const std::string& unit = "millimeter") {
  return "<?xml version=\"1.0\"?><model unit=\"" + unit + "\"><resources>" + resources + "</resources><build>" + build +
         "</build></model>";
}
const char* const tetrahedron =
    "<object id=\"1\" type=\"model\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>"
    "<vertex x=\"0\" y=\"1\" z=\"0\"/><vertex x=\"0\" y=\"0\" z=\"1\"/></vertices><triangles>"
    "<triangle v1=\"0\" v2=\"2\" v3=\"1\"/><triangle v1=\"0\" v2=\"1\" v3=\"3\"/><triangle v1=\"1\" v2=\"2\" v3=\"3\"/>"
    "<triangle v1=\"2\" v2=\"0\" v3=\"3\"/></triangles></mesh></object>";

TEST(Model3mf, UnitsTransformsAndComponents) {
  EXPECT_NEAR(volume_of(parse_3mf_model(model(tetrahedron, "<item objectid=\"1\"/>", "inch"), "a")),
              std::pow(0.0254, 3) / 6, 1e-15);
  // Rows of the matrix are what the axes become: x to 2 y, y to -x, z to z, and shifted.
  const TriangleMesh turned = parse_3mf_model(
      model(tetrahedron, "<item objectid=\"1\" transform=\"0 2 0 -1 0 0 0 0 1 5 6 7\"/>", "meter"), "a");
  EXPECT_EQ(turned.positions_m[1], (Vec3{5, 8, 7}));
  EXPECT_EQ(turned.positions_m[2], (Vec3{4, 6, 7}));
  EXPECT_NEAR(volume_of(turned), 2.0 / 6, 1e-12);
  // Mirrored, it keeps facing outwards; twice within another object.
  const std::string pair =
      std::string(tetrahedron) +
      "<object id=\"2\"><components><component objectid=\"1\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/>"
      "<component objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 10 0 0\"/></components></object>";
  const TriangleMesh two = parse_3mf_model(model(pair, "<item objectid=\"2\"/>", "meter"), "a");
  EXPECT_EQ(two.triangles.size(), 8u);
  EXPECT_NEAR(volume_of(two), 2.0 / 6, 1e-12);
  EXPECT_EQ(parse_3mf_model(model(tetrahedron, ""), "a").triangles.size(), 4u);  // without a build: all
}

TEST(Model3mf, RefusesByName) {
  const auto refused = [](const std::string& xml) { return refusal([&] { parse_3mf_model(xml, "a.3mf"); }); };
  const std::string item = "<item objectid=\"1\"/>";
  EXPECT_THAT(refused("<model"), HasSubstr("is no XML"));
  EXPECT_THAT(refused(model("", "")), HasSubstr("has no triangles"));
  EXPECT_THAT(refused(model(tetrahedron, item, "mile")), HasSubstr("unit \"mile\""));
  EXPECT_THAT(refused(model(tetrahedron, "<item objectid=\"7\"/>")),
              HasSubstr("places object \"7\", which it has not"));
  EXPECT_THAT(refused(model(tetrahedron, "<item objectid=\"1\" transform=\"1 0 0\"/>")),
              HasSubstr("a transform's number"));
  std::string bad = model(tetrahedron, item);
  bad.replace(bad.find("v3=\"3\""), 6, "v3=\"4\"");
  EXPECT_THAT(refused(bad), HasSubstr("v3 = 4, and 4 vertices"));
  bad = model(tetrahedron, item);
  bad.replace(bad.find("x=\"1\""), 5, "x=\"inf\"");
  EXPECT_THAT(refused(bad), HasSubstr("has \"inf\" as x"));
  // Objects that hold themselves, alone and doubling at every turn.
  EXPECT_THAT(refused(model("<object id=\"1\"><components><component objectid=\"1\"/></components></object>", item)),
              HasSubstr("more than 32 deep"));
  std::string doubling;
  for (int i = 0; i < 30; ++i) {
    const std::string next = "<component objectid=\"" + std::to_string(i + 1) + "\"/>";
    doubling += "<object id=\"" + std::to_string(i) + "\"><components>" + next + next + "</components></object>";
  }
  EXPECT_THAT(refused(model(doubling + "<object id=\"30\"/>", "<item objectid=\"0\"/>")),
              HasSubstr("more than 1000000"));
  const tests::ScratchFolder folder;
  ZipWriter zip(folder / "a.3mf");
  zip.add("readme.txt", "no model");
  zip.commit();
  EXPECT_THAT(refusal([&] { read_3mf(folder / "a.3mf"); }), HasSubstr("has no 3D/3dmodel.model"));
}

TEST(MeshFiles, OfOthersHaveTheVolumesThatOthersCounted) {
  GONIO_NEEDS_DATA("print/meshes");
  const auto folder = tests::data("print/meshes");
  const double mm3 = 1e-9, inch3 = std::pow(0.0254, 3);
  bool in_metres = false;
  EXPECT_NEAR(volume_of(read_mesh(folder / "counterX.3MF", &in_metres)), 885303.005 * mm3, 1e-3 * mm3);
  EXPECT_TRUE(in_metres);
  EXPECT_NEAR(volume_of(read_mesh(folder / "cube_and_sphere_same_name.3mf")), 97431.9055 * mm3, 1e-4 * mm3);
  EXPECT_EQ(read_mesh(folder / "featuretype.3MF").triangles.size(), 2208u);
  EXPECT_NEAR(volume_of(read_mesh(folder / "featuretype.STL", &in_metres)), 11.6277, 1e-4);
  EXPECT_FALSE(in_metres);
  EXPECT_NEAR(volume_of(read_mesh(folder / "fandisk.obj")), 0.6794, 1e-4);
  EXPECT_NEAR(volume_of(read_mesh(folder / "negative_indices.obj")), 8, 1e-12);
  EXPECT_NEAR(volume_of(read_mesh(folder / "20mmbox-nonstandard.stl")), 8000, 1e-9);
  EXPECT_LT(std::abs(volume_of(read_mesh(folder / "featuretype.3MF")) / inch3 - 11.636), 0.1);  // it has holes
}

}  // namespace
}  // namespace gonio::io
