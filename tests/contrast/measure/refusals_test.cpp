// What contrast measure refuses, each in one line that names the place and the remedy. The session is drawn, not
// rendered: a checker of 6 x 6 cells of 10 px in pictures of 80 x 80 px, marked in every one of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "camera/intrinsics.h"
#include "contrast/measure/measure.h"
#include "data.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/image.h"
#include "manifest/sections/pattern.h"

namespace gonio::contrast {
namespace {

using testing::HasSubstr;

struct Session {
  tests::ScratchFolder folder;
  manifest::Document document;
  MeasureOptions options;
  std::string name;
  std::string corner_rows;

  void draw(const std::string& id, bool turned) {
    io::Image picture(80, 80, {"Y"});
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 80; ++x) {
        const bool inside = x >= 10 && x < 70 && y >= 10 && y < 70, one = (x / 10 + y / 10) % 2 == 0;
        picture.at(x, y, 0) =
            inside ? (one != turned ? 0.8f : 0.2f) + 0.01f * static_cast<float>((7 * x + 3 * y) % 5) : 0.5f;
      }
    io::write_picture(folder / (id + ".exr"), picture);
    manifest::ImageEntry image;
    image.id = id;
    image.group = id;
    image.file = manifest::add_file(document, folder / (id + ".exr"), id);
    document.images.push_back(image);
    corner_rows += id + ",0,9.5,9.5\n" + id + ",1,69.5,9.5\n" + id + ",2,69.5,69.5\n" + id + ",3,9.5,69.5\n";
  }
  Session() {
    document.folder = folder.path();
    document.name = "session.json";
    draw("before", false);
    draw("after", true);
    manifest::Pattern& pattern = document.patterns["checker"];
    pattern.rows = pattern.columns = 6;
    pattern.cell_m = {0.001};
    manifest::PatternPlacement before, after;
    before.name = "before";
    after.name = "after";
    pattern.placements = {before, after};
    bits("101010\n010101\n101010\n010101\n101010\n010101\n");
  }
  manifest::Pattern& pattern() { return document.patterns.at("checker"); }
  void bits(const std::string& text) {
    write_file(folder / "bits.txt", text);
    document.files.erase("bits");
    pattern().file = manifest::add_file(document, folder / "bits.txt", "bits");
  }
  Measured run() {
    if (corner_rows.empty()) return measure(document, name, {}, options);
    write_file(folder / "corners.csv", "image,corner,u_px,v_px\n" + corner_rows);
    return measure(document, name, read_marks(folder / "corners.csv", document), options);
  }
};

TEST(MeasureRefusals, TheSessionItselfIsMeasured) {
  Session session;
  const Measured m = session.run();
  EXPECT_NEAR(m.views.at(0).michelson.value, 0.6 / 1.04, 0.02);
  EXPECT_NEAR(m.views.at(1).michelson.value, -0.6 / 1.04, 0.02);
  EXPECT_EQ(m.turns.size(), 1u);
  EXPECT_EQ(m.views.at(0).right, 1);
}

TEST(MeasureRefusals, BitsAreFoundWhereTheyAreNotStated) {
  Session session;
  const auto stated = session.run().pattern.bits;
  session.pattern().file.clear();
  const Measured m = session.run();
  EXPECT_TRUE(m.bits_found);
  EXPECT_EQ(m.pattern.bits, stated);
}

struct Refusal {
  const char* name;
  std::function<void(Session&)> spoil;
  const char* says;
  Exit code = Exit::data;
};

void PrintTo(const Refusal& refusal, std::ostream* out) {
  *out << refusal.name;
}

class MeasureRefusal : public testing::TestWithParam<Refusal> {};

TEST_P(MeasureRefusal, SaysWhatAndWhere) {
  Session session;
  GetParam().spoil(session);
  try {
    session.run();
    FAIL() << "was measured";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr(GetParam().says));
    EXPECT_EQ(error.code(), GetParam().code) << error.what();
    EXPECT_FALSE(error.remedy().empty()) << error.what();
  }
}

void enter_camera(Session& s, int width) {
  camera::enter_pinhole(s.document, "camera", width, width, 1000);
  for (auto& image : s.document.images) image.camera = "camera";
}

const std::vector<Refusal> refusals{
    {"NoPattern", [](Session& s) { s.document.patterns.clear(); }, "there is no pattern to measure"},
    {"UnknownPattern", [](Session& s) { s.name = "chequer"; }, "\"chequer\", which is not in patterns", Exit::usage},
    {"NoImageOfAPlacement", [](Session& s) { s.document.images[1].group = "later"; },
     "has no image of the placement \"after\""},
    {"UnknownImage", [](Session& s) { s.pattern().placements[0].images = {"befor"}; },
     "\"befor\", which is not in images"},
    {"ImageInBothPlacements", [](Session& s) { s.pattern().placements[1].images = {"before"}; }, "once more"},
    {"OnePlacement", [](Session& s) { s.pattern().placements.pop_back(); }, "has 1 placements"},
    {"ImageWithoutFile", [](Session& s) { s.document.images[0].file.clear(); }, "has no file"},
    {"PatternOfOtherSize", [](Session& s) { s.bits("1010\n0101\n"); },
     "has 2 rows of 4 cells, the pattern \"checker\" has 6"},
    {"PatternWithOtherCharacters", [](Session& s) { s.bits("101010\n01?101\n"); }, "bits.txt:2: has the character '?'"},
    {"PatternWithUnequalRows", [](Session& s) { s.bits("101010\n0101\n"); },
     "bits.txt:2: has 4 cells, the rows above have 6"},
    {"PatternOfOneKind", [](Session& s) { s.bits("111111\n111111\n111111\n111111\n111111\n111111\n"); },
     "cells of one kind only"},
    {"NoSuchDataMatrix", [](Session& s) { s.pattern().kind = "data-matrix"; }, "which no data matrix has"},
    {"CornerOfUnknownImage", [](Session& s) { s.corner_rows += "befor,0,1,1\n"; },
     "corners.csv:10: names the image \"befor\""},
    {"CornerFour", [](Session& s) { s.corner_rows += "after,4,1,1\n"; }, "corners.csv:10: has the corner 4"},
    {"CornerTwice", [](Session& s) { s.corner_rows += "after,0,1,1\n"; }, "marks corner 0 of \"after\" again"},
    {"CornersTheOtherWayRound",
     [](Session& s) { s.corner_rows = "before,0,9,9\nbefore,1,9,69\nbefore,2,69,69\nbefore,3,69,9\n"; },
     "do not go round clockwise"},
    {"CornerOutsideThePicture",
     [](Session& s) {
       enter_camera(s, 80);
       s.corner_rows = "before,0,9,90\n";
     },
     "puts corner 0 at (9, 90) px, outside the picture of 80 x 80 px"},
    {"NoCornerAnywhere", [](Session& s) { s.corner_rows = "before,0,9.5,9.5\n"; },
     "in which the sample's place is known"},
    {"NothingMarkedAndAPatternThatIsItsOwnTurn", [](Session& s) { s.corner_rows.clear(); },
     "which of its corners is corner 0"},
    {"NothingMarkedAndTheSampleReachesTheRim",
     [](Session& s) {
       s.corner_rows.clear();
       for (const char* id : {"before", "after"}) {
         io::Image picture(80, 80, {"Y"});
         for (int y = 0; y < 80; ++y)
           for (int x = 0; x < 80; ++x) picture.at(x, y, 0) = (x / 10 + y / 10) % 2 == 0 ? 0.8f : 0.2f;
         io::write_picture(s.folder / (std::string(id) + ".exr"), picture);
         s.document.files.erase(id);
         manifest::add_file(s.document, s.folder / (std::string(id) + ".exr"), id);
       }
     },
     "does not stand out from the picture's rim, or reaches it"},
    {"CellsBelowThreePixels",
     [](Session& s) {
       s.corner_rows.clear();
       for (const char* id : {"before", "after"})
         s.corner_rows += std::string(id) + ",0,10,10\n" + id + ",1,25,10\n" + id + ",2,25,25\n" + id + ",3,10,25\n";
     },
     "shows cells of 2.5 px"},
    {"PatternBeyondThePicture",
     [](Session& s) {
       s.corner_rows.clear();
       for (const char* id : {"before", "after"})
         s.corner_rows +=
             std::string(id) + ",0,60,60\n" + id + ",1,160,60\n" + id + ",2,160,160\n" + id + ",3,60,160\n";
     },
     "cells outside the picture"},
    {"SaturatedEverywhere", [](Session& s) { s.options.full_scale = 0.1; }, "cells saturated"},
    {"SaturatedBrightCells", [](Session& s) { s.options.full_scale = 0.7; }, "no cell of bit 1 counts"},
    {"PictureOfAnotherSize", [](Session& s) { enter_camera(s, 100); },
     "has 80 x 80 px, its camera \"camera\" 100 x 100 px"},
    {"PosedButNowhereMarked",
     [](Session& s) {
       enter_camera(s, 80);
       for (auto& image : s.document.images) image.world_from_camera.emplace();
       s.corner_rows.clear();
       s.corner_rows = "before,0,9.5,9.5\nbefore,1,69.5,9.5\nbefore,2,69.5,69.5\n";
     },
     "no image in which all four corners"},
    {"NoCellSize",
     [](Session& s) {
       enter_camera(s, 80);
       for (auto& image : s.document.images) image.world_from_camera.emplace();
       s.pattern().cell_m.clear();
     },
     "has no cell_m"},
};

INSTANTIATE_TEST_SUITE_P(All, MeasureRefusal, testing::ValuesIn(refusals),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace gonio::contrast
