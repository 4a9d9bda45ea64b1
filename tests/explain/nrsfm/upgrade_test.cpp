// The manifest that explain writes: read again, solvers do not leave out what was named, and explain finds it no more.
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>

#include "explain/explain_document.h"
#include "manifest/document.h"
#include "nrsfm/evaluate/alignment.h"
#include "nrsfm/evaluate/errors.h"
#include "nrsfm/files.h"
#include "nrsfm/manifest_sequences.h"
#include "schema_check.h"
#include "tracks_world.h"

namespace gonio::explain {
namespace {

namespace fs = std::filesystem;
using gonio::nrsfm::SolverValues;
using testing::film;
using testing::Film;
using testing::Sequence;

class Upgrade : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "gonio-upgrade-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }
  void TearDown() override { fs::remove_all(folder_); }

  void enter(const Sequence& s) {
    gonio::nrsfm::write_sequence(s, folder_ / "film.mat");
    document_.folder = folder_;
    document_.name = "film.json";
    ASSERT_EQ(gonio::nrsfm::enter_sequence(document_, folder_ / "film.mat", s), "film");
  }
  // What nrsfm-solve does; the answer's e3D, either hand.
  double solve(const std::string& solver, const SolverValues& values) {
    gonio::nrsfm::SolverOptions options;
    options.values = values;
    const Sequence s = gonio::nrsfm::sequence_of(document_, "film");
    const gonio::nrsfm::Solution answer = gonio::nrsfm::solve(*gonio::nrsfm::find_solver(solver), s, options);
    const fs::path file = folder_ / (solver + ".mat");
    gonio::nrsfm::write_reconstruction(answer.reconstruction, file);
    gonio::nrsfm::enter_reconstruction(document_, "film-" + solver, "film", answer, 0, file);
    const auto alignment = gonio::nrsfm::Alignment::global_similarity;
    return gonio::nrsfm::e3d(answer.reconstruction.shapes, *s.truth, alignment);
  }
  std::vector<std::string> explain_it() {
    ExplainRequest request;
    request.options = testing::quick();
    explain_document(document_, request);
    std::vector<std::string> named;
    gonio::tests::expect_described(manifest::print_document(document_, document_.folder));
    const manifest::Value& entry = document_.explanations.back();
    for (const manifest::Value& n : entry.find("named")->as_array()) named.push_back(n.find("mechanism")->as_string());
    sentence_ = entry.find("sentence")->as_string();
    return named;
  }

  fs::path folder_;
  manifest::Document document_;
  std::string sentence_;
};

TEST_F(Upgrade, HidesWhatDoesNotFollow) {
  Film f;
  f.frames = 24, f.points = 24;
  Sequence s = film(f);
  Random random(9);
  for (int k = 0; k < 20; ++k)
    s.tracks.block<2, 1>(2 * random.below(24), random.below(24)) +=
        60 * Eigen::Vector2d(random.normal(), random.normal());
  enter(s);
  const SolverValues rank{{"rank", 2}, {"dct_terms", 4}};
  const double before = solve("csf", rank);
  EXPECT_THAT(explain_it(), ::testing::ElementsAre("tracks.outliers")) << sentence_;
  EXPECT_LT(gonio::nrsfm::sequence_of(document_, "film").visible.count(), 576 - 12);
  const double after = solve("csf", rank);
  EXPECT_LT(after, 0.5 * before);
  EXPECT_THAT(explain_it(), ::testing::IsEmpty()) << sentence_;
  std::printf("e3D %.4f -> %.4f\n", before, after);
}

TEST_F(Upgrade, FreesTheScales) {
  Film f;
  f.zoom = 0.2, f.shapes = 1;
  enter(film(f));
  const double before = solve("rigid", {});
  EXPECT_THAT(explain_it(), ::testing::ElementsAre("tracks.scale")) << sentence_;
  const double after = solve("rigid", {});
  EXPECT_LT(after, 0.5 * before);
  EXPECT_THAT(explain_it(), ::testing::IsEmpty()) << sentence_;
  std::printf("e3D %.4f -> %.4f\n", before, after);
}

TEST_F(Upgrade, GivesTheSequenceItsCamera) {
  Film f;
  f.inverse_focal = 2e-4;
  enter(film(f));
  solve("pta", {{"terms", 2}});
  EXPECT_THAT(explain_it(), ::testing::ElementsAre("tracks.perspective")) << sentence_;
  const Sequence again = gonio::nrsfm::sequence_of(document_, "film");
  EXPECT_EQ(again.projection, gonio::nrsfm::Projection::perspective);
  ASSERT_TRUE(again.pinhole);
  EXPECT_NEAR(again.pinhole->fx_px, 5000, 250);
  EXPECT_THAT(explain_it(), ::testing::IsEmpty()) << sentence_;
}

}  // namespace
}  // namespace gonio::explain
