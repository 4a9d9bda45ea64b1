// Views of surfaces: what is stored can be read back, the still picture shows the surface where it is.
#include "report/mesh_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/raster.h"
#include "report/page.h"

namespace gonio::report {
namespace {

// A tetrahedron with one corner up.
ViewedMesh tetrahedron(const char* name) {
  return {name, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}, {}};
}

TEST(MeshView, TheStillShowsTheSurfaceInTheMiddleAndNothingAtTheBorder) {
  const MeshView view{.name = "pot", .meshes = {tetrahedron("raw")}, .label = "", .unit = ""};
  const io::Image seen = io::decode_raster(still_png(view, 0, 80, 60), "still");
  ASSERT_EQ(seen.width, 80);
  const float ground = seen.at(0, 0, 0);
  EXPECT_GT(ground, 0.9f);
  for (int x = 0; x < 80; ++x) EXPECT_EQ(seen.at(x, 0, 0), ground);
  std::size_t covered = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) covered += seen.at(x, y, 0) != ground;
  // Seen along +y the outline is the right triangle with legs 1; the bounding sphere fills 0.92 of the height.
  const double unit = 0.5 * 0.92 * 60 / (std::sqrt(3.0) / 2);
  EXPECT_NEAR(static_cast<double>(covered), 0.5 * unit * unit, 0.1 * unit * unit);
}

TEST(MeshView, ValuesBecomeColours) {
  MeshView view{.name = "pot", .meshes = {tetrahedron("raw")}, .label = "off by", .unit = "um", .low = -1, .high = 1};
  view.meshes[0].value = {1, 1, 1, 1};
  const io::Image red = io::decode_raster(still_png(view, 0, 80, 60), "still");
  view.meshes[0].value = {-1, -1, -1, -1};
  const io::Image blue = io::decode_raster(still_png(view, 0, 80, 60), "still");
  int differing = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) {
      if (red.at(x, y, 0) == blue.at(x, y, 0)) continue;
      ++differing;
      EXPECT_GT(red.at(x, y, 0), red.at(x, y, 2));
      EXPECT_LT(blue.at(x, y, 0), blue.at(x, y, 2));
    }
  EXPECT_GT(differing, 100);
  EXPECT_THAT(html(view), testing::HasSubstr("off by / um"));
}

TEST(MeshView, APageWithAViewHoldsItsScriptAndOneWithoutDoesNot) {
  Page with("t", "h", ""), without("t", "h", "");
  with.figures({{.svg = html({.name = "<pot>",
                              .meshes = {tetrahedron("raw"), tetrahedron("cleaned & sound")},
                              .label = "",
                              .unit = ""})}});
  EXPECT_THAT(with.html(), testing::HasSubstr("getContext('webgl'"));
  EXPECT_THAT(with.html(), testing::HasSubstr("cleaned &amp; sound"));
  EXPECT_THAT(with.html(), testing::Not(testing::HasSubstr("<pot>")));
  EXPECT_THAT(without.html(), testing::Not(testing::HasSubstr("webgl")));
}

TEST(MeshView, NothingToShowIsNoFault) {
  const MeshView empty{.name = "nothing", .meshes = {}, .label = "", .unit = ""};
  EXPECT_FALSE(html(empty).empty());
  const MeshView bare{.name = "bare", .meshes = {{"no faces", {}, {}, {}}}, .label = "", .unit = ""};
  EXPECT_FALSE(html(bare).empty());
}

}  // namespace
}  // namespace gonio::report
