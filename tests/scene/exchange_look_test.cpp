// Surfaces in the few terms that other renderers share.
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

}  // namespace
}  // namespace gonio::scene
