// The parts of contrast measure against what is known of them: codes, poses, classes, defects, shifts. Seeds are fixed;
// false-alarm rates of the statistical tests stand beside them.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "contrast/measure/cell_classes.h"
#include "contrast/measure/defects.h"
#include "contrast/measure/matrix_code.h"
#include "contrast/measure/measure_views.h"
#include "contrast/measure/sample_pose.h"
#include "contrast/measure/view_shift.h"
#include "stats/distributions.h"

namespace gonio::contrast {
namespace {

TEST(MatrixCode, TextComesBackFromEverySize) {
  for (const auto& [rows, columns] :
       std::vector<std::pair<int, int>>{{10, 10}, {12, 12}, {32, 32}, {8, 18}, {12, 36}}) {
    const MatrixCode code = write_matrix("DTU", rows, columns, "text");
    EXPECT_EQ(code.modules.rows, rows);
    EXPECT_EQ(finder_share(code.modules), 1);
    const auto read = read_matrix(code.modules);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->text, "DTU");
    EXPECT_EQ(read->modules.bits, code.modules.bits);
  }
}

TEST(MatrixCode, ErrorsAreCorrectedAndShown) {
  const MatrixCode code = write_matrix("DTU", 14, 14, "text");  // corrects 5 codewords
  Bits spoilt = code.modules;
  for (const int at : {14 * 3 + 4, 14 * 6 + 7, 14 * 9 + 9}) spoilt.bits[static_cast<std::size_t>(at)] ^= 1;
  const auto read = read_matrix(spoilt);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->text, "DTU");
  EXPECT_EQ(read->modules.bits, code.modules.bits);
  for (std::size_t k = 0; k < spoilt.bits.size(); k += 3) spoilt.bits[k] ^= 1;
  EXPECT_FALSE(read_matrix(spoilt));
  EXPECT_THROW(write_matrix("much too long for so small a code", 10, 10, "text"), Error);
  EXPECT_THROW(write_matrix("DTU", 11, 11, "text"), Error);
}

TEST(Pattern, FourQuarterTurnsLeaveItAsItWas) {
  const Bits bits{2, 3, {1, 0, 0, 1, 1, 0}};
  EXPECT_EQ(turned(bits, 4).bits, bits.bits);
  EXPECT_EQ(turned(bits, 1).bits,
            (std::vector<std::uint8_t>{1, 1, 1, 0, 0, 0}));  // the left column has come to the top
  EXPECT_EQ(turned(turned(bits, 1), -1).bits, bits.bits);
}

CellPattern checker(int side) {
  CellPattern pattern{side, side, {0.001, 0.001}, {}};
  for (int i = 0; i < side * side; ++i) pattern.bits.push_back(static_cast<std::uint8_t>((i / side + i % side) % 2));
  return pattern;
}

// Mahalanobis distances squared of 60 fits are chi^2 of 6 degrees each: their sum within the central 99.8 %.
TEST(SamplePose, CovarianceIsHonest) {
  const CellPattern pattern = checker(12);
  const Rigid<frame::World, frame::Object> truth{quaternion_of_rotation_vector({pi - 0.05, 0.03, 0.1}),
                                                 {0.01, 0.02, 0.003}};
  Random random(4);
  double sum = 0;
  const int runs = 60;
  for (int run = 0; run < runs; ++run) {
    std::vector<camera::CameraModel> cameras;
    std::vector<CameraPose> poses;
    std::vector<PlacedMark> marks;
    for (int i = 0; i < 4; ++i) {
      camera::Intrinsics lens;
      lens.fx_px = lens.fy_px = 2400;
      lens.cx_px = lens.cy_px = 100;
      cameras.emplace_back(lens, 201, 201);
      const Rigid<frame::Camera, frame::World> real{quaternion_of_rotation_vector({pi, 0.3 * i - 0.45, 0.2 * i}),
                                                    {-0.01, 0.02, 0.3}};
      CameraPose pose{real, 2e-4, 1e-4};
      const auto error = [&](double s) { return Vec3{s * random.normal(), s * random.normal(), s * random.normal()}; };
      const Quaternion turn = quaternion_of_rotation_vector(error(pose.sigma_rad));
      pose.camera_from_world = {normalized(turn * real.rotation),
                                matrix_of(turn) * real.translation_m + error(pose.sigma_m)};
      for (int k = 0; k < 4; ++k) {
        const Vec2 c = pattern.corner_m(k);
        const auto pixel = cameras.back().project(real * (truth * Vec3{c.x, c.y, 0}));
        ASSERT_TRUE(pixel);
        marks.push_back({static_cast<std::size_t>(i),
                         k,
                         {pixel->x + 0.3 * random.normal(), pixel->y + 0.3 * random.normal()},
                         0.3});
      }
      poses.push_back(pose);
    }
    const SamplePose found = locate_sample(pattern, cameras, poses, marks, "test");
    const Vec3 middle{0.006, 0.006, 0};
    const Vec3 turn = rotation_vector_of(found.world_from_pattern.rotation * conjugate(truth.rotation));
    const Vec3 shift = found.world_from_pattern * middle - truth * middle;
    Eigen::Matrix<double, 6, 1> e;
    e << turn.x, turn.y, turn.z, shift.x, shift.y, shift.z;
    const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> covariance(found.covariance.data());
    const double widening =
        std::max(1.0, found.chi2 / found.degrees);  // undone: it makes intervals wider, never narrower
    sum += e.dot((covariance / widening).ldlt().solve(e));
  }
  EXPECT_GT(sum, stats::chi2_quantile(0.001, 6 * runs));
  EXPECT_LT(sum, stats::chi2_quantile(0.999, 6 * runs));
}

// 200 views of uneven light and three bad cells: the mean's 95 % interval covers in 95 % +- 5 % (3 sigmas of 200
// are 4.6).
TEST(CellClasses, UnevenLightAndBadCellsDoNotBendTheMean) {
  const CellPattern pattern = checker(12);
  std::vector<std::size_t> members;
  for (std::size_t cell = 0; cell < pattern.cells(); ++cell)
    if (pattern.bits[cell]) members.push_back(cell);
  Random random(9);
  int covered = 0;
  for (int run = 0; run < 200; ++run) {
    std::vector<double> value(pattern.cells()), sigma(pattern.cells(), 0.01);
    double truth = 0;
    for (std::size_t cell = 0; cell < pattern.cells(); ++cell) {
      const Vec2 p = pattern.place(cell);
      const double light = 1 + 0.4 * p.x - 0.2 * p.y + 0.1 * p.x * p.x;
      truth += light / static_cast<double>(pattern.cells());
      value[cell] = light + 0.02 * random.normal();
    }
    for (int k = 0; k < 3; ++k) value[members[random.below(static_cast<std::uint32_t>(members.size()))]] = 3;
    const ClassFit fit = fit_class(pattern, members, value, sigma);
    covered += std::abs(fit.mean - truth) < stats::student_quantile(0.975, fit.degrees) * fit.sigma;
  }
  EXPECT_GE(covered, 180);
}

// Brightnesses of cells that scatter by 2 % about uneven light, half of it alike in all views (correlation 0.5).
std::vector<CellMeans> null_views(const CellPattern& pattern, int views, Random& random) {
  std::vector<CellMeans> all(static_cast<std::size_t>(views));
  std::vector<double> common(pattern.cells());
  for (double& c : common) c = random.normal();
  for (CellMeans& means : all)
    for (std::size_t cell = 0; cell < pattern.cells(); ++cell) {
      const Vec2 p = pattern.place(cell);
      const double of_class = (pattern.bits[cell] ? 1.0 : 0.3) * (1 + 0.2 * p.x - 0.1 * p.x * p.y);
      means.mean.push_back(of_class * (1 + 0.02 * std::sqrt(0.5) * (common[cell] + random.normal())));
      means.sigma.push_back(1e-4);
    }
  return all;
}

Defects defects_of(const CellPattern& pattern, const std::vector<CellMeans>& views, double alarm_rate,
                   std::uint64_t seed) {
  const Members members = members_of(pattern);
  std::vector<std::vector<double>> z;
  for (const CellMeans& means : views) z.push_back(deviations(pattern, fit_view(pattern, members, means), means));
  return find_defects(pattern, z, alarm_rate, seed);
}

// From brightnesses on, by the same robust fits as in a session: 48 samples without defects at a stated rate of 10 %;
// 11 alarms or more come in 0.9 % of such tests.
TEST(Defects, FalseAlarmsKeepTheirRate) {
  const CellPattern pattern = checker(8);
  Random random(12);
  int alarms = 0;
  for (std::uint64_t run = 0; run < 48; ++run)
    alarms += !defects_of(pattern, null_views(pattern, 5, random), 0.1, run).found.empty();
  EXPECT_LT(alarms, 11);
}

TEST(Defects, ACellThatIsUnlikeOverTheViewsIsFound) {
  const CellPattern pattern = checker(10);
  Random random(13);
  auto views = null_views(pattern, 8, random);
  for (std::size_t v = 0; v < views.size(); ++v)
    views[v].mean[37] *= v % 2 == 0 ? 1.07 : 0.93;  // 3.5 scatters: in no single view striking
  const Defects defects = defects_of(pattern, views, 0.05, 1);
  ASSERT_EQ(defects.found.size(), 1u);
  EXPECT_EQ(defects.found[0].cell, 37u);
}

TEST(ViewShift, ShiftsWithinThePriorAreFound) {
  const CellPattern pattern = checker(8);
  GreyView view{100, 100, std::vector<float>(10000), {}, std::vector<std::uint8_t>(10000), {}};
  Random random(3);
  const Vec2 at{10.7, 9.4};  // the true corner; the map believes (10, 10)
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) {
      double v = 0;  // box-filtered checker of 10 px
      for (int sy = 0; sy < 16; ++sy)
        for (int sx = 0; sx < 16; ++sx) {
          const double u = (x - 0.5 + (sx + 0.5) / 16 - at.x) / 10, w = (y - 0.5 + (sy + 0.5) / 16 - at.y) / 10;
          const bool inside = u >= 0 && w >= 0 && u < 8 && w < 8;
          v += (inside ? ((static_cast<int>(u) + static_cast<int>(w)) % 2 ? 1.0 : 0.2) : 0.5) / 256;
        }
      view.value[static_cast<std::size_t>(100 * y + x)] = static_cast<float>(v + 0.01 * random.normal());
    }
  const ViewMap map(
      homography({{{0, 0}, {0.008, 0}, {0.008, 0.008}, {0, 0.008}}}, {{{10, 10}, {90, 10}, {90, 90}, {10, 90}}}));
  std::vector<double> expected;
  for (const std::uint8_t bit : pattern.bits) expected.push_back(bit ? 1.0 : 0.2);
  CornerCovariance prior{};
  for (std::size_t i = 0; i < 8; ++i) prior[9 * i] = 1;
  const ViewShift shift = lay_onto(view, pattern, map, expected, prior, 1.0);
  ASSERT_TRUE(shift.credible);
  const double sigma = largest_sigma_px(shift.covariance);
  for (const Vec2 by : shift.by_px) {
    EXPECT_NEAR(by.x, 0.7, 3 * sigma);
    EXPECT_NEAR(by.y, -0.6, 3 * sigma);
  }
  EXPECT_LT(sigma, 0.1);
}

}  // namespace
}  // namespace gonio::contrast
