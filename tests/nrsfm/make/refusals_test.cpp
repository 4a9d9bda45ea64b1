// What people give nrsfm-make by mistake: the right exit status, one line that says what is wrong, nothing written; and
// what --resume keeps.
#include <gmock/gmock.h>

#include <cmath>

#include "base/atomic_file.h"
#include "data.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/sequence.h"
#include "nrsfm/files.h"
#include "tools/nrsfm-make/call.h"

namespace gonio::nrsfm {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Words = std::vector<std::string>;

class MakeProgram : public ::testing::Test {
 protected:
  // Three frames of a square sheet that rises, with five points on it.
  void SetUp() override {
    fs::create_directories(folder_ / "scans");
    shapes_.resize(9, 5);
    for (int f = 0; f < 3; ++f) {
      io::TriangleMesh mesh;
      const double z = 0.01 * f;
      mesh.positions_m = {{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z}};
      mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
      io::write_ply(folder_ / "scans" / ("f" + std::to_string(f) + ".ply"), mesh);
      shape_of(shapes_, f) << 0.1, 0.2, 0.7, 0.5, 0.9, 0.1, 0.5, 0.3, 0.8, 0.6, z, z, z, z, z;
    }
    write_tracks("tracks.mat", shapes_);
  }
  void write_tracks(const std::string& name, const Shapes& shapes) {
    Reconstruction r;
    r.name = "tracks", r.shapes = shapes;
    write_reconstruction(r, folder_ / name);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  struct Said {
    int status = 0;
    std::string error;
  };
  // The program's own options, checks and work, without the program.
  Said run(Words words) {
    cli::Program program;
    program.name = "nrsfm-make", program.sentence = "make tracks";
    program.options = gonio::tools::nrsfm_make::options();
    program.takes_out = program.takes_seed = program.takes_resume = true;
    program.check = gonio::tools::nrsfm_make::check, program.run = gonio::tools::nrsfm_make::run;
    words.insert(words.begin(), "nrsfm-make");
    words.insert(words.end(), {"-o", path("m.json")});
    std::vector<char*> argv;
    for (std::string& w : words) argv.push_back(w.data());
    ::testing::internal::CaptureStderr();
    const int status = cli::main(program, static_cast<int>(argv.size()), argv.data());
    return {status, ::testing::internal::GetCapturedStderr()};
  }
  void expect_refused(Words words, int status, const std::string& mentions) {
    const Said said = run(words);
    EXPECT_EQ(said.status, status) << said.error;
    EXPECT_EQ(std::count(said.error.begin(), said.error.end(), '\n'), 1) << said.error;
    EXPECT_THAT(said.error, HasSubstr(mentions));
    EXPECT_FALSE(fs::exists(folder_ / "m.json")) << said.error;
  }
  void expect_scans_refused(const std::string& meshes, const std::string& tracks, int status,
                            const std::string& mentions, const Words& more = {}) {
    Words words{"--meshes", path(meshes), "--tracks", path(tracks), "--out", path("o")};
    words.insert(words.end(), more.begin(), more.end());
    expect_refused(words, status, mentions);
  }
  gonio::tests::ScratchFolder folder_;
  Shapes shapes_;
};

TEST_F(MakeProgram, RefusesWhatNoDesignHas) {
  expect_refused({"--kind", "melting", "--out", path("o")}, 64, "tearing");
  expect_refused({"--path", "spiral", "--out", path("o")}, 64, "half-circle");
  expect_refused({"--frames", "1", "--out", path("o")}, 64, "at least 2");
  expect_refused({"--points", "3", "--out", path("o")}, 64, "at least 4");
  expect_refused({"--distance", "1", "--out", path("o")}, 64, "at least 2");
  expect_refused({"--least-seen", "120%", "--out", path("o")}, 64, "at most");
  expect_refused({"--kind", "bending"}, 64, "--out");
  expect_refused({"--tracks-from", "optical-flow", "--missing", "without", "--out", path("o")}, 64, "--missing");
  expect_refused({"--unit", "1mm", "--out", path("o")}, 64, "needs --meshes");
}

TEST_F(MakeProgram, RefusesScansThatDoNotFit) {
  expect_refused({"--meshes", path("scans"), "--out", path("o")}, 64, "needs --tracks");
  expect_scans_refused("scans", "tracks.mat", 64, "--frames", {"--frames", "10"});
  expect_scans_refused("scans", "tracks.mat", 64, "cannot stand beside", {"--kind", "bending"});
  expect_scans_refused("scans", "tracks.mat", 64, "paint", {"--tracks-from", "optical-flow"});
  expect_scans_refused("scans", "tracks.mat", 64, "a/b", {"--name", "a/b"});
  expect_scans_refused("scans", "tracks.mat", 64, "not a length", {"--unit", "1kg"});
  expect_scans_refused("nowhere", "tracks.mat", 66, "nowhere");
  expect_scans_refused("scans", "nowhere.mat", 66, "nowhere.mat");
  write_tracks("two.mat", shapes_.topRows(6));
  expect_scans_refused("scans", "two.mat", 65, "2 frames");
  Shapes gaps = shapes_;
  gaps.topLeftCorner(3, 2).setConstant(std::nan(""));
  write_tracks("gaps.mat", gaps);
  expect_scans_refused("scans", "gaps.mat", 65, "3 points");
  write_tracks("far.mat", 1000 * shapes_);
  expect_scans_refused("scans", "far.mat", 65, "same unit");
  write_tracks("one.mat", Shapes::Constant(9, 5, 0.5));
  expect_scans_refused("scans", "one.mat", 65, "in one place");
  write_file(path("text.mat"), "hello");
  expect_scans_refused("scans", "text.mat", 65, "text.mat");
}

TEST_F(MakeProgram, RefusesMeshesThatAreNone) {
  const std::string whole = read_file(path("scans/f1.ply"));
  write_file(path("scans/f1.ply"), whole.substr(0, whole.size() - 5));
  expect_scans_refused("scans", "tracks.mat", 65, "f1.ply", {"--missing", "with"});
  io::TriangleMesh cloud;
  cloud.positions_m = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  io::write_ply(path("scans/f1.ply"), cloud);
  expect_scans_refused("scans", "tracks.mat", 65, "f1.ply", {"--missing", "with", "--force"});
}

TEST_F(MakeProgram, SequencesOfScansAreEntered) {
  const Said said = run({"--meshes", path("scans"), "--tracks", path("tracks.mat"), "--path", "line", "--name", "sheet",
                         "--out", path("o")});
  ASSERT_EQ(said.status, 0) << said.error;
  const manifest::Document document = manifest::read_document(path("m.json"));
  ASSERT_EQ(document.sequences.size(), 4u);
  const manifest::TrackSequence& entry = document.sequences.at("sheet-line-perspective-with");
  EXPECT_EQ(entry.factors.at("deformation"), "sheet");
  EXPECT_EQ(entry.tracks_from, "geometry");
  EXPECT_EQ(entry.frames, 3);
  const Sequence s = read_sequence(path("o/sheet-line-perspective-with.mat"));
  EXPECT_EQ((*s.truth - shapes_).cwiseAbs().maxCoeff(), 0);
  EXPECT_TRUE(s.visible.all());  // a sheet shows on both sides
  // A cell alone is the same as among others.
  ASSERT_EQ(run({"--meshes", path("scans"), "--tracks", path("tracks.mat"), "--path", "line", "--name", "sheet",
                 "--camera", "perspective", "--missing", "without", "--out", path("alone"), "--force"})
                .status,
            0);
  const std::string name = "sheet-line-perspective-without.mat";
  EXPECT_EQ(read_file(folder_ / "alone" / name), read_file(folder_ / "o" / name));
}

// Points on a wall's far side, which a camera that hardly moves never sees and one that goes around does: the cells
// without tracks are left out, the others written.
TEST_F(MakeProgram, LeavesOutCellsWithoutTracks) {
  Shapes behind(9, 5);
  for (int f = 0; f < 3; ++f) {
    io::TriangleMesh wall;
    wall.positions_m = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
    wall.triangles = {{0, 2, 1}, {0, 3, 2}};
    io::write_ply(path("scans/f" + std::to_string(f) + ".ply"), wall);
    shape_of(behind, f) << -0.7, 0.8, 0.1, -0.3, 0.5, 0.01, 0.01, 0.01, 0.01, 0.01, -0.8, -0.5, 0.9, 0.2, 0.6;
  }
  write_tracks("behind.mat", behind);
  const Words call{"--meshes", path("scans"), "--tracks", path("behind.mat"), "--camera", "perspective",
                   "--name",   "wall",        "--out",    path("o"),          "--path",   "tricky"};
  expect_refused(call, 65, "wall-tricky-perspective");
  Words both = call;
  both.insert(both.end(), {"--path", "flyby"});
  const Said said = run(both);
  EXPECT_EQ(said.status, 2) << said.error;
  EXPECT_EQ(std::count(said.error.begin(), said.error.end(), '\n'), 1) << said.error;
  EXPECT_THAT(said.error, HasSubstr("wall-tricky-perspective"));
  EXPECT_THAT(said.error, HasSubstr("left out"));
  const manifest::Document document = manifest::read_document(path("m.json"));
  EXPECT_EQ(document.sequences.size(), 2u);
  EXPECT_TRUE(document.sequences.contains("wall-flyby-perspective-with"));
  EXPECT_FALSE(fs::exists(folder_ / "o" / "wall-tricky-perspective-with.mat"));
}

// The same call again writes the same and simulates nothing; another call's files are not taken for its own.
TEST_F(MakeProgram, ResumeKeepsOnlyFilesOfTheSameCall) {
  const Words call{"--kind",   "stretching", "--path",   "circle", "--path", "line",    "--missing", "with",
                   "--frames", "12",         "--points", "20",     "--out",  path("o"), "--resume"};
  ASSERT_EQ(run(call).status, 0);
  const std::string manifest = read_file(path("m.json"));
  const fs::path first = folder_ / "o" / "stretching-circle-orthographic-with.mat";
  const fs::path second = folder_ / "o" / "stretching-line-perspective-with.mat";
  const std::string bytes = read_file(first), others = read_file(second);
  const auto time = fs::last_write_time(first);
  fs::remove(second), fs::remove(folder_ / "m.json");
  ASSERT_EQ(run(call).status, 0);
  EXPECT_EQ(fs::last_write_time(first), time);
  EXPECT_EQ(read_file(first), bytes);
  EXPECT_EQ(read_file(second), others);
  EXPECT_EQ(read_file(path("m.json")), manifest);
  fs::remove(folder_ / "m.json");
  Words other = call;
  other.insert(other.end(), {"--least-seen", "50%"});
  expect_refused(other, 73, "least seen 10%");
}

}  // namespace
}  // namespace gonio::nrsfm
