// nrsfm-solve from its command line: what it writes, what it leaves alone when it goes on, and what it says of input
// that cannot be: one line that names the place, the value and the remedy.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "base/atomic_file.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/reconstruction.h"
#include "manifest/sections/sequence.h"
#include "nrsfm/files.h"
#include "nrsfm/solve/listing.h"
#include "nrsfm/solve/solution_file.h"
#include "nrsfm/variables.h"
#include "synthetic.h"
#include "tools/nrsfm-solve/call.h"

namespace gonio::nrsfm::testing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

struct Said {
  int status = 0;
  std::string error;
};

class SolveProgram : public ::testing::Test {
 protected:
  // The program's own options, checks and work, without the program.
  Said run(std::vector<std::string> arguments) {
    cli::Program program;
    program.name = "nrsfm-solve";
    program.sentence = "solve";
    program.options = gonio::tools::nrsfm_solve::options();
    program.operands = {{.name = "TRACKS", .type = cli::Type::input_file, .help = "tracks", .repeat = true}};
    program.standalone = {"list"};
    program.takes_out = program.takes_seed = program.takes_resume = true;
    program.check = gonio::tools::nrsfm_solve::check;
    program.run = gonio::tools::nrsfm_solve::run;
    arguments.insert(arguments.begin(), "nrsfm-solve");
    arguments.insert(arguments.end(), {"-o", path("out.json")});
    std::vector<char*> argv;
    for (std::string& a : arguments) argv.push_back(a.data());
    ::testing::internal::CaptureStderr();
    const int status = cli::main(program, static_cast<int>(argv.size()), argv.data());
    return {status, ::testing::internal::GetCapturedStderr()};
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  manifest::Document out() const { return manifest::read_document(path("out.json")); }

  void SetUp() override {
    write_sequence(made({.frames = 30, .points = 20, .shapes = 2, .cosines = 2}), path("whole.mat"));
    Sequence gaps = made({.frames = 30, .points = 20, .shapes = 2, .cosines = 2, .seed = 2});
    hide_at_random(gaps, 0.1);
    gaps.factors = {{"path", "circle"}};
    write_sequence(gaps, path("gaps.mat"));
    write_file(path("m.json"), R"({"gonio": 1, "files": {"w": {"path": "whole.mat"}, "g": {"path": "gaps.mat"}},
      "sequences": {"whole": {"file": "w"}, "gaps": {"file": "g"}}})");
  }
  tests::ScratchFolder folder_;
};

std::vector<std::string> ids_of(const manifest::Document& document) {
  std::vector<std::string> ids;
  for (const manifest::ShapeReconstruction& r : document.reconstructions) ids.push_back(r.id);
  return ids;
}

TEST_F(SolveProgram, SolvesEverySequenceWithEverySolverThatTakesIt) {
  ASSERT_EQ(
      run({"--solver", "rigid", "--solver", "pta", "--set", "terms=2", "--out", path("a"), path("m.json")}).status, 0);
  const manifest::Document d = out();
  EXPECT_EQ(ids_of(d), (std::vector<std::string>{"gaps-rigid", "whole-rigid", "whole-pta"}));
  EXPECT_EQ(d.reconstructions[2].parameters.at("terms"), 2);
  EXPECT_LT(*d.reconstructions[2].reprojection_rms, 1e-6);
  EXPECT_THAT(d.sequences.at("gaps").notes, Contains(HasSubstr("pta: ")));
  EXPECT_TRUE(d.sequences.at("whole").notes.empty());
  const Reconstruction answer = read_reconstruction(path("a/gaps-rigid.mat"));
  EXPECT_EQ(answer.name, "rigid");
  EXPECT_EQ(answer.factors.at("path"), "circle");
  EXPECT_EQ(answer.factors.at("algorithm"), "rigid");
}

TEST_F(SolveProgram, AllSolversLeaveOutWhatTheyCannotTakeAndSayWhy) {
  const Said said = run({"--solver", "all", "--out", path("a"), "-i", path("m.json"), "--sequence", "gaps"});
  ASSERT_EQ(said.status, 0) << said.error;
  EXPECT_EQ(said.error, "");
  const manifest::Document d = out();
  EXPECT_THAT(ids_of(d), Contains("gaps-csf"));
  EXPECT_THAT(ids_of(d), ::testing::Not(Contains("gaps-pta")));
  std::size_t refusals = 0;
  for (const Solver* solver : all_solvers()) refusals += !solver->info().takes_missing || !solver->info().orthographic;
  EXPECT_EQ(d.sequences.at("gaps").notes.size(), refusals);
  EXPECT_EQ(d.reconstructions.size() + refusals, all_solvers().size());
}

TEST_F(SolveProgram, NotesOfAnEarlierCallGiveWay) {
  for (int k = 0; k < 2; ++k) {
    const std::string from = k == 0 ? path("m.json") : path("again.json");
    ASSERT_EQ(run({"--solver", "rigid", "--solver", "pta", "--out", path("a"), "--force", "-i", from}).status, 0);
    EXPECT_EQ(out().sequences.at("gaps").notes.size(), 1);
    EXPECT_EQ(out().reconstructions.size(), 3);
    write_file(path("again.json"), read_file(path("out.json")));
  }
}

TEST_F(SolveProgram, SameBytesWhateverTheThreads) {
  ASSERT_EQ(run({"--solver", "all", "--out", path("a"), "--threads", "1", path("m.json")}).status, 0);
  const std::string first = read_file(path("out.json"));
  ASSERT_EQ(run({"--solver", "all", "--out", path("a"), "--threads", "4", "--force", path("m.json")}).status, 0);
  EXPECT_EQ(read_file(path("out.json")), first);
}

TEST_F(SolveProgram, GoesOnWhereItWasInterrupted) {
  const std::vector<std::string> call{"--solver", "rigid", "--solver", "csf", "--out", path("a"), path("m.json")};
  ASSERT_EQ(run(call).status, 0);
  const std::string whole = read_file(path("out.json"));
  std::filesystem::remove(path("a/gaps-csf.mat"));
  const auto before = std::filesystem::last_write_time(path("a/whole-csf.mat"));
  EXPECT_EQ(run(call).status, 73);
  std::vector<std::string> on = call;
  on.push_back("--resume");
  ASSERT_EQ(run(on).status, 0);
  EXPECT_EQ(read_file(path("out.json")), whole);
  EXPECT_EQ(std::filesystem::last_write_time(path("a/whole-csf.mat")), before);
  on.insert(on.end(), {"--set", "rank=3"});
  const Said said = run(on);
  EXPECT_EQ(said.status, 73);
  EXPECT_THAT(said.error, HasSubstr("is not the answer that this call makes; --force replaces it"));
  std::ranges::replace(on, std::string("--resume"), std::string("--force"));
  ASSERT_EQ(run(on).status, 0);
  EXPECT_NE(read_file(path("out.json")), whole);
  EXPECT_GT(std::filesystem::last_write_time(path("a/whole-csf.mat")), before);
}

TEST_F(SolveProgram, SolutionsComeBackFromTheirFiles) {
  const Solver& solver = *find_solver("csf");
  Sequence sequence = read_sequence(path("gaps.mat"));
  const SolverOptions options{.values = {{"rank", 2}}, .most_iterations = 0, .seed = 3};
  Solution solution = solve(solver, sequence, options);
  solution.notes = {"one", "another"};
  const std::string identity = identity_of(solver, sequence, options);
  write_solution(solution, identity, path("s.mat"));
  const std::optional<Solution> back = read_solution(path("s.mat"), identity);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->values, solution.values);
  EXPECT_EQ(back->notes, solution.notes);
  EXPECT_EQ(back->iterations, solution.iterations);
  EXPECT_EQ(back->reprojection_rms, solution.reprojection_rms);
  EXPECT_EQ(back->reconstruction.shapes, solution.reconstruction.shapes);
  // The truth does not count, what the solver sees does.
  sequence.truth->setZero();
  EXPECT_EQ(identity_of(solver, sequence, options), identity);
  Sequence moved = sequence;
  moved.tracks = (moved.tracks.array() + 1).matrix();
  EXPECT_FALSE(read_solution(path("s.mat"), identity_of(solver, moved, options)));
  SolverOptions other = options;
  other.seed = 4;
  EXPECT_FALSE(read_solution(path("s.mat"), identity_of(solver, sequence, other)));
}

TEST_F(SolveProgram, ListsSolversWithParametersAndSources) {
  for (const Solver* solver : all_solvers()) {
    EXPECT_THAT(list_of_solvers(), HasSubstr(solver->info().id + ": " + solver->info().title));
    EXPECT_THAT(list_of_solvers(), HasSubstr(solver->info().source));
  }
}

TEST_F(SolveProgram, OneFailureAmongManyIsAWarningAndExitTwo) {
  Sequence flat = made({.frames = 30, .points = 20, .shapes = 1, .cosines = 1});
  flat.tracks.col(0) = flat.tracks.col(1);
  for (Eigen::Index f = 0; f < 30; ++f)
    if (f != 7) hide(flat, f, 0);
  write_sequence(flat, path("flat.mat"));  // a point that one frame sees
  const Said said = run({"--solver", "csf", "--set", "rank=3", "--out", path("a"), path("flat.mat"), path("gaps.mat")});
  EXPECT_EQ(said.status, 2) << said.error;
  EXPECT_THAT(said.error, HasSubstr("is seen in 1 frames"));
  EXPECT_EQ(ids_of(out()), (std::vector<std::string>{"gaps-csf"}));
  EXPECT_THAT(out().sequences.at("flat").notes, Contains(HasSubstr("csf: point 1 is seen in 1 frames")));
}

struct Wrong {
  std::vector<std::string> arguments;
  int status;
  std::string says;
};

TEST_F(SolveProgram, RefusesInOneLineWithPlaceValueAndRemedy) {
  const std::string bytes = read_file(path("whole.mat"));
  write_file(path("cut.mat"), bytes.substr(0, bytes.size() / 2));
  write_file(path("words.mat"), std::string(400, 'w'));
  write_file(path("tracks.txt"), "1 2 3\n");
  io::write_mat({{"W", variable_of(Eigen::MatrixXd(Eigen::MatrixXd::Random(61, 12)))}}, path("odd.mat"));
  io::write_mat({{"W", variable_of(Eigen::MatrixXd(Eigen::MatrixXd::Random(60, 3)))}}, path("three.mat"));
  io::write_mat({{"W", variable_of(Eigen::MatrixXd(Eigen::MatrixXd::Random(60, 12)))},
                 {"V", variable_of(Eigen::MatrixXd(Eigen::MatrixXd::Ones(30, 11)))}},
                path("narrow.mat"));
  io::write_mat({{"H", variable_of(Eigen::MatrixXd(Eigen::MatrixXd::Random(60, 12)))}}, path("unnamed.mat"));
  Eigen::MatrixXd holes = Eigen::MatrixXd::Random(60, 12);
  holes(8, 3) = std::numeric_limits<double>::infinity();
  io::write_mat({{"W", variable_of(holes)}, {"V", variable_of(Eigen::MatrixXd(Eigen::MatrixXd::Ones(30, 12)))}},
                path("infinite.mat"));
  io::write_mat({{"W", variable_of(Eigen::MatrixXd(Eigen::MatrixXd::Zero(60, 12)))}}, path("still.mat"));
  write_file(path("frames.json"), R"({"gonio": 1, "files": {"w": {"path": "whole.mat"}},
    "sequences": {"whole": {"file": "w", "frames": 31}}})");
  write_file(path("gone.json"), R"({"gonio": 1, "files": {"w": {"path": "gone.mat"}},
    "sequences": {"whole": {"file": "w"}}})");
  write_file(path("empty.json"), R"({"gonio": 1})");
  const std::string whole = path("whole.mat"), a = path("a");
  const std::vector<Wrong> wrong{
      {{"--out", a, whole}, 64, "--solver: is missing; name one, or all"},
      {{"--solver", "ptah", "--out", a, whole}, 64, "no solver \"ptah\"; one of "},
      {{"--solver", "pta", whole}, 64, "--out: is missing"},
      {{"--solver", "pta", "--out", a, path("empty.json")}, 64, "there is nothing to solve; give files, or"},
      {{"--solver", "pta", "--out", a, "--set", "terms", whole}, 64, "\"terms\" is no NAME=VALUE; write --set rank=4"},
      {{"--solver", "pta", "--out", a, "--set", "terms=x", whole}, 64, "--set"},
      {{"--solver", "pta", "--out", a, "--set", "ranks=2", whole}, 64, "no parameter ranks; pta has "},
      {{"--solver", "pta", "--out", a, "--set", "terms=2.5", whole}, 64, "terms=2.5 is out of bounds; whole numbers"},
      {{"--solver", "pta", "--out", a, "--set", "terms=2", "--set", "terms=3", whole}, 64, "terms is set twice"},
      {{"--solver", "pta", "--out", a, "--iterations", "-1", whole}, 64, "--iterations"},
      {{"--solver", "pta", "--out", a, "--sequence", "hole", path("m.json")}, 64, "the manifest has no \"hole\""},
      {{"--solver", "pta", "--out", whole, whole}, 73, "is no folder"},
      {{"--solver", "pta", "--out", a, path("none.mat")}, 66, "none.mat"},
      {{"--solver", "pta", "--out", a, path("gone.json")}, 66, "gone.mat"},
      {{"--solver", "pta", "--out", a, path("cut.mat")}, 65, "truncated"},
      {{"--solver", "pta", "--out", a, path("words.mat")}, 65, "is no MATLAB file"},
      {{"--solver", "pta", "--out", a, path("tracks.txt")}, 65, "is neither .mat nor .npz"},
      {{"--solver", "pta", "--out", a, path("odd.mat")}, 65, "odd.mat"},
      {{"--solver", "pta", "--out", a, path("three.mat")}, 65, "3 points"},
      {{"--solver", "pta", "--out", a, path("narrow.mat")}, 65, "is 30 x 11, the tracks have 30 frames x 12 points"},
      {{"--solver", "pta", "--out", a, path("unnamed.mat")}, 65, "it has H; name the variables"},
      {{"--solver", "pta", "--out", a, path("infinite.mat")}, 65, "frame 4"},
      {{"--solver", "pta", "--out", a, path("still.mat")}, 65, "all points lie in one place"},
      {{"--solver", "pta", "--out", a, path("frames.json")}, 65, "/sequences/whole/frames: 31 where the file has 30"},
      {{"--solver", "pta", "--out", a, path("gaps.mat")}, 65, "of the tracks are missing, and pta needs all of them"},
      {{"--solver", "mdh", "--out", a, whole}, 65, "the camera is orthographic"},
      {{"--solver", "csf", "--out", a, "--set", "rank=40", whole}, 65, "rank"}};
  for (const Wrong& w : wrong) {
    const Said said = run(w.arguments);
    EXPECT_EQ(said.status, w.status) << w.says << " / " << said.error;
    EXPECT_THAT(said.error, HasSubstr(w.says));
    EXPECT_EQ(std::ranges::count(said.error, '\n'), 1) << said.error;
  }
  EXPECT_TRUE(!std::filesystem::exists(a) || std::filesystem::is_empty(a));
}

}  // namespace
}  // namespace gonio::nrsfm::testing
