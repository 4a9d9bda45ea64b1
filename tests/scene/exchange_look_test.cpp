// Surfaces in the few terms that other renderers share.
#include <algorithm>

#include "exchange_cases.h"
#include "scene/exchange/look.h"

namespace gonio::scene {
namespace {

TEST(ExchangeLook, SurfacesAreRecognisedByWhatTheyState) {
  const Letter letter;
  const Scene scene = build_scene(every_look(letter));
  std::map<std::string, Look> looks;
  std::map<std::string, std::vector<Loss>> losses;
  for (const Surface& surface : scene.appearance.surfaces)
    looks[surface.id] = look_of(scene.appearance, surface, losses[surface.id]);
  EXPECT_EQ(looks["glass"].kind, Look::Kind::glass);
  EXPECT_FALSE(looks["glass"].rough());
  EXPECT_TRUE(looks["cloud"].beckmann);
  EXPECT_NEAR(looks["cloud"].alpha_y, 0.2 * (1 - 0.9 * 0.5), 1e-12);
  EXPECT_TRUE(looks["copper"].complex_index);
  EXPECT_EQ(looks["lacquer"].kind, Look::Kind::metal);
  EXPECT_EQ(looks["lacquer"].coat_eta, 1.5);
  // A coat over a Lambertian base is interfaced-diffuse, whose own albedo comes back from that seen through it.
  EXPECT_EQ(looks["coated wood \"&<'"].kind, Look::Kind::coated);
  EXPECT_NEAR(albedo_beneath(looks["varnish"].colour, mean_internal_reflectance(1.5)).x, 0.4, 1e-12);
  EXPECT_NEAR(albedo_beneath(looks["coated wood \"&<'"].colour, mean_internal_reflectance(1.5)).x, 0.3, 1e-12);
  for (const char* exact : {"glass", "copper", "lacquer", "varnish", "gold", "paint"})
    EXPECT_TRUE(losses[exact].empty()) << exact << ": " << losses[exact].front().what;
}

// A dipole is the random walk of its own reflectance: the closed form of Jensen et al. 2001 for that of light that
// falls in everywhere, exp(-sigma_tr z) over both sources.
TEST(ExchangeLook, DipolesKeepTheirReflectance) {
  Appearance appearance;
  appearance.surfaces.push_back(
      {.id = "it",
       .model = surface::find("dipole"),
       .parameters = {{"eta", 1.0}, {"sigma_s_per_m", 1000.0}, {"sigma_a_per_m", std::vector<double>{1, 10, 100}}}});
  refresh(appearance.surfaces[0], "it");
  std::vector<Loss> losses;
  const Look look = look_of(appearance, appearance.surfaces[0], losses);
  EXPECT_EQ(look.kind, Look::Kind::translucent);
  for (const int c : {0, 1, 2}) {
    const double sigma_a = std::pow(10, c), sigma_t = sigma_a + 1000, albedo = 1000 / sigma_t;
    const double root = std::sqrt(3 * (1 - albedo));  // z_r sigma_tr; the mirrored source lies 1 + 4/3 times as deep
    EXPECT_NEAR(look.colour[c], albedo / 2 * (1 + std::exp(-4.0 / 3 * root)) * std::exp(-root), 0.02) << c;
    EXPECT_NEAR(look.diffuse_length_m[c], 1 / std::sqrt(3 * sigma_a * sigma_t), 1e-12);
  }
}

// Values in the middle of their bounds for whatever a model wants to be told.
manifest::Parameters plausible(const manifest::ModelInfo& info) {
  manifest::Parameters all;
  for (const manifest::ParameterInfo& p : info.parameters) {
    if (p.preset) continue;
    const double value = std::clamp(p.name == "watt_per_sr" || p.lower > 1 ? p.lower : 0.5, p.lower, p.upper);
    all[p.name] = manifest::Parameter(std::vector<double>(static_cast<std::size_t>(p.components), value));
  }
  return all;
}

// Whatever surfaces are registered: each becomes a look with finite numbers, or is named as not expressible.
TEST(ExchangeLook, EveryRegisteredSurfaceIsALookOrALoss) {
  for (const surface::Model* model : surface::all_models()) {
    if (model->info().attachment != manifest::Attachment::none) continue;
    SCOPED_TRACE(model->info().id);
    Appearance appearance;
    appearance.surfaces.resize(2);
    appearance.surfaces[0] = {.id = "base", .model = surface::find("diffuse"), .parameters = {{"albedo", 0.5}}};
    appearance.surfaces[1] = {.id = "it", .model = model, .parameters = plausible(model->info())};
    refresh(appearance.surfaces[0], "base");
    refresh(appearance.surfaces[1], "it");
    if (model->info().takes_base) appearance.surfaces[1].base = 0;
    std::vector<Loss> losses;
    const Look look = look_of(appearance, appearance.surfaces[1], losses);
    for (int c = 0; c < 3; ++c) {
      EXPECT_GE(look.colour[c], 0);
      EXPECT_LE(look.colour[c], 1.01);
    }
    EXPECT_GE(look.eta, 1);
    const bool foreign = std::ranges::any_of(model->info().parameters, [](const auto& p) {
      return p.name.starts_with("ridge") || p.name.starts_with("wavelength") || p.name == "rho_d";
    });
    EXPECT_EQ(foreign, std::ranges::any_of(losses, [](const Loss& l) { return l.pointer == "/surfaces/it/model"; }));
  }
}

}  // namespace
}  // namespace gonio::scene
