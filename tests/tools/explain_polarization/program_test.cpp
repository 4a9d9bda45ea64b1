// explain on mosaic photographs as a person runs it; what is wrong is said in one line.
// One process: ExplainPolarization.*
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "data.h"
#include "explain/polarization/mosaic_scene.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "process.h"
#include "schema_check.h"

namespace gonio::tests {
namespace {

using explain::tests::mosaic_scene, explain::tests::photograph_mosaics;
using testing::HasSubstr;

// What is found is switched on in what goes out, and that goes through again: nothing is left.
TEST(ExplainPolarization, NamesATurnAndIsContentWithItsAnswer) {
  ScratchFolder folder;
  photograph_mosaics(mosaic_scene(R"(, "mechanisms": {"polarizer.angle": {"turn_rad": 0.05}})"), folder.path(), 8);
  write_file(folder / "scene.json", mosaic_scene());
  const Ended ended = run({"explain", "scene.json", "-o", "out.json", "--out", "out"}, folder.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document d = manifest::read_document(folder / "out.json");
  EXPECT_EQ(d.explanations.at(0).find("domain")->as_string(), "polarization");
  EXPECT_THAT(d.explanations.at(0).find("sentence")->as_string(), HasSubstr("polarizer.angle"));
  ASSERT_TRUE(d.mechanisms.contains("polarizer.angle"));
  EXPECT_NEAR(d.mechanisms.at("polarizer.angle").parameters.at("turn_rad").scalar(), 0.05, 0.003);
  const Ended again = run({"explain", "out.json", "-o", "again.json"}, folder.path());
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(manifest::read_document(folder / "again.json").explanations.at(0).find("verdict")->as_string(), "null");
}

TEST(ExplainPolarization, RefusesPicturesWithColours) {
  ScratchFolder folder;
  photograph_mosaics(mosaic_scene(), folder.path(), 8);
  io::write_picture(folder / "i2.exr", io::Image(48, 48, {"R", "G", "B"}));
  write_file(folder / "scene.json", mosaic_scene());
  const Ended ended = run({"explain", "scene.json"}, folder.path());
  EXPECT_EQ(ended.status, 65);
  EXPECT_THAT(ended.err, HasSubstr("has colours, and a camera behind polarizers has one reading a pixel"));
}

}  // namespace
}  // namespace gonio::tests
