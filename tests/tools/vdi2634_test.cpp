// vdi2634 as people run it (GONIO_BIN): points-only PLY in millimetres, two spheres in one cloud, limits, refusals.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "base/random.h"
#include "data.h"
#include "geom/vector.h"
#include "manifest/value.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

class Vdi2634 : public testing::Test {
 protected:
  // A hemisphere of 12.5 mm towards the scanner, with 10 um of noise; appended to `points`, millimetres.
  void add_sphere(std::vector<Vec3>& points, Vec3 centre_mm) {
    for (int i = 0; i < 2000; ++i) {
      const double z = random_.uniform(0, 1), phi = random_.uniform(0, 2 * pi), r = std::sqrt(1 - z * z);
      points.push_back(centre_mm + Vec3{r * std::cos(phi), r * std::sin(phi), -z} * (12.5 + 0.01 * random_.normal()));
    }
  }
  void write(const char* name, const std::vector<Vec3>& points) const {
    std::ofstream file(folder_ / name);
    file.precision(9);
    file << "ply\nformat ascii 1.0\nelement vertex " << points.size()
         << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nend_header\n";
    for (const Vec3& p : points) file << p.x << " " << p.y << " " << p.z << " 200\n";
  }
  void SetUp() override {
    std::vector<Vec3> one, bar, plane;
    add_sphere(one, {5, -3, 400});
    add_sphere(bar, {-50, 0, 420});
    add_sphere(bar, {50, 0, 420});
    for (int i = 0; i < 3000; ++i)
      plane.push_back({random_.uniform(-40, 40), random_.uniform(-30, 30), 500 + 0.02 * random_.normal()});
    write("one.ply", one);
    write("bar.ply", bar);
    write("plane.ply", plane);
  }
  Ended vdi2634(std::vector<std::string> words) const {
    words.insert(words.begin(), {"vdi2634", "--unit", "mm"});
    return run(words, folder_.path());
  }
  static manifest::Value figure(const Ended& ended, const std::string& quantity) {
    const manifest::Value document = manifest::parse_json(ended.out, "out");
    for (const manifest::Value& r : document.find("acceptance")->as_array())
      if (r.find("quantity")->as_string() == quantity) return r;
    return {};
  }
  Random random_{3};
  ScratchFolder folder_;
};

TEST_F(Vdi2634, SphereWithCalibratedRadius) {
  const Ended ended = vdi2634({"--radius", "12.5mm", "one.ply"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_NEAR(figure(ended, "probing-form").find("value")->as_number(), 60e-6, 8e-6);
  EXPECT_NEAR(figure(ended, "probing-form").find("sigma")->as_number(), 10e-6, 1e-6);
  const manifest::Value size = figure(ended, "probing-size");
  const double sigma = size.find("uncertainty")->as_number();
  EXPECT_LT(std::abs(size.find("value")->as_number()), 4 * sigma);
  EXPECT_LT(sigma, 3e-6);
  EXPECT_EQ(size.find("file")->as_string(), "one");
}

TEST_F(Vdi2634, TwoSpheresOfABar) {
  const Ended ended = vdi2634({"--distance", "100mm", "--region", "-50mm,0mm,415mm,30mm", "--region",
                               "50mm,0mm,415mm,30mm", "--limit", "sphere-distance=20um", "bar.ply"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_LT(std::abs(figure(ended, "sphere-distance").find("value")->as_number()), 5e-6);
}

TEST_F(Vdi2634, CloudsInPairs) {
  std::vector<Vec3> left, right;
  add_sphere(left, {-50, 0, 420});
  add_sphere(right, {50.1, 0, 420});
  write("left.ply", left);
  write("right.ply", right);
  const Ended ended = vdi2634({"--distance", "100mm", "--limit", "sphere-distance=50um", "left.ply", "right.ply"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, HasSubstr("sphere-distance is 0.1"));
  EXPECT_NEAR(figure(ended, "sphere-distance").find("value")->as_number(), 100e-6, 5e-6);
  EXPECT_DOUBLE_EQ(figure(ended, "sphere-distance").find("limit")->as_number(), 50e-6);
}

TEST_F(Vdi2634, PlaneAndItsLimit) {
  EXPECT_EQ(vdi2634({"--shape", "plane", "--limit", "flatness=0.2mm", "plane.ply"}).status, 0);
  const Ended ended = vdi2634({"--shape", "plane", "--limit", "flatness=50um", "plane.ply"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_NEAR(figure(ended, "flatness").find("value")->as_number(), 120e-6, 15e-6);
}

TEST_F(Vdi2634, SaysWhatIsWrong) {
  const Ended metres = run({"vdi2634", "--radius", "12.5mm", "one.ply"}, folder_.path());
  EXPECT_EQ(metres.status, 65);
  EXPECT_THAT(metres.err, HasSubstr("--unit mm"));
  const Ended both = vdi2634({"bar.ply"});  // two spheres as one
  EXPECT_TRUE(both.status == 65 || both.err.find("--region") != std::string::npos) << both.err;
  EXPECT_EQ(vdi2634({}).status, 64);
  EXPECT_EQ(vdi2634({"--distance", "1m", "one.ply"}).status, 64);
  EXPECT_EQ(vdi2634({"--region", "1mm,2mm,3mm", "one.ply"}).status, 64);
  EXPECT_EQ(vdi2634({"--limit", "roundness=1mm", "one.ply"}).status, 64);
  EXPECT_EQ(vdi2634({"--limit", "flatness=1mm", "one.ply"}).status, 64);
  EXPECT_EQ(vdi2634({"--hold-radius", "one.ply"}).status, 64);
  EXPECT_EQ(vdi2634({"absent.ply"}).status, 66);
  EXPECT_EQ(vdi2634({"--region", "900mm,0mm,0mm,1mm", "one.ply"}).status, 65);
}

}  // namespace
}  // namespace gonio::tests
