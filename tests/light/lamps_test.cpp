// Lamps that face somewhere, against closed forms: irradiance by their own samples (midpoint grid, error below 3e-4 of
// the on-axis value) and intensity as a function of direction.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>

#include "cases.h"
#include "light/irradiance.h"

namespace gonio::tests {
namespace {

using light::Emitter;

manifest::Parameter vector_of(Vec3 v) {
  return std::vector<double>{v.x, v.y, v.z};
}
std::unique_ptr<Emitter> lamp(const std::string& model, manifest::Parameters parameters, Vec3 position_m = {},
                              Vec3 direction = {0, 0, -1}, const light::Attachment& file = {}) {
  parameters["position_m"] = vector_of(position_m);
  parameters["direction"] = vector_of(direction);
  return light::find(model)->prepare(parameters, file, "p");
}
Vec3 tilted(double degrees) {
  return {std::sin(degrees * pi / 180), 0, std::cos(degrees * pi / 180)};
}
// Intensity of a small lamp at the origin towards a unit direction.
double intensity(const Emitter& emitter, Vec3 towards) {
  const auto s = emitter.sample(towards * 2, {0.5, 0.5});
  return s.valid ? s.weight.x * 4 : 0;
}

TEST(Disc, IrradianceOnAndOffTheAxis) {
  constexpr double radius = 0.3, radiance = 1 / (pi * radius * radius);
  const auto disc = lamp("disc", {{"watt_per_sr", 1.0}, {"radius_m", radius}}, {0, 0, 0.4});
  EXPECT_NEAR(irradiance_by_sampling(*disc, {}, {0, 0, 1}).x, pi * radiance * 0.36, 1e-4);  // sin(s) = 3/5
  for (const double offset : {0.0, 0.2, 0.3, 0.7, 2.0})
    EXPECT_NEAR(irradiance_by_sampling(*disc, {offset, 0, 0}, {0, 0, 1}).x,
                light::disc_irradiance({radiance, 0, 0}, radius, 0.4, offset).x, 5e-4)
        << offset;
  EXPECT_FALSE(disc->sample({0, 0, 0.5}, {0.3, 0.3}).valid);
  EXPECT_EQ(disc->hit({0, 0, 1}, {0, 0, -1}).radiance, Rgb{});
  EXPECT_NEAR(disc->hit({0.29, 0, 0}, {0, 0, 1}).radiance.x, radiance, 1e-12);
  EXPECT_EQ(disc->hit({0.31, 0, 0}, {0, 0, 1}).radiance, Rgb{});
}

TEST(Rectangle, LambertsPolygonFormulaAboveAcrossAndBelowTheHorizon) {
  const manifest::Parameters size = {
      {"watt_per_sr", 2.0}, {"width_m", 0.8}, {"height_m", 0.5}, {"up", vector_of({0, 1, 0})}};
  const Vec3 centre{0.1, 0.05, 0.3};
  const auto panel = lamp("rectangle", size, centre);
  std::array<Vec3, 4> corners;
  for (int i = 0; i < 4; ++i) corners[i] = centre + Vec3{i == 1 || i == 2 ? 0.4 : -0.4, i > 1 ? 0.25 : -0.25, 0};
  for (const double tilt : {0.0, 40.0, 80.0, 100.0, 150.0})
    for (const Vec3 point : {Vec3{0, 0, 0}, Vec3{0.4, -0.3, 0.1}, Vec3{-2, 1, -1}, Vec3{3, 0, 0.25}}) {
      const double closed = light::polygon_irradiance({2 / 0.4, 0, 0}, corners, point, tilted(tilt)).x;
      EXPECT_NEAR(irradiance_by_sampling(*panel, point, tilted(tilt)).x, closed, 1e-3 * closed + 2e-3) << tilt;
    }
  EXPECT_FALSE(panel->sample({0, 0, 1}, {0.5, 0.5}).valid);
}

TEST(Rectangle, UpDecidesWhereItsWidthLies) {
  const manifest::Parameters size = {
      {"watt_per_sr", 1.0}, {"width_m", 2.0}, {"height_m", 0.2}, {"up", vector_of({1, 0, 0})}};
  const auto upright = lamp("rectangle", size, {0, 0, 1});
  EXPECT_GT(upright->hit({0, 0.9, 0}, {0, 0, 1}).radiance.x, 0);
  EXPECT_EQ(upright->hit({0.9, 0, 0}, {0, 0, 1}).radiance.x, 0);
  EXPECT_THROW(
      lamp("rectangle", {{"watt_per_sr", 1.0}, {"width_m", 2.0}, {"height_m", 0.2}, {"up", vector_of({0, 0, 3})}}),
      std::runtime_error);
}

TEST(Led, InverseSquareAndLobe) {
  for (const double exponent : {0.0, 1.0, 3.5, 80.0}) {
    const auto led = lamp("led", {{"watt_per_sr", 3.0}, {"exponent", exponent}}, {0, 0, 0.5});
    const auto small = lamp("led", {{"watt_per_sr", 3.0}, {"exponent", exponent}, {"radius_m", 1e-4}}, {0, 0, 0.5});
    for (const double x : {0.0, 0.1, 0.6}) {
      const double closed =
          light::lobe_irradiance({3, 0, 0}, exponent, {0, 0, 0.5}, {0, 0, -1}, {x, 0, 0}, {0, 0, 1}).x;
      const double square = x * x + 0.25, cosine = 0.5 / std::sqrt(square);
      EXPECT_NEAR(closed, 3 * std::pow(cosine, exponent + 1) / square, 1e-12);
      EXPECT_NEAR(irradiance_by_sampling(*led, {x, 0, 0}, {0, 0, 1}, 2).x, closed, 1e-12 + 1e-12 * closed);
      EXPECT_NEAR(irradiance_by_sampling(*small, {x, 0, 0}, {0, 0, 1}, 20).x, closed, 1e-5 * closed);
    }
    EXPECT_FALSE(led->sample({0, 0, 0.6}, {0.5, 0.5}).valid);
  }
}

TEST(Spot, FullInsideDarkOutsideAndHalfBetween) {
  const auto spot = lamp("spot", {{"watt_per_sr", 5.0}, {"outer_rad", 0.6}, {"inner_share", 0.5}}, {}, {0, 0, 1});
  const auto at = [&](double angle) { return intensity(*spot, {std::sin(angle), 0, std::cos(angle)}); };
  EXPECT_NEAR(at(0), 5, 1e-12);
  EXPECT_NEAR(at(0.299), 5, 1e-4);
  EXPECT_NEAR(at(std::acos((std::cos(0.3) + std::cos(0.6)) / 2)), 2.5, 1e-9);
  EXPECT_NEAR(at(0.599), 0, 1e-3);
  EXPECT_EQ(at(0.601), 0);
  const double e = irradiance_by_sampling(*spot, {0, 0, 4}, {0, 0, -1}, 2).x;
  EXPECT_NEAR(e, 5.0 / 16, 1e-12);
  const auto hard =
      lamp("spot", {{"watt_per_sr", 5.0}, {"outer_rad", 0.6}, {"inner_share", 1.0}, {"exponent", 2.0}}, {}, {0, 0, 1});
  EXPECT_NEAR(intensity(*hard, {std::sin(0.59), 0, std::cos(0.59)}), 5 * std::pow(std::cos(0.59), 2), 1e-9);
}

class LampFile : public testing::Test {
 protected:
  light::Attachment file(const std::string& name, const std::string& text) {
    const auto path = folder_ / name;
    std::ofstream(path) << text;
    return {nullptr, path};
  }
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "gonio-lamps-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string problem_of(const std::string& model, const std::string& text) {
    try {
      lamp(model, {{"watt_per_sr", 1.0}}, {}, {0, 0, -1}, file("bad", text));
    } catch (const std::exception& error) {
      return error.what();
    }
    return "none";
  }
  std::filesystem::path folder_;
};

TEST_F(LampFile, LobeTableIsLinearAndDarkBeyond) {
  const auto table = lamp("lobe-table", {{"watt_per_sr", 4.0}}, {}, {0, 0, 1},
                          file("t.csv", "# made up\r\n emission_deg , relative\r\n0, 1\r\n30,0.5\r\n90, 0\r\n"));
  for (const auto& [degrees, value] : std::map<double, double>{{0, 1}, {15, 0.75}, {30, 0.5}, {60, 0.25}, {91, 0}})
    EXPECT_NEAR(intensity(*table, tilted(degrees)), 4 * value, 1e-9) << degrees;
  EXPECT_NE(problem_of("lobe-table", "angle,value\n0,1\n"), "none");
  EXPECT_NE(problem_of("lobe-table", "emission_rad,relative\n0,1\n"), "none");
  EXPECT_NE(problem_of("lobe-table", "emission_rad,relative\n0,1\n0,2\n"), "none");
  EXPECT_NE(problem_of("lobe-table", "emission_rad,relative\n0,1\n1,-2\n"), "none");
  EXPECT_NE(problem_of("lobe-table", "emission_rad,relative\n0,1\n4,2\n"), "none");
  EXPECT_NE(problem_of("lobe-table", "emission_rad,relative\n0,nan\n1,2\n"), "none");
}

std::string ies_of(int type, const std::string& vertical, const std::string& horizontal, const std::string& candela,
                   int verticals, int horizontals, const std::string& tilt = "TILT=NONE\n") {
  return "IESNA:LM-63-1995\r\n[TEST] none\r\n" + tilt + "1 1000 1.0 " + std::to_string(verticals) + " " +
         std::to_string(horizontals) + " " + std::to_string(type) + " 2 0.1,0.1 0\n1 1 20\n" + vertical + "\n" +
         horizontal + "\n" + candela + "\n";
}
Vec3 type_c(double vertical, double horizontal) {  // lamp that shines along -z, up = +y: C0 along +y, C90 along
  const double v = vertical * pi / 180, h = horizontal * pi / 180;  // up x direction = -x
  return {-std::sin(v) * std::sin(h), std::sin(v) * std::cos(h), -std::cos(v)};
}

TEST_F(LampFile, IesSymmetriesOfTypeC) {
  const manifest::Parameters power = {{"watt_per_sr", 1.0}, {"up", vector_of({0, 1, 0})}};
  const auto make = [&](const std::string& text) { return lamp("ies", power, {}, {0, 0, -1}, file("l.ies", text)); };
  const auto round = make(ies_of(1, "0 45 90", "0", "100 50 0", 3, 1));
  const auto quarter = make(ies_of(1, "0 90", "0 90", "100 20\n100 60", 2, 2));
  const auto half = make(ies_of(1, "0 90", "0 90 180", "100 20\n100 60\n100 40", 2, 3));
  const auto across = make(ies_of(1, "0 90", "90 180 270", "100 20\n100 60\n100 40", 2, 3));
  const auto full = make(ies_of(1, "0 90", "0 90 180 270 360", "100 20\n100 60\n100 40\n100 80\n100 20", 2, 5));
  EXPECT_NEAR(intensity(*round, type_c(0, 0)), 1, 1e-12);
  for (const double h : {0.0, 77.0, 200.0}) EXPECT_NEAR(intensity(*round, type_c(22.5, h)), 0.75, 1e-9);
  for (const double h : {45.0, 135.0, 225.0, 315.0}) EXPECT_NEAR(intensity(*quarter, type_c(89.999999, h)), 0.4, 1e-6);
  EXPECT_NEAR(intensity(*quarter, type_c(89.999999, 180)), 0.2, 1e-6);
  for (const double h : {135.0, 225.0}) EXPECT_NEAR(intensity(*half, type_c(89.999999, h)), 0.5, 1e-6);
  for (const double h : {45.0, 315.0}) EXPECT_NEAR(intensity(*half, type_c(89.999999, h)), 0.4, 1e-6);
  EXPECT_NEAR(intensity(*across, type_c(89.999999, 0)), 0.6, 1e-6);  // mirrored from 180
  EXPECT_NEAR(intensity(*across, type_c(89.999999, 45)), 0.4, 1e-6);
  EXPECT_NEAR(intensity(*across, type_c(89.999999, 270)), 0.4, 1e-6);
  EXPECT_NEAR(intensity(*full, type_c(89.999999, 270)), 0.8, 1e-6);
  EXPECT_NEAR(intensity(*full, type_c(89.999999, 315)), 0.5, 1e-6);
  EXPECT_EQ(intensity(*full, type_c(91, 0)), 0);
}

TEST_F(LampFile, IesTypesAAndB) {
  const manifest::Parameters power = {{"watt_per_sr", 1.0}, {"up", vector_of({0, 1, 0})}};
  const std::string tilt = "TILT=INCLUDE\n1\n3\n0 45 90\n1 0.9 0.8\n";
  // Horizontal 0 and 90 mirrored; brightest at the aim. x of the lamp is up x direction = -x of the world.
  for (const int type : {2, 3}) {
    const auto headlamp = lamp("ies", power, {}, {0, 0, -1},
                               file("h.ies", ies_of(type, "-90 0 90", "0 90", "10 100 30\n0 20 0", 3, 2, tilt)));
    EXPECT_NEAR(intensity(*headlamp, {0, 0, -1}), 1, 1e-9);
    EXPECT_NEAR(intensity(*headlamp, {0, std::sqrt(0.5), -std::sqrt(0.5)}), 0.65, 1e-9);   // 45 degrees up
    EXPECT_NEAR(intensity(*headlamp, {0, -std::sqrt(0.5), -std::sqrt(0.5)}), 0.55, 1e-9);  // and down
    for (const double side : {-1.0, 1.0})
      EXPECT_NEAR(intensity(*headlamp, {side * std::sqrt(0.5), 0, -std::sqrt(0.5)}), 0.6, 1e-9);
    EXPECT_EQ(intensity(*headlamp, {0, 0, 1}), 0);
  }
}

TEST_F(LampFile, IesFilesThatAreBrokenAreRefused) {
  for (const std::string& text :
       {std::string("no lamp at all"), ies_of(1, "0 90", "0", "1", 2, 1), ies_of(1, "0 90", "0", "1 -2", 2, 1),
        ies_of(1, "90 0", "0", "1 2", 2, 1), ies_of(1, "0 90", "0 120", "1 2 1 2", 2, 2),
        ies_of(1, "0 90", "0", "0 0", 2, 1), ies_of(4, "0 90", "0", "1 2", 2, 1),
        ies_of(1, "0 90", "0", "1 2", 2000000000, 1), ies_of(1, "0 90", "0", "1 2", 10000, 10000),
        ies_of(1, "0 90", "0", "1 x", 2, 1), ies_of(2, "0 90", "0 120", "1 2 1 2", 2, 2)})
    EXPECT_NE(problem_of("ies", text), "none") << text;
}

TEST(Screen, ShowsItsPictureUprightToWhoLooksAtIt) {
  auto picture = std::make_shared<io::Image>(4, 2, std::vector<std::string>{"R", "G", "B"});
  picture->at(0, 0, 0) = 3;  // top left: red
  picture->at(3, 1, 1) = 5;  // bottom right: green
  // The screen faces +x; up is +z. Who looks at it, along -x, has +y to the right.
  const auto screen =
      lamp("screen", {{"width_m", 0.4}, {"height_m", 0.2}, {"scale", 2.0}}, {}, {1, 0, 0}, {picture, {}});
  EXPECT_EQ(screen->hit({1, -0.15, 0.05}, {-1, 0, 0}).radiance, (Rgb{6, 0, 0}));
  EXPECT_EQ(screen->hit({1, 0.15, -0.05}, {-1, 0, 0}).radiance, (Rgb{0, 10, 0}));
  EXPECT_EQ(screen->hit({1, 0.15, 0.05}, {-1, 0, 0}).radiance, Rgb{});
  EXPECT_EQ(screen->hit({-1, 0.15, -0.05}, {1, 0, 0}).radiance, Rgb{});
}

TEST(Screen, WhiteOneIsTheRectangle) {
  auto white = std::make_shared<io::Image>(7, 5, std::vector<std::string>{"Y"});
  for (float& v : white->data) v = 1;
  const manifest::Parameters size = {{"width_m", 0.4}, {"height_m", 0.3}, {"exponent", 2.5}};
  manifest::Parameters shown = size, plain = size;
  shown["scale"] = 10.0;
  plain["watt_per_sr"] = 10 * 0.4 * 0.3;
  const auto screen = lamp("screen", shown, {0.1, 0, 0.5}, {0.3, 0.2, -1}, {white, {}});
  const auto panel = lamp("rectangle", plain, {0.1, 0, 0.5}, {0.3, 0.2, -1});
  for (const double tilt : {0.0, 60.0, 95.0})
    EXPECT_NEAR(irradiance_by_sampling(*screen, {0.05, 0, 0}, tilted(tilt)).x,
                irradiance_by_sampling(*panel, {0.05, 0, 0}, tilted(tilt)).x, 2e-3);
}

TEST(Screen, LightIsPolarizedAlongThePassingAxis) {
  const auto make = [](double angle, double degree) {
    auto white = std::make_shared<io::Image>(1, 1, std::vector<std::string>{"Y"});
    white->data = {1};
    return lamp("screen",
                {{"width_m", 1.0}, {"height_m", 1.0}, {"polarization_rad", angle}, {"polarization_degree", degree}}, {},
                {1, 0, 0}, {white, {}});
  };
  EXPECT_FALSE(make(0.3, 0)->polarization({1, 0, 0}).has_value());
  for (const double angle : {0.0, 0.3, pi / 4, pi / 2}) {
    const auto screen = make(angle, 0.9);
    const auto straight = screen->polarization({1, 0, 0});
    ASSERT_TRUE(straight.has_value());
    EXPECT_NEAR(straight->stokes.s[0], 1, 0);
    EXPECT_NEAR(straight->stokes.s[1], 0.9, 0);
    const Vec3 passes{0, std::cos(angle), std::sin(angle)};  // right is +y, up is +z
    EXPECT_NEAR(std::abs(dot(straight->x, passes)), 1, 1e-12) << angle;
    const Vec3 slant = normalized(Vec3{1, 0.8, -0.4});
    const auto oblique = screen->polarization(slant);
    EXPECT_NEAR(dot(oblique->x, slant), 0, 1e-12);
    EXPECT_NEAR(norm(oblique->x), 1, 1e-12);
    EXPECT_NEAR(dot(oblique->x, Vec3{0, -std::sin(angle), std::cos(angle)}), 0,
                1e-12);  // none along the absorbing axis
  }
  EXPECT_FALSE(light::find("point")
                   ->prepare({{"position_m", vector_of({})}, {"watt_per_sr", 1.0}}, {}, "p")
                   ->polarization({1, 0, 0})
                   .has_value());
}

}  // namespace
}  // namespace gonio::tests
