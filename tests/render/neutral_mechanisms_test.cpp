// From the manifest to the recorded picture: whatever mechanism is switched on at its neutral values changes no bit of
// it, and each changes something at others. Walks the registry: light and surfaces, lens, vignetting, defocus, glare,
// crosstalk, responses, offsets and saturation.
#include <gtest/gtest.h>

#include <algorithm>

#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "mechanism/mechanism.h"
#include "render/path_tracer.h"
#include "render/sensor_chain.h"
#include "scene/mechanisms.h"

namespace gonio::render {
namespace {

using mechanism::Mechanism;
using mechanism::Target;

manifest::Document document(const std::string& camera = "", const std::string& image = "") {
  const std::string text =
      R"({"gonio": 1, "cameras": {"c": {"model": "pinhole", "width_px": 12, "height_px": 10, "fx_px": 12, "fy_px": 12,
                                        "cx_px": 5.5, "cy_px": 4.5)" +
      camera + R"(}},
         "meshes": {"ball": {"sphere": {"radius_m": 0.1}}, "floor": {"plane": {"size_m": [2, 2]}}},
         "surfaces": {"clay": {"model": "diffuse", "albedo": [0.6, 0.5, 0.3]},
                      "glaze": {"model": "coated-diffuse", "albedo": [0.6, 0.5, 0.3], "f0": 0.05, "alpha": 0.3}},
         "lights": {"sun": {"model": "directional", "towards": [0.2, 0.1, -1], "watt_per_m2": [0.3, 0.3, 0.3]},
                    "lamp": {"model": "point", "position_m": [0.3, 0.2, 0], "watt_per_sr": [3, 2, 4]}},
         "objects": [{"id": "ball", "mesh": "ball", "surface": "glaze",
                      "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0, 0, 0.5]}},
                     {"id": "floor", "mesh": "floor", "surface": "clay",
                      "world_from_object": {"rotation": [0, 1, 0, 0], "translation_m": [0, 0, 0.7]}}],
         "images": [{"id": "i", "camera": "c", "exposure_s": 0.1, "time_s": 5)" +
      image + R"(},
                    {"id": "earlier", "camera": "c", "time_s": 3}]})";
  return manifest::parse_document(text, "s.json", {});
}

std::vector<float> photograph(const manifest::Document& document, bool stokes = false) {
  const scene::Scene scene = scene::build_scene(document);
  const RayCaster caster(scene.instances);
  const io::Image rendered = render(scene, 0, caster, {.spp = 8, .geometry = false, .transport = {.stokes = stokes}});
  return recorded(rendered, sensor_of(document, 0), "i", 3).data;
}

bool concerns_pictures(const Mechanism& m) {
  const auto is_for = [&](const char* domain) { return std::ranges::find(m.domains, domain) != m.domains.end(); };
  const bool lens = m.stage == "lens" && m.target == Target::camera;
  // Acts through columns, height maps, tracks, volumes or clouds, which no picture has, or on glass and prints, which
  // are not here: what is traced is written into the surfaces themselves; or behind polarizers.
  const bool tables_alone = !m.domains.empty() && std::ranges::all_of(m.domains, [](const std::string& domain) {
    return domain == "tables" || domain == "heights" || domain == "nrsfm" || domain == "volumes" ||
           domain == "prints" || domain == "clouds" || domain == "traced" || domain == "polarization";
  });
  return lens || is_for("images") || !(is_for("boards") || is_for("robot") || tables_alone);
}

manifest::MechanismUse use(const Mechanism& m, bool neutral) {
  manifest::MechanismUse use;
  for (const auto& p : m.parameters)
    use.parameters[p.name] = neutral ? p.neutral : p.start != p.neutral ? p.start : 0.5 * (p.start + p.upper);
  const bool clips = m.id == "sensor.clipped-resampling" || m.id == "sensor.blooming";
  if (!neutral && clips) use.parameters["full_scale"] = 0.05;
  if (!neutral && m.id == "sensor.hot-pixel") use.parameters["share"] = 0.1;
  // Where the camera sees it: a light on its own side, a stain on the ball.
  if (!neutral && m.id == "light.second-source") use.parameters["elevation_rad"] = -0.8;
  if (!neutral && m.id == "surface.spatial-variation")
    for (const char* name : {"x_m", "y_m", "z_m"}) use.parameters[name] = 0.0;
  return use;
}

TEST(NeutralMechanisms, ChangeNoBitOfThePhotograph) {
  const std::vector<float> plain = photograph(document());
  int count = 0;
  for (const Mechanism* m : mechanism::all_mechanisms()) {
    if (!concerns_pictures(*m)) continue;
    manifest::Document neutral = document(), other = document();
    neutral.mechanisms[m->id] = use(*m, true);
    other.mechanisms[m->id] = use(*m, false);
    ++count;
    if (m->id == "transport.indirect") {  // neutral is a simulation without it; a scene that says nothing has it
      EXPECT_NE(photograph(neutral), plain);
      continue;
    }
    EXPECT_EQ(photograph(neutral), plain) << m->id;
    if (scene::beyond_rendering(*m) || m->id == "geometry.bend") {  // of meshes: a ball stays as it is
      EXPECT_EQ(photograph(other), plain) << m->id;
    } else if (m->id == "light.polarization") {  // matters to light that is carried with its polarization
      EXPECT_EQ(photograph(neutral, true), photograph(document(), true));
      EXPECT_NE(photograph(other, true), photograph(document(), true));
    } else {
      EXPECT_NE(photograph(other), plain) << m->id;
    }
  }
  EXPECT_GE(count, 18);
}

// No noise and no filters unless the image and the camera state them; then they act.
TEST(NeutralMechanisms, NoiseAndMosaicAreOffUnlessStated) {
  const manifest::Document plain = document();
  const scene::Scene scene = scene::build_scene(plain);
  const RayCaster caster(scene.instances);
  const io::Image rendered = render(scene, 0, caster, {.spp = 8, .geometry = false, .transport = {.stokes = true}});
  const auto sensed = [&](const manifest::Document& d) { return recorded(rendered, sensor_of(d, 0), "i", 3); };
  const io::Image ideal = sensed(plain);
  for (int y = 0; y < ideal.height; ++y)
    for (int x = 0; x < ideal.width; ++x)
      for (int c = 0; c < 3; ++c)
        ASSERT_EQ(ideal.at(x, y, c), rendered.at(x, y, rendered.channel(std::string(1, "RGB"[c]))));
  EXPECT_NE(sensed(document("", R"(, "noise": {"gain": 1000, "read": 0.01})")).data, ideal.data);
  for (const char* mosaic : {"RGGB", "polarizers"}) {
    const io::Image raw = sensed(document(std::string(R"(, "mosaic": ")") + mosaic + "\""));
    ASSERT_EQ(raw.channels, (std::vector<std::string>{"Y"})) << mosaic;
  }
}

}  // namespace
}  // namespace gonio::render
