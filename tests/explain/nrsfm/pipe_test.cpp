// nrsfm-solve | explain | nrsfm-solve | nrsfm-eval as programs: what an orthographic solver left out is named without
// the truth, and the answer to the upgraded manifest lies nearer to the truth, which only the evaluation looks at.
#include <gmock/gmock.h>

#include "base/atomic_file.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/evaluation.h"
#include "nrsfm/files.h"
#include "process.h"
#include "tracks_world.h"

namespace gonio::explain {
namespace {

using gonio::tests::Ended;

class TracksPipe : public ::testing::Test {
 protected:
  Ended shell(const std::string& line) {
    return gonio::tests::run({"bash", "-euo", "pipefail", "-c", std::string("PATH=") + GONIO_BIN + ":$PATH\n" + line},
                             folder_.path());
  }
  void write(const testing::Sequence& s) { gonio::nrsfm::write_sequence(s, folder_ / "film.mat"); }
  // e3D of the manifest's last reconstruction, one similarity for the sequence.
  double error_of(const std::string& file) {
    const Ended e = shell("nrsfm-eval --measure e3d --alignment global-similarity --draws 0 --no-flips -i " + file +
                          " -o evaluated.json");
    EXPECT_EQ(e.status, 0) << e.err;
    return manifest::read_document((folder_ / "evaluated.json").string()).evaluations.back().errors.front().value;
  }
  gonio::tests::ScratchFolder folder_;
};

TEST_F(TracksPipe, ScalesThatAreNamedAreFreedByTheNextCall) {
  testing::Film f;
  f.zoom = 0.2, f.shapes = 1;
  write(testing::film(f));
  const Ended first =
      shell("nrsfm-solve --solver rigid --out first film.mat >first.json; explain first.json >why.json");
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(gonio::read_file(folder_ / "why.json"), ::testing::HasSubstr("tracks.scale"));
  const Ended second = shell("nrsfm-solve --solver rigid --out second <why.json >second.json");
  ASSERT_EQ(second.status, 0) << second.err;
  EXPECT_LT(error_of("second.json"), 0.5 * error_of("first.json"));
}

// A solver with as many shapes as there are frames reprojects best, and leaves nothing to ask.
TEST_F(TracksPipe, OfSeveralSolversOneIsTakenThatLeavesSomethingToAsk) {
  testing::Film f;
  f.zoom = 0.2, f.shapes = 1;
  write(testing::film(f));
  const Ended e =
      shell("nrsfm-solve --solver spfm --solver rigid --out answers film.mat | tee all.json | explain >why.json");
  ASSERT_EQ(e.status, 0) << e.err;
  EXPECT_THAT(gonio::read_file(folder_ / "why.json"), ::testing::HasSubstr("tracks.scale"));
  const Ended alone = shell("nrsfm-solve --solver spfm --solver subspaces --out others film.mat | explain >why.json");
  EXPECT_EQ(alone.status, 65);
  EXPECT_THAT(alone.err, ::testing::HasSubstr("--solver rigid"));
}

TEST_F(TracksPipe, SlipsThatAreNamedAreLeftOutByTheNextCall) {
  testing::Film f;
  f.shapes = 1;
  testing::Sequence s = testing::film(f);
  for (int k = 0; k < 6; ++k) s.tracks.block<2, 1>(2 * (3 * k + 1), 2 * k) += Eigen::Vector2d(70, -90);
  write(s);
  const Ended first = shell("nrsfm-solve --solver rigid --out first film.mat | tee first.json | explain >why.json");
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(first.err, ::testing::HasSubstr("do not follow"));
  const Ended second = shell("nrsfm-solve --solver rigid --out second <why.json >second.json");
  ASSERT_EQ(second.status, 0) << second.err;
  EXPECT_LT(error_of("second.json"), 0.5 * error_of("first.json"));
}

// What the engine has drawn of its own fits is not what is left where perspective is named beneath lacking shapes.
TEST_F(TracksPipe, PerspectiveBeneathLackingShapesIsLocatedByItsOwnFit) {
  const Ended e = shell(
      "nrsfm-make --kind deflation --path circle --camera perspective --missing without --frames 20 --points 40 "
      "--out tracks | nrsfm-solve --solver csf --out answers | explain --html why.html >why.json");
  ASSERT_EQ(e.status, 0) << e.err;
  const manifest::Document document = manifest::read_document((folder_ / "why.json").string());
  const manifest::Value& entry = document.explanations.back();
  ASSERT_EQ(entry.find("named")->as_array().at(0).find("mechanism")->as_string(), "tracks.perspective");
  int better = 0, groups = 0;
  for (const manifest::Value& g : entry.find("located")->find("groups")->as_array()) {
    better += g.find("after")->as_number() < g.find("before")->as_number();
    ++groups;
  }
  EXPECT_EQ(groups, 40);
  EXPECT_GT(better, 30);
  const std::string page = gonio::read_file(folder_ / "why.html");
  const std::size_t curves = page.find("Which curve"), sure = page.find("How sure", curves);
  EXPECT_EQ(page.substr(curves, sure - curves).find("with the named physics"), std::string::npos);
}

}  // namespace
}  // namespace gonio::explain
