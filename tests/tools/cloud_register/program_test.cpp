// cloud-register as people run it: views are compared, refined, handed on to cloud-mesh; what is refused.
// One process: CloudRegister.*
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/atomic_file.h"
#include "base/text.h"
#include "data.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/cloud.h"
#include "manifest/sections/image.h"
#include "manifest/sections/registration.h"
#include "mesh/register/register_world.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const io::PlyWish columns{
    .properties = {"sigma", "reflected", "cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz"}};
const mesh::ViewMotion error{quaternion_of_rotation_vector({1e-3, -5e-4, 8e-4}), {2e-4, -1e-4, 4e-4}};

// The second view stands where an arm that errs would say.
const mesh::MeasuredPoints& bumps() {
  static const mesh::MeasuredPoints once = [] {
    mesh::MeasuredPoints points = seen(free_form(), {.side = 50, .f_px = 150}, 1);
    misplace(points, 1, error);
    return points;
  }();
  return once;
}

io::TriangleMesh cloud_of(const mesh::MeasuredPoints& points, std::uint32_t view) {
  io::TriangleMesh mesh;
  mesh.properties.resize(columns.properties.size());
  for (std::size_t i = 0; i < points.view.size(); ++i) {
    if (points.view[i] != view) continue;
    const auto& c = points.covariance_m2[i];
    mesh.positions_m.push_back(points.positions_m[i]);
    mesh.properties[0].push_back(static_cast<float>(std::sqrt(c[0] + c[3] + c[5])));
    mesh.properties[1].push_back(0.5f);
    for (std::size_t k = 0; k < 6; ++k) mesh.properties[k + 2].push_back(static_cast<float>(c[k]));
  }
  return mesh;
}

class CloudRegister : public testing::Test {
 protected:
  void SetUp() override {
    write_clouds(bumps());
    write("scan.json", clouds());
  }
  void write_clouds(const mesh::MeasuredPoints& points) {
    for (std::uint32_t v = 0; v < 2; ++v) io::write_ply(folder_ / format("%u.ply", v), cloud_of(points, v), columns);
    for (std::uint32_t v = 0; v < 2; ++v) cameras_[v] = points.viewpoints_m[v][0];
  }
  std::string clouds(const std::string& sigma = "") const {
    const auto place = [&](std::size_t v) {
      return format("\"world_from_camera\": {\"rotation\": [1,0,0,0], \"translation_m\": [%.9f,%.9f,%.9f]%s}",
                    cameras_[v].x, cameras_[v].y, cameras_[v].z, sigma.c_str());
    };
    return R"("cameras": {"c": {"width_px": 90, "height_px": 90, "fx_px": 360, "fy_px": 360, "cx_px": 45, "cy_px": 45}},
 "files": {"a": {"path": "0.ply"}, "b": {"path": "1.ply"}},
 "images": [{"id": "i0", "camera": "c", "group": "left", )" +
           place(0) + "},\n  {\"id\": \"i1\", \"camera\": \"c\", \"group\": \"right\", " + place(1) + R"(}],
 "clouds": {"left": {"file": "a", "cameras": ["c"]}, "right": {"file": "b", "cameras": ["c"]}})";
  }
  void write(const char* name, const std::string& sections) {
    write_file(folder_ / name, "{\"gonio\": 1, " + sections + "}");
  }
  Ended registered(std::vector<std::string> words, const char* manifest = "scan.json") {
    words.insert(words.begin(), {"cloud-register", "-i", manifest});
    return run(words, folder_.path());
  }
  manifest::Document document_of(const Ended& ended) const {
    return manifest::parse_document(ended.out, "registered.json", folder_.path());
  }
  void expect_refused(const Ended& ended, int status, const char* words) {
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(words));
    EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
    EXPECT_EQ(ended.out, "");
  }

  ScratchFolder folder_;
  std::array<Vec3, 2> cameras_;
};

TEST_F(CloudRegister, ComparesAndMovesNothing) {
  const Ended made = registered({"--html", "page.html", "--limit", "100"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("the poses are at fault, not the points"));
  const manifest::Document d = document_of(made);
  ASSERT_EQ(d.registration.entry.size(), 1U);
  const manifest::Registration& r = d.registration.entry[0];
  EXPECT_EQ(r.verdict, "compared");
  EXPECT_GT(r.consistency, 2);
  EXPECT_NEAR(r.rest, 1, 0.06);
  EXPECT_TRUE(r.views.empty());
  ASSERT_EQ(r.pairs.size(), 1U);
  EXPECT_THAT(r.pairs[0].clouds, ElementsAre("left", "right"));
  EXPECT_EQ(d.clouds.at("right").file, "b");
  EXPECT_EQ(d.images[1].world_from_camera->translation_m,
            document_of(registered({"--limit", "99"})).images[1].world_from_camera->translation_m);
  const std::string page = read_file(folder_ / "page.html");
  for (const char* words : {"Distances over what is predicted", "Where they lie", "the poses are at fault"})
    EXPECT_THAT(page, HasSubstr(words));
  EXPECT_EQ(registered({}).status, 2);  // over the limit of 2
}

TEST_F(CloudRegister, RefinesPointsPosesAndCovariances) {
  const Ended made = registered({"--refine", "--motion-limit", "0.5mm", "--out", "refined", "--html", "page.html"});
  ASSERT_EQ(made.status, 0) << made.err;
  const manifest::Document d = document_of(made);
  const manifest::Registration& r = d.registration.entry.at(0);
  EXPECT_EQ(r.verdict, "refined");
  EXPECT_NEAR(r.consistency, 1, 0.06);
  EXPECT_GT(*r.consistency_before, 2);
  ASSERT_EQ(r.views.size(), 2U);
  EXPECT_FALSE(r.views[0].refined_from_stated);
  const auto& motion = *r.views[1].refined_from_stated;
  const auto left = mesh::ViewMotion{motion.rotation, motion.translation_m} * error;
  for (int k = 0; k < 3; ++k) EXPECT_LT(std::abs(left.translation_m[k]), 2e-4);
  // Points, camera and covariances moved along; what else the file says of a point stays.
  const auto moved = io::read_ply(manifest::resolve(d, d.clouds.at("right").file, ""), columns);
  const io::TriangleMesh before = cloud_of(bumps(), 1);
  ASSERT_EQ(moved.positions_m.size(), before.positions_m.size());
  EXPECT_LT(norm(moved.positions_m[7] - motion * before.positions_m[7]), 1e-12);
  EXPECT_EQ(moved.properties[1], before.properties[1]);
  const Mat3 turn = matrix_of(motion.rotation);
  std::array<double, 6> expected{};
  for (std::size_t k = 0; k < 6; ++k) expected[k] = before.properties[k + 2][7];
  expected = turned_covariance(turn, expected);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(moved.properties[k + 2][7], expected[k], 1e-14);
  EXPECT_LT(norm(d.images[1].world_from_camera->translation_m - motion * cameras_[1]), 1e-8);
  EXPECT_TRUE(d.images[1].world_from_camera->sigma);
  EXPECT_EQ(d.images[0].world_from_camera->translation_m.x, cameras_[0].x);
  EXPECT_THAT(read_file(folder_ / "page.html"), HasSubstr("Motions"));
  // Refined views agree, and become one mesh.
  write_file(folder_ / "refined.json", made.out);
  const Ended again = registered({}, "refined.json");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("as the points state"));
  const Ended mesh = run({"cloud-mesh", "--depth", "6", "--out", "mesh", "-i", "refined.json"}, folder_.path());
  EXPECT_EQ(mesh.status, 0) << mesh.err;
  EXPECT_EQ(registered({"--refine", "--motion-limit", "0.5mm", "--out", "refined", "--force"}).out, made.out);
}

TEST_F(CloudRegister, RefusesWhatSlidesUnlessToldToHold) {
  write_clouds(seen(flat(), {.side = 40, .f_px = 120}, 2));
  write("scan.json", clouds());
  const Ended refused = registered({"--refine", "--out", "refined"});
  EXPECT_EQ(refused.status, 2) << refused.err;
  EXPECT_THAT(refused.err,
              HasSubstr("view right: overlaps do not hold sliding in the plane across (0.00, 0.00, 1.00)"));
  EXPECT_THAT(refused.err, HasSubstr("turning about the axis (0.00, 0.00, 1.00)"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "refined/right.ply"));
  const manifest::Document d = document_of(refused);
  EXPECT_EQ(d.registration.entry.at(0).verdict, "refused");
  EXPECT_EQ(d.registration.entry.at(0).views.at(1).held, 3);
  EXPECT_EQ(d.clouds.at("right").file, "b");
  const Ended held = registered({"--refine", "--hold", "--out", "refined"});
  EXPECT_EQ(held.status, 0) << held.err;
  EXPECT_THAT(held.err, HasSubstr("is left as stated"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "refined/right.ply"));
  write("scan.json", clouds(", \"sigma\": {\"rotation_rad\": [0.001], \"translation_m\": [0.0002]}"));
  const Ended prior = registered({"--refine", "--out", "refined", "--force"});
  EXPECT_EQ(prior.status, 0) << prior.err;
  EXPECT_THAT(prior.err, HasSubstr("with its stated pose as prior"));
}

TEST_F(CloudRegister, ViewsThatDoNotMeetEndInOne) {
  mesh::MeasuredPoints apart = bumps();
  misplace(apart, 1, {{}, {1, 0, 0}});
  write_clouds(apart);
  write("scan.json", clouds());
  const Ended made = registered({});
  EXPECT_EQ(made.status, 1) << made.err;
  EXPECT_THAT(made.err, HasSubstr("no two views overlap"));
}

TEST_F(CloudRegister, CallsThatCannotBeMeantAreRefused) {
  expect_refused(registered({"--refine"}), 64, "--out");
  expect_refused(registered({"--hold"}), 64, "--refine");
  expect_refused(registered({"--refine", "--fixed", "top", "--out", "o"}), 64, "top is none of the clouds");
  expect_refused(registered({"--view", "top"}), 64, "top is none of the manifest's clouds");
  expect_refused(registered({"--view", "left"}), 65, "have one view alone");
  expect_refused(registered({"--motion-limit", "1"}), 64, "--motion-limit");
  expect_refused(registered({"--reach", "0mm"}), 64, "--reach");
  expect_refused(registered({"--viewpoint", "left=0,0"}), 64, "is no viewpoint");
  expect_refused(run({"cloud-register"}, folder_.path()), 64, "manifest");
  write("bad.json", "\"clouds\": {}");
  expect_refused(registered({}, "bad.json"), 66, "has none");
  std::string lost = clouds();
  write("bad.json", lost.replace(lost.find("\"group\": \"left\""), 15, "\"group\": \"else\""));
  expect_refused(registered({}, "bad.json"), 65, "neither an image nor a rig says where that stood");
  write_file(folder_ / "1.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\n");
  expect_refused(registered({}), 65, "1.ply");
}

}  // namespace
}  // namespace gonio::tests
