// The mathematics of the refinement: splines, refraction against closed forms, slopes against differences, draws.
#include <gtest/gtest.h>

#include <cmath>

#include "glass/refine/hull.h"
#include "glass/refine/measurements.h"
#include "glass/refine/normal_equations.h"
#include "optics/fresnel_amplitudes.h"

namespace gonio::glass {
namespace {

constexpr double cell_m = 0.002;

// A ball as a function that splines reproduce: (R^2 - r^2) / 2R, about the distance near the surface. Splines of
// values at the nodes add a sixth of the Laplacian, -3/R: the zero lies at r^2 = R^2 - 1 instead.
SplineField ball(double radius_cells) {
  SplineField field({0, 0, 0}, cell_m, {26, 26, 26});
  const Vec3 middle = field.metres({12.3, 12.6, 12.4});
  field.fill([&](Vec3 p) {
    const double r = norm(p - middle) / cell_m;
    return (radius_cells * radius_cells - r * r) / (2 * radius_cells);
  });
  return field;
}
constexpr Vec3 ball_middle{12.3, 12.6, 12.4};

TEST(SplineField, JetIsTheFunctionsOwn) {
  const SplineField field = ball(8);
  const Vec3 at{7.3, 14.9, 11.2};
  const SplineField::Jet jet = field.jet(at);
  EXPECT_NEAR(jet.value, field.value(at), 1e-13);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = Vec3{axis == 0 ? 1e-5 : 0, axis == 1 ? 1e-5 : 0, axis == 2 ? 1e-5 : 0};
    EXPECT_NEAR(jet.slope[axis], (field.value(at + step) - field.value(at - step)) / 2e-5, 1e-8);
    EXPECT_NEAR(jet.slope[axis], -(at - ball_middle)[axis] / 8, 1e-12);
    EXPECT_NEAR(jet.curve(axis, axis), -1.0 / 8, 1e-12);
  }
}

// <scatter(a), c> = <a, gather(c)>.
TEST(SplineField, ScatterIsTheTransposeOfGather) {
  SplineField field = ball(8);
  Random random(3);
  for (double& c : field.coefficients) c = random.normal();
  const SplineField::Support at = field.support({9.1, 6.7, 17.9});
  const std::array<double, 4> amounts{0.3, -1.2, 0.7, 2};
  std::vector<double> to(field.size());
  field.scatter(at, amounts, to);
  double one = 0, other = 0;
  for (std::size_t i = 0; i < to.size(); ++i) one += to[i] * field.coefficients[i];
  const auto local = field.gather(at, field.coefficients);
  for (std::size_t l = 0; l < 4; ++l) other += amounts[l] * local[l];
  EXPECT_NEAR(one, other, 1e-12);
}

TEST(Passage, MeetsABallWhereItIs) {
  const SplineField field = ball(8);
  const double radius = std::sqrt(63.0), off = 5;
  const Vec3 origin = ball_middle + Vec3{-40, off, 0};
  const Passage line = passage(field, origin, {1, 0, 0});
  ASSERT_EQ(line.crossings.size(), 2u);
  const double half = std::sqrt(radius * radius - off * off);
  EXPECT_NEAR(line.crossings[0].t, 40 - half, 1e-9);
  EXPECT_NEAR(line.crossings[1].t, 40 + half, 1e-9);
  EXPECT_TRUE(line.crossings[0].enters);
  EXPECT_NEAR(line.at, 40, 1e-8);
  EXPECT_NEAR(line.greatest, (63 - off * off) / 16, 1e-12);
  EXPECT_TRUE(passage(field, ball_middle + Vec3{-40, 9, 0}, {1, 0, 0}).crossings.empty());
}

// A screen of 3 m at 1 m behind, in metres as in cells: a ramp along x, polarized along `angle`.
struct Display {
  std::unique_ptr<light::Emitter> emitter;
  std::shared_ptr<const ScreenPicture> picture;
  explicit Display(double angle_rad, double y_m = 1, bool ramp = true) {
    auto shown = std::make_shared<io::Image>(100, 100, std::vector<std::string>{"Y"});
    std::vector<double> luminance;
    for (std::size_t i = 0; i < shown->pixels(); ++i) {
      shown->data[i] = ramp ? static_cast<float>(0.2 + 0.006 * static_cast<double>(i % 100)) : 1.0f;
      luminance.push_back(shown->data[i]);
    }
    const light::Panel panel{{0, y_m, 0}, Basis({0, -1, 0}, {1, 0, 0}), 3, 3};
    picture = std::make_shared<ScreenPicture>(panel, luminance, 100, 100, 1);
    manifest::Parameters p{{"position_m", std::vector<double>{0, y_m, 0}},
                           {"direction", std::vector<double>{0, -1, 0}},
                           {"up", std::vector<double>{0, 0, 1}},
                           {"width_m", 3.0},
                           {"height_m", 3.0},
                           {"polarization_rad", angle_rad}};
    emitter = light::find("screen")->prepare(p, {shown, {}}, "test");
  }
};

SurfacePatch plane(Vec3 at, Vec3 outward) {
  return {at, {0, -outward, Mat3{{0, 0, 0, 0, 0, 0, 0, 0, 0}}}};
}

// A plate shifts a ray by t sin(i) (1 - cos(i) / (n cos(t))) and keeps its direction; what passes is Fresnel's, twice.
TEST(TwoRefractions, ThroughAPlate) {
  const double index = 1.5, thickness = 0.01, tilt = 0.6;
  const Display display(0, 1, false);
  const Vec3 outward{-std::sin(tilt), -std::cos(tilt), 0};  // the plate is turned about z, the p plane is x y
  const PixelRay ray{{0, -1, 0}, {0, 1, 0}, {1, 0, 0}};
  const SeenThrough seen = seen_through(ray, plane({0, 0, 0}, outward), plane(-outward * thickness, -outward),
                                        {index, 3}, *display.picture, *display.emitter, 1);
  ASSERT_TRUE(seen.valid);
  const double sine = std::sin(tilt), c = std::cos(tilt), beyond = std::sqrt(1 - sine * sine / (index * index));
  const double shift = thickness * sine * (1 - c / (index * beyond));
  EXPECT_NEAR(std::abs(seen.place_px.x - 50), shift / 3 * 100, 1e-9);
  EXPECT_NEAR(seen.place_px.y, 50, 1e-9);
  // Light along x lies in the plane of incidence.
  const auto in = optics::transmitted_amplitudes(c, index), out = optics::transmitted_amplitudes(beyond, 1 / index);
  const double passes = std::norm(in.p * out.p) * std::exp(-3 * thickness / beyond);
  EXPECT_NEAR(seen.stokes[0], passes, 1e-6);
  EXPECT_NEAR(seen.stokes[1], passes, 1e-6);
  EXPECT_NEAR(seen.stokes[2], 0, 1e-9);
  const Display upright(pi / 2, 1, false);
  const SeenThrough across = seen_through(ray, plane({0, 0, 0}, outward), plane(-outward * thickness, -outward),
                                          {index, 3}, *upright.picture, *upright.emitter, 1);
  const double passes_s = std::norm(in.s * out.s) * std::exp(-3 * thickness / beyond);
  EXPECT_NEAR(across.stokes[0], passes_s, 1e-6);
  EXPECT_NEAR(across.stokes[1], -passes_s, 1e-6);
}

// A ball turns a ray by 2 (i - t).
TEST(TwoRefractions, ThroughABall) {
  const SplineField field = ball(8);
  const Measuring measuring({}, {});
  const double radius = std::sqrt(63.0), index = 1.5;
  for (const double off : {1.0, 3.0, 5.5}) {
    const PixelRay ray{ball_middle + Vec3{off, -40, 0}, {0, 1, 0}, {1, 0, 0}};
    Measuring::Path path;
    ASSERT_TRUE(measuring.refracted(field, ray, index, path)) << off;
    const double i = std::asin(off / radius), t = std::asin(off / radius / index);
    EXPECT_NEAR(std::atan2(-path.beyond.x, path.beyond.y), 2 * (i - t), 1e-7) << off;
  }
}

// One view of the ball with everything that can be measured.
class OneView : public testing::Test {
 protected:
  OneView() : field_(ball(8)), display_(pi / 4) {
    constexpr int n = 24;
    View view{.id = "view", .width = n, .height = n, .camera = camera::CameraModel({150, 150, 11.5, 11.5, {}}, n, n)};
    view.world_from_camera_axes = Mat3{{1, 0, 0, 0, 0, 1, 0, -1, 0}};
    view.world_from_camera.rotation = quaternion_of(view.world_from_camera_axes);
    view.world_from_camera.translation_m = field_.metres(ball_middle) + Vec3{0, -0.25, 0};
    view.focal_px = 150;
    view.outline_px.resize(n * n);
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        view.outline_px[view.pixel(x, y)] = static_cast<float>(8.7 - std::hypot(x - 11.8, y - 11.1));
    for (auto& plane : view.stokes) plane.assign(n * n, 0.1f);
    view.screen = display_.picture;
    view.emitter = std::shared_ptr<const light::Emitter>(display_.emitter.get(), [](const light::Emitter*) {});
    NetworkAnswer answer;
    answer.front.assign(n * n, normalized(Vec3{0.2, -1, -0.1}));
    answer.back.assign(n * n, normalized(Vec3{0.2, 1, -0.3}));
    answer.front_sigma_rad.assign(n * n, 0.3f), answer.back_sigma_rad.assign(n * n, 0.4f);
    view.network = std::move(answer);
    views_.push_back(std::move(view));
  }
  SplineField field_;
  Display display_;
  std::vector<View> views_;
};

// The slope of every kind of cost by every coefficient, through the whole chain of marching and refraction, against
// central differences: 2 sum r dr/dc.
TEST_F(OneView, SlopesAreThoseOfTheCost) {
  const Measuring measuring(views_, {});
  std::vector<Measurement> some;
  for (const Kind kind : {Kind::light, Kind::front, Kind::back}) {
    some.push_back({kind, 0, 9, 13, {}});
    some.push_back({kind, 0, 14, 8, {}});
  }
  for (const Measurement& m : measuring.outlines(0))
    if (m.x == 4 || m.y == 19) some.push_back(m);
  const auto floor = measuring.floor(field_, field_.metres({0, 0, 6}).z);
  some.push_back(floor[floor.size() / 2]);
  const Glassy glass{1.52, 0.01};
  int sloping = 0;
  for (const Measurement& m : some) {
    Rows rows;
    double variance = -1;
    measuring.cost({field_, glass, 4}, m, variance, &rows);
    for (std::size_t i = 0; i < field_.size(); i += 7) {
      std::vector<double> unit(field_.size());
      unit[i] = 1;
      double slope = 0;
      for (std::size_t k = 0; k < rows.count; ++k)
        for (std::size_t p = 0; p < rows.places; ++p) {
          const auto local = field_.gather(rows.at[p], unit);
          for (std::size_t l = 0; l < 4; ++l) slope += 2 * rows.residual[k] * rows.slopes[k][4 * p + l] * local[l];
        }
      if (slope == 0) continue;
      SplineField more = field_, less = field_;
      more.coefficients[i] += 1e-5, less.coefficients[i] -= 1e-5;
      const double differs = (measuring.cost({more, glass, 4}, m, variance, nullptr) -
                              measuring.cost({less, glass, 4}, m, variance, nullptr)) /
                             2e-5;
      EXPECT_NEAR(slope, differs, 1e-3 * std::abs(differs) + 2e-5) << static_cast<int>(m.kind) << ' ' << i;
      ++sloping;
    }
  }
  EXPECT_GT(sloping, 100);
}

TEST_F(OneView, SlopesByIndexAndAbsorption) {
  const Measuring measuring(views_, {});
  const Measurement m{Kind::light, 0, 9, 13, {}};
  Rows rows;
  double variance = -1;
  measuring.cost({field_, {1.52, 0.01}, 4}, m, variance, &rows);
  for (std::size_t g = 0; g < 2; ++g) {
    double slope = 0;
    for (std::size_t k = 0; k < 3; ++k) slope += 2 * rows.residual[k] * rows.slopes[k][8 + g];
    const auto at = [&](double step) {
      return measuring.cost({field_, {1.52 + (g == 0 ? step : 0), 0.01 + (g == 1 ? step : 0)}, 4}, m, variance,
                            nullptr);
    };
    EXPECT_NEAR(slope, (at(1e-5) - at(-1e-5)) / 2e-5, 1e-3 * std::abs(slope) + 1e-6) << g;
  }
}

// One row and the anchor alone: the value's posterior variance is known. 300 draws: 8 % of a variance, the band is 3.6
// of that wide on either side (false alarm 3e-4).
TEST(NormalEquations, DrawsScatterAsThePosteriorDoes) {
  SplineField field({0, 0, 0}, 1, {7, 7, 7});
  SmoothPrior prior;
  prior.bend_sigma = 1e9, prior.anchor_sigma = 0.5;
  NormalEquations equations(field, prior, field.coefficients);
  Rows row;
  row.count = 1, row.places = 1;
  row.at[0] = field.support({3.3, 2.9, 3.6});
  row.slopes[0][0] = 2;
  std::vector<double> state = field.coefficients;
  state.resize(state.size() + globals);
  equations.linearise(state, {row});
  std::vector<double> squares(field.size());
  field.scatter_squares(row.at[0], {1, 0, 0, 0}, squares);
  double weights = 0;
  for (const double s : squares) weights += s;
  const double expected = 1 / (1 / (0.25 * weights) + 4);
  Random random(11);
  double sum = 0;
  constexpr int draws = 300;
  for (int k = 0; k < draws; ++k) {
    const double value = field.gather(row.at[0], equations.draw(random))[0];
    sum += value * value;
  }
  EXPECT_NEAR(sum / draws / expected, 1, 0.3);
}

// Round a disc of radius 8.3 px drawn with soft edges, distances are those from its circle; a pixel from the edge the
// places where rows and columns pass it, about 0.7 px apart, stand for it to 0.1 px.
TEST(DistanceFromEdge, IsASoftMasksToAFractionOfAPixel) {
  std::vector<float> mask;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x)
      mask.push_back(static_cast<float>(std::clamp(8.8 - std::hypot(x - 11.2, y - 11.7), 0.0, 1.0)));
  const std::vector<float> distance = distance_from_edge(mask, 24, 24);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      const double true_distance = 8.3 - std::hypot(x - 11.2, y - 11.7);
      if (std::abs(true_distance) > 1) {
        EXPECT_NEAR(distance[y * 24 + x], true_distance, 0.15) << x << ' ' << y;
      }
    }
}

}  // namespace
}  // namespace gonio::glass
