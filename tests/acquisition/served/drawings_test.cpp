// acquire's drawings as people ask for them: a page of the laboratory, of the plan, of the run; glTF; refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/desk/specimen_laboratory.h"
#include "base/atomic_file.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "process.h"

namespace gonio::acquisition {
namespace {

using testing::HasSubstr;
using testing::Not;

class Drawings : public testing::Test {
 protected:
  Drawings() {
    manifest::Document lab = specimen_laboratory("desk", folder.path());
    manifest::Camera& lens = lab.cameras.at("camera");
    lens.width_px = 40, lens.height_px = 30;
    lens.fx_px = lens.fy_px = 45, lens.cx_px = 19.5, lens.cy_px = 14.5;
    write_file(folder / "lab.json", manifest::print_document(lab, folder.path()));
  }
  tests::Ended acquire(std::vector<std::string> words, int status = 0) {
    words.insert(words.begin(), "acquire");
    tests::Ended ended = tests::run(words, folder.path());
    EXPECT_EQ(ended.status, status) << ended.err;
    return ended;
  }
  tests::ScratchFolder folder;
};

TEST_F(Drawings, TheLaboratoryNeedsNoPlanAndPassesOn) {
  const tests::Ended ended = acquire({"lab.json", "--picture", "lab.html", "--gltf", "lab.glb"});
  EXPECT_THAT(ended.out, HasSubstr("\"laboratory\""));
  EXPECT_THAT(read_file(folder / "lab.html"), HasSubstr("1 arm, 1 camera, 1 lamp"));
  EXPECT_TRUE(read_file(folder / "lab.glb").starts_with("glTF"));
  EXPECT_THAT(acquire({"lab.json", "--gltf", "lab.obj"}, 64).err, HasSubstr("ends in neither .gltf nor .glb"));
  EXPECT_FALSE(std::filesystem::exists(folder / "lab.obj"));
  EXPECT_THAT(acquire({"lab.json", "--html", "plan.html"}, 65).err, HasSubstr("plan first"));
}

TEST_F(Drawings, ARunLeavesItsPage) {
  acquire({"lab.json", "--plan", "board:views=3,tilt=20deg,nearest=25cm,farthest=30cm", "--gltf", "plan.gltf", "--html",
           "plan.html", "-o", "plan.json"});
  EXPECT_THAT(read_file(folder / "plan.gltf"), HasSubstr("\"animations\""));
  EXPECT_THAT(read_file(folder / "plan.html"), HasSubstr("view to be taken"));
  acquire({"plan.json", "--go", "--spp", "1", "--out", "run", "--html", "run.html", "-o", "frames.json"});
  const std::string page = read_file(folder / "run.html");
  EXPECT_THAT(page, HasSubstr("3 of 3 frames"));
  EXPECT_THAT(page, HasSubstr("The last picture"));
  EXPECT_THAT(page, HasSubstr("view taken"));
  EXPECT_THAT(page, Not(HasSubstr("http-equiv=\"refresh\"")));
}

// A page that loads itself anew and says for ever that something runs would be worse than none.
TEST_F(Drawings, ARunThatIsStoppedSaysSoOnItsPage) {
  acquire({"lab.json", "--plan", "board:views=3,tilt=20deg,nearest=25cm,farthest=30cm", "-o", "plan.json"});
  make_folder(folder / "run/frames/board-0002.png");  // where a picture ought to go
  const tests::Ended ended = tests::run(
      {"acquire", "plan.json", "--go", "--spp", "1", "--out", "run", "--html", "run.html", "-o", "frames.json"},
      folder.path());
  EXPECT_NE(ended.status, 0);
  EXPECT_THAT(ended.err, HasSubstr("board-0002.png"));
  const std::string page = read_file(folder / "run.html");
  EXPECT_THAT(page, HasSubstr("of 3 frames, stopped"));
  EXPECT_THAT(page, HasSubstr("board-0002.png"));
  EXPECT_THAT(page, Not(HasSubstr("http-equiv=\"refresh\"")));
  EXPECT_FALSE(std::filesystem::exists(folder / "frames.json"));
}

}  // namespace
}  // namespace gonio::acquisition
