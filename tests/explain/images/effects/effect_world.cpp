#include "effect_world.h"

#include <cmath>
#include <sstream>

#include "base/random.h"
#include "geom/vector.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "render/path_tracer.h"
#include "render/ray_caster.h"
#include "render/sensor_chain.h"
#include "scene/scene.h"

namespace gonio::tests {
namespace {

// World from camera for a camera about half a metre away that looks at the ball; x to the right, y down, z ahead.
std::string pose(int view) {
  const double azimuth = 0.3 + 0.9 * view, out = 0.5, up = 0.32 - 0.03 * view;
  const Vec3 eye{out * std::cos(azimuth), out * std::sin(azimuth), up}, target{0.012 * view, -0.01 * view, 0.05};
  const Vec3 z = normalized(target - eye), x = normalized(cross(z, Vec3{0, 0, 1})), y = cross(z, x);
  std::ostringstream text;
  text.precision(17);
  text << "[[" << x.x << "," << y.x << "," << z.x << "," << eye.x << "],[" << x.y << "," << y.y << "," << z.y << ","
       << eye.y << "],[" << x.z << "," << y.z << "," << z.z << "," << eye.z << "],[0,0,0,1]]";
  return text.str();
}

const char* const places[4] = {"[0.3,-0.3,0.4]", "[-0.35,-0.1,0.45]", "[0.05,0.25,0.5]", "[0.2,0.3,0.35]"};

}  // namespace

std::string EffectWorld::manifest(const std::string& mechanisms) const {
  std::ostringstream files, images, lamp_text;
  const int lamp_count = lights.empty() ? lamps : static_cast<int>(lights.size());
  for (int l = 0; l < lamp_count; ++l) {
    lamp_text << (l ? "," : "") << "\"lamp-" << l << "\":";
    if (lights.empty())
      lamp_text << R"({"model":"point","position_m":)" << places[l]
                << R"(,"watt_per_sr":{"value":[0.6,0.6,0.6],"free":true,"share":"lamp"}})";
    else
      lamp_text << lights[static_cast<std::size_t>(l)];
  }
  for (int c = 0; c < views; ++c)
    for (int l = 0; l < (lights_together ? 1 : lamp_count); ++l) {
      const std::string id = std::to_string(c) + std::to_string(l), comma = c + l ? "," : "";
      files << comma << "\"" << id << R"(":{"path":")" << id << ".exr\"}";
      images << comma << R"({"id":")" << id << R"(","file":")" << id << R"(","camera":"camera","world_from_camera":)"
             << R"({"matrix":)" << pose(c) << "}";
      if (!lights_together) images << R"(,"light":"lamp-)" << l << "\"";
      images << R"(,"noise":{"gain":1e9,"read":)" << noise << "}}";
    }
  std::ostringstream all;
  const double focal = 1.77 * size_px, centre = 0.5 * (size_px - 1);
  all << R"({"gonio":1,"files":{)" << files.str() << R"(},"cameras":{"camera":{"width_px":)" << size_px
      << R"(,"height_px":)" << size_px << R"(,"fx_px":)" << focal << R"(,"fy_px":)" << focal << R"(,"cx_px":)" << centre
      << R"(,"cy_px":)" << centre
      << R"(}},"meshes":{"ball":{"sphere":{"radius_m":0.08}},"table":{"plane":{"size_m":[1.5,1.5]}})" << more_meshes
      << R"(},"surfaces":{"ball":)" << ball << R"(,"table":)" << table << more_surfaces << R"(},"lights":{)"
      << lamp_text.str()
      << R"(},"objects":[{"id":"ball","mesh":"ball","surface":"ball","world_from_object":{"rotation":[1,0,0,0],)"
      << R"("translation_m":[0,0,0.081]}},{"id":"table","mesh":"table","surface":"table"})" << more_objects
      << R"(],"images":[)" << images.str() << R"(],"mechanisms":{)" << mechanisms << "}}";
  return all.str();
}

std::vector<io::Image> EffectWorld::render() const {
  const manifest::Document full = manifest::parse_document(manifest(truth), "truth", {});
  const scene::Scene scene = scene::build_scene(full);
  const render::RayCaster caster(scene.instances);
  std::vector<io::Image> pictures;
  for (std::size_t i = 0; i < scene.views.size(); ++i) {
    const io::Image rendered = render::render(
        scene, i, caster, {.spp = spp, .seed = seed, .geometry = false, .transport = {.stokes = stokes}});
    render::Sensor sensor = render::sensor_of(full, i);
    sensor.noise = {};
    pictures.push_back(render::recorded(rendered, sensor, scene.views[i].image, seed));
  }
  return pictures;
}

manifest::Document EffectWorld::record(const ScratchFolder& folder) const {
  const manifest::Document believed_all = manifest::parse_document(manifest(believed), "believed", folder.path());
  const auto ids = names_in(believed_all, "images");  // and of their files
  std::vector<io::Image> pictures = render();
  const std::size_t per_view = pictures.size() / static_cast<std::size_t>(views);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (change) change(i, i / per_view, pictures[i]);
    Random random(noise_seed, i);
    for (float& value : pictures[i].data) {
      value += static_cast<float>(noise * random.normal());
      if (full_scale > 0) value = std::min(value, static_cast<float>(full_scale));
    }
    io::write_picture(folder / (ids[i] + ".exr"), pictures[i]);
  }
  return believed_all;
}

EffectOutcome::EffectOutcome(const EffectWorld& world, const std::vector<std::string>& hypotheses)
    : problem(world.record(folder), {.pixels = 1500}),
      explanation(explain::explain(problem, {.hypotheses = hypotheses})) {}

std::vector<std::string> EffectOutcome::named() const {
  std::vector<std::string> ids;
  for (const std::size_t c : explanation.named) ids.push_back(problem.candidates()[c].id());
  return ids;
}

std::string EffectOutcome::told() const {
  std::string text = explanation.sentence;
  for (const explain::Hypothesis& h : explanation.scoreboard) {
    text += "\n" + h.name + ": gain " + std::to_string(h.gain) + " +- " + std::to_string(h.gain_sigma) + ", held out " +
            std::to_string(h.held_out) + " " + h.refused;
    for (const explain::Estimate& e : h.parameters)
      text += " " + problem.parameters()[e.parameter].name + "=" + std::to_string(e.value);
  }
  return text;
}

double EffectOutcome::fitted(const std::string& parameter) const {
  for (const explain::Estimate& e : explanation.estimates) {
    const std::string& name = problem.parameters()[e.parameter].name;
    if (name.ends_with(parameter)) return e.value;
  }
  return std::nan("");
}

}  // namespace gonio::tests
