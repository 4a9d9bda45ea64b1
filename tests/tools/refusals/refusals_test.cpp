// Bad inputs and bad moments: each ends a program with the right exit status and one clear line, and leaves no output.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <fstream>
#include <limits>
#include <set>

#include "base/atomic_file.h"
#include "data.h"
#include "io/picture.h"
#include "io/ply.h"
#include "process.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A tetrahedron above a table, one lamp, one camera; small enough to render in no time.
constexpr const char* scene = R"({
 "gonio": 1,
 "files": {"f1": {"path": "mesh.ply"}},
 "cameras": {"c": {"model": "radial-tangential", "width_px": 16, "height_px": 12,
   "fx_px": 20, "fy_px": 20, "cx_px": 7.5, "cy_px": 5.5}},
 "images": [{"id": "one", "camera": "c", "light": "l",
   "world_from_camera": {"rotation": [0, 1, 0, 0], "translation_m": [0, 0, 1]}}],
 "meshes": {"m": {"file": "f1"}, "table": {"plane": {"size_m": [1, 1]}}},
 "surfaces": {"s": {"model": "diffuse", "albedo": [0.5, 0.5, 0.5]}},
 "lights": {"l": {"model": "point", "position_m": [0.2, -0.3, 0.9], "watt_per_sr": [1, 1, 1]}},
 "objects": [{"id": "thing", "mesh": "m", "surface": "s"}, {"id": "table", "mesh": "table", "surface": "s"}]
})";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

class Refusals : public testing::Test {
 protected:
  Refusals() {
    write_file(path("scene.json"), scene);
    const double a = 0.1;
    io::TriangleMesh mesh;
    mesh.positions_m = {{0, 0, 2 * a}, {a, 0, a / 10}, {-a, a, a / 10}, {-a, -a, a / 10}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    io::write_ply(path("mesh.ply"), mesh);
    io::Image image(16, 12, {"R", "G", "B"});
    for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = 0.001f * static_cast<float>(i % 700);
    io::write_picture(path("a.exr"), image);
    io::write_picture(path("b.exr"), image);
    io::write_picture(path("b.png"), image);
  }
  fs::path path(std::string_view name) const { return folder_ / name; }

  Ended in_folder(const Process::Words& words, const std::function<void()>& before = {}) const {
    return run(words, folder_.path(), {}, before);
  }

  // `words` must end with `status`, one line on stderr that names the program and `mentions`, nothing on stdout, and
  // must leave no file behind that was not there before.
  void expect_refused(const Process::Words& words, int status, const std::string& mentions,
                      const std::function<void()>& before = {}) const {
    const auto files_before = files();
    const Ended ended = in_folder(words, before);
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_THAT(ended.err, testing::StartsWith(words[0] + ": "));
    EXPECT_THAT(ended.err, HasSubstr(mentions));
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(files(), files_before);
  }

  // The scene with one thing made wrong.
  void expect_scene_refused(const std::string& from, const std::string& to, int status, const std::string& mentions) {
    write_file(path("bad.json"), replaced(scene, from, to));
    expect_refused({"render", "bad.json", "--spp", "1", "--out", "r"}, status, mentions);
  }

  std::set<fs::path> files() const {
    std::set<fs::path> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
      if (!entry.is_directory()) names.insert(entry.path());
    return names;
  }

 private:
  ScratchFolder folder_;
};

const Process::Words render = {"render", "scene.json", "--spp", "1", "--out", "r"};

TEST_F(Refusals, TheSceneItselfIsFine) {
  const Ended ended = in_folder(render);
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("\"renderings\""));
  const Ended compared = in_folder({"compare", "--reference", "a.exr", "--rendered", "b.exr"});
  EXPECT_EQ(compared.status, 0) << compared.err;
}

TEST_F(Refusals, ManifestsThatAreNone) {
  write_file(path("cut.json"), std::string(scene).substr(0, 300));
  expect_refused({"render", "cut.json", "--out", "r"}, 65, "cut.json");
  write_file(path("empty.json"), "");
  expect_refused({"render", "empty.json", "--out", "r"}, 65, "empty.json");
  expect_refused({"render", "none.json", "--out", "r"}, 66, "none.json");
  expect_scene_refused("\"gonio\": 1", "\"gonio\": 99", 65, "bad.json#/gonio");
}

TEST_F(Refusals, ValuesThatCannotBe) {
  const std::string rotation = "[0, 1, 0, 0]";
  expect_scene_refused(rotation, "[NaN, 1, 0, 0]", 65, "bad.json");
  expect_scene_refused(rotation, "[1e999, 1, 0, 0]", 65, "bad.json");
  expect_scene_refused(rotation, "[0, 1, 0.1, 0]", 65, "bad.json#/images/0/world_from_camera");
  expect_scene_refused("\"rotation\": [0, 1, 0, 0], \"translation_m\": [0, 0, 1]",
                       "\"matrix\": [[1, 0, 0, 0], [0, -1.1, 0, 0], [0, 0, -1, 1], [0, 0, 0, 1]]", 65,
                       "bad.json#/images/0/world_from_camera");
  expect_scene_refused("\"width_px\": 16", "\"width_px\": -16", 65, "bad.json#/cameras/c/width_px");
  expect_scene_refused("\"fx_px\": 20", "\"fx_px\": \"20\"", 65, "bad.json#/cameras/c/fx_px");
}

TEST_F(Refusals, KeysAndNamesThatNobodyKnows) {
  expect_scene_refused("\"fx_px\": 20,", "\"fx_mm\": 20,", 65, "fx_mm");
  expect_scene_refused("\"camera\": \"c\"", "\"camera\": \"d\"", 65, "bad.json#/images/0/camera");
  expect_scene_refused("\"model\": \"diffuse\"", "\"model\": \"plaid\"", 65, "plaid");
  expect_scene_refused("\"mesh\": \"m\"", "\"mesh\": \"n\"", 65, "bad.json#/objects/0/mesh");
}

TEST_F(Refusals, AnEmptyListOfImages) {
  const std::string text = scene;
  const auto first = text.find("\"images\": [") + 11, last = text.find("],\n \"meshes\"");
  write_file(path("bad.json"), text.substr(0, first) + text.substr(last));
  expect_refused({"render", "bad.json", "--spp", "1", "--out", "r"}, 65, "image");
}

TEST_F(Refusals, FilesOfTheManifest) {
  expect_scene_refused("\"mesh.ply\"", "\"none.ply\"", 66, "none.ply");
  expect_scene_refused("\"mesh.ply\"", "\"../mesh.ply\"", 65, "bad.json#/files/f1");
  expect_scene_refused("\"mesh.ply\"", "\"mesh.ply\", \"sha256\": \"" + std::string(64, '0') + "\"", 65, "mesh.ply");
  expect_scene_refused("\"mesh.ply\"", "\"mesh.ply\", \"bytes\": 3", 65, "mesh.ply");
}

TEST_F(Refusals, DamagedMeshes) {
  const std::string whole = read_file(path("mesh.ply"));
  for (const std::size_t tenth : {0, 1, 5, 9}) {
    write_file(path("mesh.ply"), whole.substr(0, whole.size() * tenth / 10));
    expect_refused(render, 65, "mesh.ply");
  }
  write_file(path("mesh.ply"), replaced(whole, "vertex 4", "vertex 1000000000000"));
  expect_refused(render, 65, "1000000000000");
}

TEST_F(Refusals, DamagedPictures) {
  for (const char* name : {"b.exr", "b.png"}) {
    const std::string whole = read_file(path(name));
    for (const std::size_t tenth : {0, 1, 5, 9}) {
      write_file(path(name), whole.substr(0, whole.size() * tenth / 10));
      expect_refused({"compare", "--reference", "a.exr", "--rendered", name}, 65, name);
    }
  }
  io::write_picture(path("b.exr"), io::Image(15, 12, {"R", "G", "B"}));
  expect_refused({"compare", "--reference", "a.exr", "--rendered", "b.exr"}, 65, "15");
  expect_refused({"compare", "--reference", "a.exr", "--rendered", "none.exr"}, 66, "none.exr");
}

TEST_F(Refusals, CommandLines) {
  expect_refused({"render", "scene.json", "--spp", "1", "--out", "r", "--colour"}, 64, "--colour");
  expect_refused({"render", "scene.json", "--spp", "-3", "--out", "r"}, 64, "--spp");
  expect_refused({"calib-charuco", "--checkerboard", "9x6", "--square", "25deg", "a.exr"}, 64, "--square");
  expect_refused({"calib-charuco", "--checkerboard", "9x6", "--square", "25", "a.exr"}, 64, "--square");
  expect_refused({"calib-charuco", "--checkerboard", "9x6", "--square", "25mm", "none.png"}, 66, "none.png");
}

TEST_F(Refusals, OutputsThatStandThere) {
  EXPECT_EQ(in_folder(render).status, 0);
  expect_refused(render, 73, "--force");
  auto forced = render;
  forced.emplace_back("--force");
  EXPECT_EQ(in_folder(forced).status, 0);
}

TEST_F(Refusals, AFolderThatMayNotBeWrittenTo) {
  fs::create_directory(path("locked"));
  fs::permissions(path(""), fs::perms::all);
  fs::permissions(path("locked"), fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_exec);
  const auto as_nobody = [] {
    if (::geteuid() == 0 && ::setuid(65534) != 0) ::_exit(125);
  };
  expect_refused({"render", "scene.json", "--spp", "1", "--out", "locked/r"}, 73, "locked", as_nobody);
  expect_refused({"render", "scene.json", "--spp", "1", "--out", "r", "-o", "locked/out.json"}, 73, "locked",
                 as_nobody);
}

// A small tmpfs where that may be mounted, in a mount namespace of this test's own.
TEST_F(Refusals, AFullDisk) {
  fs::create_directory(path("small"));
  if (::mount("none", path("small").c_str(), "tmpfs", 0, "size=64k") != 0) GTEST_SKIP() << "mounting is not allowed";
  write_file(path("small/filler"), std::string(64 << 10, 'x'));
  const Ended ended = in_folder({"render", "scene.json", "--spp", "1", "--out", "small/r"});
  std::vector<fs::path> left;
  for (const auto& entry : fs::recursive_directory_iterator(path("small")))
    if (!entry.is_directory() && entry.path().filename() != "filler") left.push_back(entry.path());
  ::umount(path("small").c_str());
  EXPECT_EQ(ended.status, 74) << ended.err;
  EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("small/r"));
  EXPECT_THAT(left, testing::IsEmpty());
}

TEST_F(Refusals, AFileSizeLimit) {
  expect_refused({"render", "scene.json", "--spp", "1", "--out", "r"}, 74, "r/", [] {
    const rlimit limit{1024, 1024};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  });
}

TEST_F(Refusals, AClosedPipe) {
  const Ended ended =
      in_folder({"bash", "-c", "set -o pipefail; '" GONIO_BIN "/render' scene.json --spp 1 --out r | true"});
  EXPECT_TRUE(ended.status == 74 || ended.status == 0) << ended.status << " " << ended.err;
  const Ended closed = in_folder({"bash", "-c", "exec '" GONIO_BIN "/render' scene.json --spp 1 --out s >/dev/full"});
  EXPECT_EQ(closed.status, 74) << closed.err;
}

// Waits until a process has installed its handlers (SigCgt of proc(5)): before that a signal is not the program's to
// answer.
bool handles_signals(pid_t id) {
  for (int tries = 0; tries < 3000; ++tries, ::usleep(10000)) {
    std::ifstream status("/proc/" + std::to_string(id) + "/status");
    for (std::string line; std::getline(status, line);)
      if (line.starts_with("SigCgt:") && (std::stoull(line.substr(7), nullptr, 16) >> (SIGTERM - 1) & 1) != 0)
        return true;
  }
  return false;
}

TEST_F(Refusals, SignalsAndKillLeaveNothingHalfWritten) {
  const auto before = files();
  for (const int signal : {SIGTERM, SIGINT, SIGKILL}) {
    Process process({"render", "scene.json", "--spp", "1000000", "--out", "r"}, path(""));
    ASSERT_TRUE(handles_signals(process.id()));
    ::usleep(200000);
    ::kill(process.id(), signal);
    const Ended ended = process.end();
    EXPECT_EQ(ended.status, signal == SIGKILL ? 128 + SIGKILL : 75) << ended.err;
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(files(), before) << "after signal " << signal;
  }
}

TEST_F(Refusals, NanAndInfinityFailAComparison) {
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    io::Image image = io::read_picture(path("a.exr"));
    image.at(3, 4, 1) = value;
    io::write_picture(path("b.exr"), image);
    const Ended ended = in_folder({"compare", "--reference", "a.exr", "--rendered", "b.exr"});
    EXPECT_TRUE(ended.status == 1 || ended.status == 65) << ended.status << " " << ended.err;
  }
}

}  // namespace
}  // namespace gonio::tests
