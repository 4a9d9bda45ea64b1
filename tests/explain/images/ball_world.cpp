#include "ball_world.h"

#include "base/random.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "render/path_tracer.h"
#include "render/ray_caster.h"
#include "render/sensor_chain.h"
#include "scene/scene.h"

namespace gonio::tests {
namespace {

constexpr double noise = 0.002;

}  // namespace

std::string ball_manifest(const std::string& mechanisms) {
  std::string files, images, lights;
  const char* poses[2] = {"[[1,0,0,0],[0,-0.5,0.8660254037844386,-0.5],[0,-0.8660254037844386,-0.5,0.32],[0,0,0,1]]",
                          "[[0,0.5,-0.8660254037844386,0.5],[1,0,0,0],[0,-0.8660254037844386,-0.5,0.32],[0,0,0,1]]"};
  const char* places[3] = {"[0.3,-0.3,0.4]", "[-0.35,-0.1,0.45]", "[0.05,0.25,0.5]"};
  for (int l = 0; l < 3; ++l)
    lights += std::string(l ? "," : "") + "\"lamp-" + std::to_string(l) +
              "\":{\"model\":\"point\",\"position_m\":" + places[l] +
              ",\"watt_per_sr\":{\"value\":[0.6,0.6,0.6],\"free\":true,\"share\":\"lamp\"}}";
  for (int c = 0; c < 2; ++c)
    for (int l = 0; l < 3; ++l) {
      const std::string id = std::to_string(c) + std::to_string(l), comma = c + l ? "," : "";
      files += comma + "\"" + id + "\":{\"path\":\"" + id + ".exr\"}";
      images += comma + "{\"id\":\"" + id + "\",\"file\":\"" + id + "\",\"camera\":\"camera\"," +
                "\"world_from_camera\":{\"matrix\":" + poses[c] + "},\"light\":\"lamp-" + std::to_string(l) +
                "\",\"noise\":{\"gain\":1e9,\"read\":" + std::to_string(noise) + "}}";
    }
  return "{\"gonio\":1,\"files\":{" + files +
         "},\"cameras\":{\"camera\":{\"width_px\":48,\"height_px\":48,\"fx_px\":85,\"fy_px\":85,\"cx_px\":23.5,\"cy_"
         "px\":23.5}},"
         "\"meshes\":{\"ball\":{\"sphere\":{\"radius_m\":0.08}},\"table\":{\"plane\":{\"size_m\":[1.5,1.5]}}},"
         "\"surfaces\":{\"ball\":{\"model\":\"diffuse\",\"albedo\":{\"value\":[0.5,0.4,0.3],\"free\":true}},"
         "\"table\":{\"model\":\"diffuse\",\"albedo\":{\"value\":[0.5,0.5,0.5],\"free\":true}}},\"lights\":{" +
         lights +
         "},\"objects\":[{\"id\":\"ball\",\"mesh\":\"ball\",\"surface\":\"ball\",\"world_from_object\":{\"rotation\":["
         "1,0,0,0],"
         "\"translation_m\":[0,0,0.081]}},{\"id\":\"table\",\"mesh\":\"table\",\"surface\":\"table\"}],\"images\":[" +
         images + "],\"mechanisms\":{" + mechanisms + "}}";
}

manifest::Document record_ball(const ScratchFolder& folder, const std::string& truth, const std::string& believed,
                               int spp, std::uint64_t seed, std::vector<io::Image>* renderings) {
  const manifest::Document full = manifest::parse_document(ball_manifest(truth), "truth", folder.path());
  const scene::Scene scene = scene::build_scene(full);
  const render::RayCaster caster(scene.instances);
  render::Options options;
  options.spp = spp;
  options.seed = seed;
  options.geometry = false;
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    const io::Image rendered = render::render(scene, v, caster, options);
    render::Sensor sensor = render::sensor_of(full, v);
    sensor.noise = {};
    io::Image picture = render::recorded(rendered, sensor, scene.views[v].image, seed);
    Random random(seed, v);
    for (float& value : picture.data) value += static_cast<float>(noise * random.normal());
    io::write_picture(folder / (scene.views[v].image + ".exr"), picture);
    if (renderings) renderings->push_back(rendered);
  }
  return manifest::parse_document(ball_manifest(believed), "believed", folder.path());
}

}  // namespace gonio::tests
