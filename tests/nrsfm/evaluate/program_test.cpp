// nrsfm-eval from its command line: what it enters into the manifest and the table, and what it says of input that
// cannot be: one line that names the place, the value and the remedy.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "eval_program.h"
#include "io/csv.h"
#include "io/mat.h"
#include "manifest/sections/evaluation.h"
#include "nrsfm/variables.h"

namespace gonio::nrsfm {
namespace {

using testing::HasSubstr;

using tests::Said;

class EvalProgram : public tests::EvalFolder {
 protected:
  void SetUp() override {
    const Shapes q = tests::deforming(30, 12, 1);
    write_truth(q, "truth", {{"deformation", "bending"}, {"path", "circle, wide"}});
    write(q, "exact");
    write(tests::noisy(q, 0.005, 0.05, 2), "good");
    write(-q, "mirrored");
    write_file(path("m.json"), R"({"gonio": 1, "files": {"t": {"path": "truth.mat"}, "g": {"path": "good.mat"}},
      "sequences": {"bend": {"file": "t", "factors": {"path": "line"}}},
      "reconstructions": [{"id": "bend-pta", "sequence": "bend", "algorithm": "pta",
      "file": "g", "frame": "object"}]})");
  }
};

TEST_F(EvalProgram, EntersEveryErrorWithItsAlignmentUnitAndInterval) {
  ASSERT_EQ(run({"--truth", path("truth.mat"), path("good.mat"), path("exact.mat"), path("mirrored.mat"), "--csv",
                 path("e.csv"), "--measure", "robust-rms", "--measure", "e3d", "--alignment", "frame-rotation"})
                .status,
            0);
  const manifest::Document d = manifest::read_document(path("out.json"));
  ASSERT_EQ(d.evaluations.size(), 3);
  const manifest::Evaluation& good = d.evaluations[0];
  EXPECT_EQ(good.id, "good");
  EXPECT_EQ(good.algorithm, "pta");
  EXPECT_EQ(good.factors.at("deformation"), "bending");
  ASSERT_EQ(good.errors.size(), 2);
  EXPECT_EQ(good.errors[0].measure, "robust-rms");
  EXPECT_EQ(good.errors[0].alignment, "robust-similarity");
  EXPECT_EQ(good.errors[0].unit, "m");
  EXPECT_NEAR(good.errors[0].value, 0.001 * 0.005 * std::sqrt(3), 2e-6);
  EXPECT_LT(*good.errors[0].lower, good.errors[0].value);
  EXPECT_GT(*good.errors[0].upper, good.errors[0].value);
  EXPECT_EQ(good.errors[1].alignment, "frame-rotation");
  EXPECT_EQ(good.errors[1].unit, "1");
  EXPECT_FALSE(*good.mirrored);
  EXPECT_LT(d.evaluations[1].errors[0].value, 1e-15);
  EXPECT_TRUE(*d.evaluations[2].mirrored);
  EXPECT_THAT(d.evaluations[2].notes, testing::Contains(HasSubstr("only a reflection lays it onto the truth")));
  const io::Csv csv = io::read_csv(path("e.csv"));
  EXPECT_EQ(csv.rows.size(), 6);
  EXPECT_EQ(csv.rows[0][4], "circle, wide");
}

TEST_F(EvalProgram, ReadsManifestsAndReplacesEarlierEvaluations) {
  ASSERT_EQ(run({"-i", path("m.json"), "--measure", "rms", "--alignment", "none", "--draws", "0"}).status, 0);
  const manifest::Document once = manifest::read_document(path("out.json"));
  ASSERT_EQ(once.evaluations.size(), 1);
  EXPECT_EQ(once.evaluations[0].sequence, "bend");
  EXPECT_EQ(once.evaluations[0].factors.at("path"), "line");  // the manifest's word counts
  EXPECT_FALSE(once.evaluations[0].errors[0].lower);
  write_file(path("again.json"), read_file(path("out.json")));
  ASSERT_EQ(run({"-i", path("again.json"), "--measure", "e3d"}).status, 0);
  const manifest::Document twice = manifest::read_document(path("out.json"));
  ASSERT_EQ(twice.evaluations.size(), 1);
  EXPECT_EQ(twice.evaluations[0].errors[0].measure, "e3d");
}

TEST_F(EvalProgram, SameInputSameBytes) {
  ASSERT_EQ(run({"--truth", path("truth.mat"), path("good.mat"), "--threads", "1"}).status, 0);
  const std::string first = read_file(path("out.json"));
  ASSERT_EQ(run({"--truth", path("truth.mat"), path("good.mat"), "--threads", "4"}).status, 0);
  EXPECT_EQ(read_file(path("out.json")), first);
}

// What must not matter, as a user meets it: files whose similarity, handedness, frames' or points' order differ.
TEST_F(EvalProgram, SimilarityHandAndOrderDoNotMatter) {
  const Shapes q = tests::deforming(30, 12, 1), x = tests::noisy(q, 0.005, 0.05, 2);
  Random random(4);
  write(tests::moved_all(x, 3, tests::any_rotation(random), {1, -2, 0.5}), "moved");
  write(tests::moved_all(x, -0.2, tests::any_rotation(random), {0, 5, 0}), "mirrored-too");
  Shapes q_frames = q, x_frames = x, q_points = q, x_points = x;
  for (Eigen::Index f = 0; f < 30; ++f)  // 7 and 30 have no common factor, nor have 5 and 12
    shape_of(q_frames, f) = shape_of(q, 7 * f % 30), shape_of(x_frames, f) = shape_of(x, 7 * f % 30);
  for (Eigen::Index p = 0; p < 12; ++p) q_points.col(p) = q.col(5 * p % 12), x_points.col(p) = x.col(5 * p % 12);
  write_truth(q_frames, "truth-frames", {}), write_truth(q_points, "truth-points", {});
  write(x_frames, "frames"), write(x_points, "points");
  const auto errors = [&](const std::string& truth, const std::string& name) {
    EXPECT_EQ(run({"--truth", path(truth + ".mat"), path(name + ".mat"), "--draws", "0"}).status, 0) << name;
    return manifest::read_document(path("out.json")).evaluations.at(0);
  };
  const manifest::Evaluation plain = errors("truth", "good");
  const std::vector<std::pair<std::string, std::string>> others = {
      {"truth", "moved"}, {"truth", "mirrored-too"}, {"truth-frames", "frames"}, {"truth-points", "points"}};
  for (const auto& [truth, name] : others) {
    const manifest::Evaluation other = errors(truth, name);
    ASSERT_EQ(other.errors.size(), plain.errors.size());
    for (std::size_t k = 0; k < plain.errors.size(); ++k) {
      const manifest::EvaluatedError &a = plain.errors[k], &b = other.errors[k];
      const bool order_only = truth != "truth", any_similarity = a.alignment.ends_with("-similarity");
      if (!order_only && !any_similarity) continue;
      EXPECT_NEAR(b.value, a.value, (a.measure == "robust-rms" ? 1e-7 : 1e-12) * a.value)
          << name << " " << a.measure << " " << a.alignment;
    }
    EXPECT_EQ(*other.mirrored, name == "mirrored-too");
  }
}

TEST_F(EvalProgram, CheckLooksForTheFilesAndWritesNothing) {
  EXPECT_EQ(run({"-i", path("m.json"), "--check", "--csv", path("e.csv")}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(path("e.csv")));
  EXPECT_FALSE(std::filesystem::exists(path("out.json")));
  std::filesystem::remove(path("good.mat"));
  const Said said = run({"-i", path("m.json"), "--check"});
  EXPECT_EQ(said.status, 66);
  EXPECT_THAT(said.error, HasSubstr("\"good.mat\" cannot be read"));
}

TEST_F(EvalProgram, SaysWhereThereIsNoInterval) {
  ASSERT_EQ(run({"--truth", path("truth.mat"), path("good.mat"), "--block", "11"}).status, 0);
  const manifest::Evaluation few = manifest::read_document(path("out.json")).evaluations[0];
  EXPECT_FALSE(few.errors[0].upper);
  EXPECT_THAT(few.notes, testing::Contains(HasSubstr("no intervals: they need ten frames and three blocks")));
  ASSERT_EQ(run({"--truth", path("truth.mat"), path("good.mat"), "--block", "10"}).status, 0);
  const manifest::Evaluation enough = manifest::read_document(path("out.json")).evaluations[0];
  EXPECT_TRUE(enough.errors[0].upper);
  EXPECT_TRUE(enough.notes.empty());
  // Of the exact shapes, the value lies within its interval although both are rounding.
  ASSERT_EQ(run({"--truth", path("truth.mat"), path("exact.mat")}).status, 0);
  for (const manifest::EvaluatedError& e : manifest::read_document(path("out.json")).evaluations[0].errors) {
    EXPECT_LE(*e.lower, e.value);
    EXPECT_GE(*e.upper, e.value);
  }
}

TEST_F(EvalProgram, MirroredWithoutLookingForFlips) {
  const Said said = run({"--truth", path("truth.mat"), path("mirrored.mat"), "--no-flips", "--draws", "0"});
  EXPECT_EQ(said.status, 0) << said.error;
  EXPECT_TRUE(*manifest::read_document(path("out.json")).evaluations[0].mirrored);
}

TEST_F(EvalProgram, PageShowsErrorsAndShapesAndLoadsNothing) {
  const std::vector<std::string> call{"--truth", path("truth.mat"), path("good.mat"), path("mirrored.mat"),
                                      "--html",  path("page.html"), "--views",        "1"};
  ASSERT_EQ(run(call).status, 0);
  const std::string page = read_file(path("page.html"));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_EQ(page.find("http://"), std::string::npos);
  EXPECT_EQ(page.find("https://"), std::string::npos);
  EXPECT_THAT(page, HasSubstr("mirrored: the whole sequence is mirrored."));
  const std::size_t view = page.find("<div class=\"motion\"");
  ASSERT_NE(view, std::string::npos);
  EXPECT_EQ(page.find("<div class=\"motion\"", view + 1), std::string::npos);
  EXPECT_LT(page.size(), 60000);                              // 30 frames of 12 points: 4 kB of coordinates
  ASSERT_EQ(run({call.begin(), call.end() - 1}).status, 64);  // --views needs a number
  std::vector<std::string> none = call;
  none.back() = "0";
  ASSERT_EQ(run(none).status, 0);
  EXPECT_EQ(read_file(path("page.html")).find("<div class=\"motion\""), std::string::npos);
}

struct Wrong {
  std::vector<std::string> arguments;
  int status;
  std::string says;
};

TEST_F(EvalProgram, RefusesInOneLineWithPlaceValueAndRemedy) {
  const Shapes q = tests::deforming(30, 12, 1);
  write(q.topRows(60), "short");
  write(q.leftCols(9), "narrow");
  write(Shapes::Constant(90, 12, std::numeric_limits<double>::quiet_NaN()), "nothing");
  write(Shapes::Zero(90, 12), "point");
  Reconstruction camera;
  camera.shapes = q, camera.frame = ShapeFrame::camera;
  write_reconstruction(camera, path("camera.mat"));
  io::write_mat({{"W", variable_of(Eigen::MatrixXd(Eigen::MatrixXd::Random(60, 12)))}}, path("tracks.mat"));
  io::write_mat({{"odd", variable_of(Eigen::MatrixXd(q))}}, path("odd.mat"));
  io::write_mat({{"S", variable_of(std::string("shapes"))}}, path("text.mat"));
  const std::string whole = read_file(path("good.mat"));
  write_file(path("cut.mat"), whole.substr(0, whole.size() / 2));
  write_file(path("words.mat"), std::string(400, 'w'));
  write_file(path("bad.npz"), "PK");
  write_file(path("shapes.csv"), "1,2,3\n");
  write_file(path("frames.json"), R"({"gonio": 1, "files": {"t": {"path": "truth.mat"}, "g": {"path": "good.mat"}},
    "sequences": {"bend": {"file": "t", "frames": 31}},
    "reconstructions": [{"id": "a", "sequence": "bend", "algorithm": "pta", "file": "g"}]})");
  write_file(path("unknown.json"), R"({"gonio": 1, "files": {"g": {"path": "good.mat"}},
    "reconstructions": [{"id": "a", "sequence": "bent", "algorithm": "pta", "file": "g"}]})");
  write_file(path("empty.json"), R"({"gonio": 1})");
  const std::string truth = path("truth.mat"), good = path("good.mat");
  const std::vector<Wrong> wrong{
      {{"--truth", truth}, 64, "RECONSTRUCTION: is missing"},
      {{good}, 64, "--truth: is missing"},
      {{"-i", path("empty.json")}, 65, "has no reconstruction; give a manifest"},
      {{"--truth", truth, good, "--measure", "rmse"}, 64, "choose one of"},
      {{"--truth", truth, good, "--confidence", "95"}, 64, "--confidence"},
      {{"--truth", path("none.mat"), good}, 66, "none.mat"},
      {{"--truth", path("tracks.mat"), good}, 65, "has no truth; give a file with S"},
      {{"--truth", truth, path("short.mat")}, 65, "has 20 frames x 12 points, the truth has 30 frames x 12 points"},
      {{"--truth", truth, path("narrow.mat")}, 65, "has 30 frames x 9 points"},
      {{"--truth", truth, path("nothing.mat")}, 65, "has 0 finite points where the truth is known, 4 is the least"},
      {{"--truth", truth, path("point.mat")}, 65, "has all its points in one place"},
      {{"--truth", truth, path("camera.mat")}, 65, "store the cameras (R, T)"},
      {{"--truth", truth, path("odd.mat")}, 65, "it has odd; name the variable"},
      {{"--truth", truth, good, "--shapes-variable", "Shat"}, 65, "has no variable Shat"},
      {{"--truth", truth, path("text.mat")}, 65, "holds no numbers"},
      {{"--truth", truth, path("cut.mat")}, 65, "truncated"},
      {{"--truth", truth, path("words.mat")}, 65, "is no MATLAB file"},
      {{"--truth", truth, path("bad.npz")}, 65, "is no whole NumPy archive"},
      {{"--truth", truth, path("shapes.csv")}, 65, "is neither .mat nor .npz"},
      {{"--truth", truth, path("gone") + "/f_*.ply"}, 66, "names no .ply file"},
      {{"-i", path("frames.json")}, 65, "/sequences/bend/frames"},
      {{"-i", path("unknown.json")}, 65, "names \"bent\", which is not in sequences"},
      {{"--truth", truth, good, "--csv", path("no/such/e.csv")}, 73, "e.csv"}};
  for (const Wrong& w : wrong) {
    const Said said = run(w.arguments);
    EXPECT_EQ(said.status, w.status) << w.says << " / " << said.error;
    EXPECT_THAT(said.error, HasSubstr(w.says));
    EXPECT_EQ(std::ranges::count(said.error, '\n'), 1) << said.error;
  }
}

}  // namespace
}  // namespace gonio::nrsfm
