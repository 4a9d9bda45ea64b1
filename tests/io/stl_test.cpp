// STL files: both encodings, corners that become one vertex, and what is refused.
#include "io/stl.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "base/error.h"
#include "data.h"
#include "io/little_endian.h"

namespace gonio::io {
namespace {

using ::testing::HasSubstr;

const char* const ascii = R"(solid a name of words
  facet normal 0 0 1
    outer loop
      vertex 0 0 0
      vertex 1 0 0
      vertex 0 1e0 0
    endloop
  endfacet
  facet normal nan nan nan
    outer loop
      vertex 1 0 0
      vertex +1 1 -0.5
      vertex 0 1 0
    endloop
  endfacet
endsolid a name of words
)";

std::string binary_of(const TriangleMesh& mesh, const std::string& head) {
  std::string file = head;
  file.resize(84 + 50 * mesh.triangles.size());
  store_at<std::uint32_t>(file, 80, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k)
        store_at<float>(file, 84 + 50 * i + 12 * (c + 1) + 4 * std::size_t(k),
                        static_cast<float>(mesh.positions_m[mesh.triangles[i][c]][k]));
  return file;
}

std::string complaint(const std::string& file) {
  try {
    parse_stl(file, "part.stl");
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    return e.what();
  }
  return "no complaint";
}

TEST(Stl, BothEncodingsGiveTheSameMesh) {
  const TriangleMesh mesh = parse_stl(ascii, "part.stl");
  ASSERT_EQ(mesh.positions_m.size(), 4u);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.positions_m[3], (Vec3{1, 1, -0.5}));
  EXPECT_EQ(mesh.triangles[1], (std::array<std::uint32_t, 3>{1, 3, 2}));
  for (const std::string& head : {std::string("made by hand"), std::string("solid but binary")}) {
    const TriangleMesh again = parse_stl(binary_of(mesh, head), "part.stl");
    EXPECT_EQ(again.positions_m, mesh.positions_m);
    EXPECT_EQ(again.triangles, mesh.triangles);
  }
}

TEST(Stl, LinesEndAsTheyLikeAndSolidsFollowEachOther) {
  std::string old = ascii;
  std::ranges::replace(old, '\n', '\r');
  EXPECT_EQ(parse_stl(old, "part.stl").triangles, parse_stl(ascii, "part.stl").triangles);
  std::string second = ascii;
  for (std::size_t at = 0; (at = second.find("vertex 0 0 0")) != std::string::npos;)
    second.replace(at, 12, "vertex 0 0 7");
  const TriangleMesh both = parse_stl(ascii + second, "part.stl");
  EXPECT_EQ(both.triangles.size(), 4u);
  EXPECT_EQ(both.positions_m.size(), 5u);
  EXPECT_THAT(complaint(std::string(ascii) + "solid cut"), HasSubstr("triangle 2 is cut off"));
}

TEST(Stl, RefusesWhatIsBroken) {
  const std::string text = ascii, binary = binary_of(parse_stl(ascii, "part.stl"), "x");
  EXPECT_THAT(complaint(text.substr(0, text.size() - 40)), HasSubstr("part.stl: triangle 2"));
  EXPECT_THAT(complaint(text.substr(0, 90)), HasSubstr("is cut off"));
  EXPECT_THAT(complaint(binary.substr(0, binary.size() - 7)), HasSubstr("is no STL file"));
  EXPECT_THAT(complaint("ply\n"), HasSubstr("is no STL file"));
  EXPECT_THAT(complaint("solid x\nendsolid x\n"), HasSubstr("has no triangles"));
  std::string bad = text;
  bad.replace(bad.find("1e0"), 3, "1x0");
  EXPECT_THAT(complaint(bad), HasSubstr("triangle 0 has \"1x0\" where a number belongs"));
  std::string nan = binary;
  store_at<float>(nan, 84 + 12, std::numeric_limits<float>::quiet_NaN());
  EXPECT_THAT(complaint(nan), HasSubstr("not finite"));
  std::string huge = binary;
  store_at<std::uint32_t>(huge, 80, 0xffffffffu);
  EXPECT_THAT(complaint(huge), HasSubstr("4294967295 triangles"));
}

TEST(Stl, ReadsTheCollisionModelsOfRealArms) {
  GONIO_NEEDS_DATA("robots/ur_description");
  const TriangleMesh wrist = read_stl(tests::data("robots/ur_description/meshes/ur5/collision/wrist3.stl"));
  EXPECT_EQ(wrist.triangles.size(), 446u);
  EXPECT_LT(wrist.positions_m.size(), 446u);  // corners are shared
}

}  // namespace
}  // namespace gonio::io
