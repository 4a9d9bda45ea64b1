// cloud-mesh as people run it: views of a ball in the world become a mesh that other programs read, and what is
// refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/atomic_file.h"
#include "base/text.h"
#include "data.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/mesh.h"
#include "mesh/seen_world.h"
#include "mesh/shapes.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

const io::PlyWish columns{.properties = {"sigma", "cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz"}};

const mesh::MeasuredPoints& ball() {
  static const mesh::MeasuredPoints once = [] {
    const io::TriangleMesh truth = mesh::shapes::ball(0.05, 5);
    const mesh::TriangleTree tree(truth.positions_m, truth.triangles);
    mesh::MeasuredPoints points;
    for (const double x : {-0.25, 0.25})
      see(tree, truth, {.camera = {x, 0, 0.4}, .target = {}, .width = 90, .height = 90, .f_px = 360}, 1, points);
    return points;
  }();
  return once;
}

class CloudMesh : public testing::Test {
 protected:
  void SetUp() override {
    for (std::uint32_t v = 0; v < 2; ++v) io::write_ply(folder_ / format("%u.ply", v), cloud(v), columns);
    write("scan.json", clouds());
  }
  static io::TriangleMesh cloud(std::uint32_t view) {
    io::TriangleMesh mesh;
    mesh.properties.resize(columns.properties.size());
    for (std::size_t i = 0; i < ball().view.size(); ++i) {
      if (ball().view[i] != view) continue;
      mesh.positions_m.push_back(ball().positions_m[i]);
      const auto& c = ball().covariance_m2[i];
      mesh.properties[0].push_back(static_cast<float>(std::sqrt(c[0] + c[3] + c[5])));
      for (std::size_t k = 0; k < 6; ++k) mesh.properties[k + 1].push_back(static_cast<float>(c[k]));
    }
    return mesh;
  }
  // Two views whose images have poses: only where the cameras stand matters here.
  static std::string clouds() {
    return R"("cameras": {"c": {"width_px": 90, "height_px": 90, "fx_px": 360, "fy_px": 360, "cx_px": 45, "cy_px": 45}},
 "files": {"a": {"path": "0.ply"}, "b": {"path": "1.ply"}},
 "images": [
  {"id": "i0", "camera": "c", "group": "left",
   "world_from_camera": {"rotation": [1,0,0,0], "translation_m": [-0.25,0,0.4]}},
  {"id": "i1", "camera": "c", "group": "right",
   "world_from_camera": {"rotation": [1,0,0,0], "translation_m": [0.25,0,0.4]}}],
 "clouds": {"left": {"file": "a", "cameras": ["c"]}, "right": {"file": "b", "cameras": ["c"]}})";
  }
  void write(const char* name, const std::string& sections) {
    write_file(folder_ / name, "{\"gonio\": 1, " + sections + "}");
  }
  Ended mesh(std::vector<std::string> words, const char* manifest = "scan.json") {
    words.insert(words.begin(), {"cloud-mesh", "--depth", "6", "--out", "mesh", "-i", manifest});
    return run(words, folder_.path());
  }
  // One line with these words, this exit, and nothing written.
  void expect_refused(const Ended& ended, int status, const char* words) {
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(words));
    EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
    EXPECT_EQ(ended.out, "");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "mesh/mesh.ply"));
  }
  void replace(const std::string& what, const std::string& by) {
    std::string all = clouds();
    const std::size_t at = all.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    write("bad.json", all.replace(at, what.size(), by));
  }

  ScratchFolder folder_;
};

TEST_F(CloudMesh, TwoViewsBecomeOneMeshThatStatesItsError) {
  const Ended made = mesh({"--html", "page.html"});
  ASSERT_EQ(made.status, 0) << made.err;
  const manifest::Document d = manifest::parse_document(made.out, "mesh.json", folder_.path());
  const io::TriangleMesh found = io::read_ply(manifest::resolve(d, d.meshes.at("mesh").file, "/meshes/mesh"),
                                              {.properties = {"sigma", "deviation"}});
  ASSERT_GT(found.triangles.size(), 1000U);
  double squares = 0, stated = 0;
  for (std::size_t v = 0; v < found.positions_m.size(); ++v) {
    const double off = norm(found.positions_m[v]) - 0.05, sigma = double{found.properties[0][v]};
    squares += off * off, stated += sigma * sigma;
  }
  EXPECT_NEAR(std::sqrt(squares / stated), 1, 0.3);
  const std::string page = read_file(folder_ / "page.html");
  EXPECT_THAT(page, HasSubstr("in 1 component, half of them known to"));
  EXPECT_THAT(page, HasSubstr("How far the points lie off it"));
  EXPECT_THAT(made.err, HasSubstr("times what they state"));
  EXPECT_EQ(mesh({"--html", "page.html", "--force"}).out.size(), made.out.size());
}

TEST_F(CloudMesh, TheThesissChainRunsBeside) {
  const Ended made = mesh({"--chain", "thesis", "--neighbours", "60", "--name", "plain", "--view", "left"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "mesh/plain.ply"));
}

TEST_F(CloudMesh, PointsThatContradictWhatTheyStateEndInTwo) {
  io::TriangleMesh bold = cloud(0);
  for (auto& column : bold.properties)
    for (float& v : column) v *= 0.01f;
  io::write_ply(folder_ / "0.ply", bold, columns);
  const Ended made = mesh({"--view", "left"});
  EXPECT_EQ(made.status, 2) << made.err;
  EXPECT_THAT(made.err, HasSubstr("times what they state (limit 2)"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "mesh/mesh.ply"));
}

TEST_F(CloudMesh, PointsOnALineEndInOneAndWriteNothing) {
  io::TriangleMesh line = cloud(0);
  for (std::size_t i = 0; i < line.positions_m.size(); ++i) line.positions_m[i] = {1e-4 * static_cast<double>(i), 0, 0};
  io::write_ply(folder_ / "0.ply", line, columns);
  const Ended made = mesh({"--view", "left"});
  EXPECT_EQ(made.status, 1) << made.err;
  EXPECT_THAT(made.err, HasSubstr("no surface"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "mesh/mesh.ply"));
}

TEST_F(CloudMesh, CallsThatCannotBeMeantAreRefused) {
  expect_refused(mesh({"--depth", "2"}), 64, "--depth");
  expect_refused(mesh({"--depth", "13"}), 64, "--depth");
  expect_refused(mesh({"--chain", "best"}), 64, "--chain");
  expect_refused(mesh({"--trim", "0"}), 64, "--trim");
  expect_refused(mesh({"--view", "top"}), 64, "top is none of the manifest's clouds");
  expect_refused(mesh({"--view", "left", "--view", "left"}), 64, "left is given twice");
  expect_refused(mesh({"--viewpoint", "left=0,0"}), 64, "is no viewpoint");
  expect_refused(mesh({"--viewpoint", "left=0,0,nan"}), 64, "is no viewpoint");
  expect_refused(mesh({"--viewpoint", "top=0,0,1"}), 64, "top is none of the clouds");
  expect_refused(mesh({"--viewpoint", "left=0,0,1", "--viewpoint", "left=0,0,2"}), 64, "is the second one");
  expect_refused(run({"cloud-mesh", "-i", "scan.json"}, folder_.path()), 64, "--out");
}

TEST_F(CloudMesh, ManifestsWithoutWhatItTakesAreRefused) {
  write("bad.json", "\"clouds\": {}");
  expect_refused(mesh({}, "bad.json"), 66, "has none");
  replace("\"path\": \"0.ply\"", "\"path\": \"2.ply\"");
  expect_refused(mesh({}, "bad.json"), 66, "2.ply");
  replace("\"cameras\": [\"c\"]}, \"right\"", "\"cameras\": []}, \"right\"");
  expect_refused(mesh({}, "bad.json"), 65, "names no camera that saw it");
  replace("\"group\": \"left\"", "\"group\": \"other\"");
  expect_refused(mesh({}, "bad.json"), 65, "neither an image nor a rig says where that stood");
  replace("\"group\": \"left\"", "\"group\": \"other\"");
  write("bad.json", clouds().replace(clouds().find("\"group\": \"left\""), 15, "\"group\": \"else\"") +
                        R"(, "rigs": {"r": {"cameras": [{"camera": "c",
   "rig_from_camera": {"rotation": [1,0,0,0], "translation_m": [0,0,0]}}]}})");
  expect_refused(mesh({}, "bad.json"), 65, "lies in the frame of its rig");
  write("bad.json", clouds() + R"(, "meshes": {"mesh": {"sphere": {"radius_m": 1}}})");
  expect_refused(mesh({}, "bad.json"), 65, "is there already");
}

TEST_F(CloudMesh, CloudsThatAreNoneAreRefused) {
  const auto with = [&](const std::function<void(io::TriangleMesh&)>& change, const io::PlyWish& names = columns) {
    io::TriangleMesh changed = cloud(0);
    change(changed);
    io::write_ply(folder_ / "0.ply", changed, names);
    return mesh({"--view", "left"});
  };
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
  expect_refused(with([](io::TriangleMesh& m) { m.positions_m.clear(), m.properties.assign(7, {}); }), 65,
                 "has no vertices");
  expect_refused(with([](io::TriangleMesh& m) {
                   m.positions_m.resize(57);
                   for (auto& column : m.properties) column.resize(57);
                 }),
                 65, "have 57 points together");
  expect_refused(with([](io::TriangleMesh& m) { m.positions_m[3].y = std::nan(""); }), 65, "0.ply");
  expect_refused(with([&](io::TriangleMesh& m) { m.properties[4][5] = nan; }), 65, "0.ply");
  expect_refused(with([&](io::TriangleMesh& m) { m.properties[1][5] = infinite; }), 65, "0.ply");
  expect_refused(with([](io::TriangleMesh& m) { m.properties[1][5] = -1e-8f; }), 65, "covariance of point 5 is none");
  expect_refused(with([](io::TriangleMesh& m) { m.properties[2][5] = 1; }), 65, "covariance of point 5 is none");
  expect_refused(with([](io::TriangleMesh& m) {
                   for (std::size_t k = 1; k < 7; ++k) m.properties[k][5] = 0;
                 }),
                 65, "covariance of point 5 is none");
  expect_refused(with([](io::TriangleMesh& m) { m.properties.clear(); }, {}), 65, "states no error of its points");
  expect_refused(with([](io::TriangleMesh& m) {
                   m.positions_m[7] = {-0.25, 0, 0.4};
                 }),
                 65, "point 7 lies at a viewpoint");
  write_file(folder_ / "0.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\n");
  expect_refused(mesh({"--view", "left"}), 65, "0.ply");
}

}  // namespace
}  // namespace gonio::tests
