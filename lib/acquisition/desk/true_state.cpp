// See true_state.h, true_laboratory.h.
#include "acquisition/desk/true_state.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/hash.h"
#include "base/text.h"
#include "camera/intrinsics.h"
#include "io/image.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "mechanism/mechanism.h"
#include "render/sensor_chain.h"
#include "render/session.h"
#include "scene/amounts.h"

namespace gonio::acquisition {
namespace {

// Where the description says nothing of them:
constexpr double full_well_electrons = 10000, usual_read_electrons = 3;
constexpr double usual_exposure_s = 0.01;  // at which a radiance of 1 saturates

// Entries of `truth` take the place of those of the same name.
template <class Section>
void replace(Section& section, const Section& truth) {
  for (const auto& [name, entry] : truth) section[name] = entry;
}

bool is_of_robots(const mechanism::Mechanism& m) {
  return std::ranges::find(m.domains, "robot") != m.domains.end() && m.id.starts_with("robot.");
}

robot::ChainState chain_of(manifest::Document& document) {
  robot::ChainState chain;
  std::vector<std::string> taken;
  for (const auto& [id, use] : document.mechanisms) {
    const mechanism::Mechanism* m = mechanism::find_mechanism(id);
    if (m == nullptr || !is_of_robots(*m)) continue;
    const std::string at = manifest::place(document, "/mechanisms/" + id);
    const scene::Amounts amounts = scene::amounts_of(*m, use, 0, 1, at);
    for (std::size_t i = 0; i < m->parameters.size(); ++i)
      if (const auto role = robot::role_of(m->parameters[i].name)) robot::set(chain, *role, amounts[i]);
    taken.push_back(id);
  }
  for (const std::string& id : taken) document.mechanisms.erase(id);
  return chain;
}

std::string light_of(const std::string& lamp, const manifest::LaboratoryLamp& entry) {
  return entry.light.empty() ? lamp : entry.light;
}

int bits_of(const std::string& pixel_format) {
  for (const int bits : {16, 14, 12, 10, 8})
    if (pixel_format.find(std::to_string(bits)) != std::string::npos) return bits;
  return 12;
}

// What turns a radiance into codes: code = black + full * v, v = gain * radiance through the sensor chain, up to white.
// The chain works on v, what the frame's file says of the light: what a sensor does to its codes depends on the
// exposure.
struct DeskSensor {
  int bits = 12;
  double white = 4095, black = 0, full = 65535, gain = 1;
  manifest::Noise noise;  // of v
};

DeskSensor sensor_at(const manifest::LaboratoryCamera& entry, double exposure_s) {
  DeskSensor sensor;
  sensor.bits = bits_of(entry.pixel_format);
  sensor.white = entry.white.value_or((1 << sensor.bits) - 1);
  sensor.black = entry.black_code.value_or(0);
  sensor.full = sensor.bits > 8 ? 65535 : 255;
  sensor.gain = entry.codes_per_radiance_s.value_or(sensor.white / usual_exposure_s) * exposure_s / sensor.full;
  const double electrons = entry.electrons_per_code.value_or(full_well_electrons / sensor.white) * sensor.full;
  sensor.noise = {.gain = electrons, .read = entry.read_electrons.value_or(usual_read_electrons) / electrons};
  return sensor;
}

}  // namespace

double warmth_K(double time_s) {
  return 10 * (1 - std::exp(-time_s / 1800));
}

TrueState::TrueState(const manifest::Document& believed, const manifest::Document* truth, const DeskOptions& wanted)
    : document(believed), options(wanted) {
  if (truth != nullptr) {
    replace(document.mechanisms, truth->mechanisms);
    replace(document.lights, truth->lights);
    replace(document.surfaces, truth->surfaces);
    replace(document.cameras, truth->cameras);
    if (!truth->laboratory.entry.empty()) document.laboratory = truth->laboratory;
  }
  laboratory = believed_laboratory(document);
  chain = chain_of(document);
  const manifest::Laboratory& lab = document.laboratory.entry.front();
  for (const auto& [name, arm] : laboratory.arms) joints[name] = arm.home;
  for (const auto& [name, lamp] : lab.lamps) {
    if (!document.lights.contains(light_of(name, lamp)))
      throw Error(Exit::data, manifest::place(document, "/laboratory/lamps/" + name),
                  "lights no light of the scene: \"" + light_of(name, lamp) + "\"", "enter it in lights");
    lit[name] = false;
  }
  for (const auto& [name, table] : lab.turntables) angle_rad[name] = 0;
}

Rigid<frame::World, frame::Tool> TrueState::world_from_tool(const std::string& name) const {
  const LaboratoryArm& arm = laboratory.arms.at(name);
  robot::ChainInput input;
  input.links = arm.links;
  robot::ChainInput::View view;
  view.joints_rad = joints.at(name);
  view.base_from_tool = robot::flange(arm.links, view.joints_rad);
  if (const auto found = approach.find(name); found != approach.end()) view.approach = found->second;
  view.warmer_K = warmth_K(time_s);
  view.later_s = time_s;
  return arm.world_from_base * robot::tool_pose(input, view, chain);
}

void TrueState::place_lamps(manifest::Document& scene) const {
  for (const auto& [name, lamp] : document.laboratory.entry.front().lamps) {
    manifest::Light& light = scene.lights.at(light_of(name, lamp));
    std::vector<double> where = lamp.in_world_m;
    if (!lamp.robot.empty() && lamp.in_tool_m.size() == 3) {
      const Vec3 p = world_from_tool(lamp.robot) * Vec3{lamp.in_tool_m[0], lamp.in_tool_m[1], lamp.in_tool_m[2]};
      where = {p.x, p.y, p.z};
    }
    if (const auto found = light.parameters.find("position_m"); found != light.parameters.end() && where.size() == 3)
      found->second.value = where;
  }
}

// Objects on a turntable turn about its z.
void TrueState::turn_objects(manifest::Document& scene) const {
  for (const auto& [name, table] : document.laboratory.entry.front().turntables) {
    const auto world_from_table = table.world_from_table ? Rigid<frame::World, frame::Object>(*table.world_from_table)
                                                         : Rigid<frame::World, frame::Object>{};
    const Rigid<frame::Object, frame::Object> turn{quaternion_of_rotation_vector({0, 0, angle_rad.at(name)}), {}};
    const Rigid<frame::World, frame::World> motion = world_from_table * turn * inverse(world_from_table);
    for (manifest::Object& object : scene.objects) {
      if (std::ranges::find(table.carries, object.id) == table.carries.end()) continue;
      if (!object.world_from_object) object.world_from_object.emplace();
      auto& pose = static_cast<Rigid<frame::World, frame::Object>&>(*object.world_from_object);
      pose = motion * pose;
    }
  }
}

// One image: the camera where it really is, the lights that are lit and those that no lamp is.
manifest::Document TrueState::scene_of(const std::string& camera, const Shot& shot) const {
  manifest::Document scene = document;
  const manifest::Laboratory& lab = document.laboratory.entry.front();
  const manifest::LaboratoryCamera& entry = lab.cameras.at(camera);
  place_lamps(scene);
  turn_objects(scene);
  manifest::ImageEntry image;
  image.camera = camera;
  image.exposure_s = shot.exposure_s;
  image.time_s = time_s;
  image.temperature_K = 293.15 + warmth_K(time_s);
  auto& pose = static_cast<Rigid<frame::World, frame::Camera>&>(image.world_from_camera.emplace());
  if (!entry.robot.empty() && entry.tool_from_camera)
    pose = world_from_tool(entry.robot) * Rigid<frame::Tool, frame::Camera>(*entry.tool_from_camera);
  else if (entry.world_from_camera)
    pose = *entry.world_from_camera;
  std::map<std::string, bool> of_lamps;
  for (const auto& [name, lamp] : lab.lamps) of_lamps[light_of(name, lamp)] |= lit.at(name);
  for (const auto& [name, light] : document.lights)
    if (const auto found = of_lamps.find(name); found == of_lamps.end() || found->second) image.light.push_back(name);
  if (image.light.empty()) image.dark = true;
  const DeskSensor sensor = sensor_at(entry, shot.exposure_s);
  image.noise = sensor.noise;
  if (camera::mosaic_of(document, camera).empty()) {  // the mean of three readings has the noise of one
    image.noise->gain /= 3;
    image.noise->read *= std::sqrt(3.0);
  }
  image.gain = manifest::Parameter(sensor.gain);
  image.id = "frame";
  image.id = sha256(manifest::print_document(
                        [&] {
                          manifest::Document one = scene;
                          one.images = {image};
                          one.images.front().time_s.reset();
                          one.images.front().temperature_K.reset();
                          return one;
                        }(),
                        scene.folder))
                 .substr(0, 16);
  scene.images = {image};
  // What drifts with time counts from the beginning of the run.
  scene.images.push_back(image);
  scene.images.back().id = "beginning";
  scene.images.back().time_s = 0;
  return scene;
}

RawFrame TrueState::expose(const std::string& camera, const Shot& shot) {
  const manifest::Document scene = scene_of(camera, shot);
  render::SessionOptions how;
  how.seed = options.seed;
  how.spp = options.spp;
  how.geometry = false;
  how.checkpoint_s = std::numeric_limits<double>::infinity();  // a frame is rendered in one go
  const render::Session session(scene, how, [](const std::filesystem::path&) {});
  const std::string& id = scene.images.front().id;
  const io::Image picture = session.render(0, id + ".exr").picture;
  const render::Sensor sensor = render::sensor_of(scene, 0);
  const io::Image seen = render::recorded(picture, sensor, id, options.seed);
  const manifest::LaboratoryCamera& entry = document.laboratory.entry.front().cameras.at(camera);
  RawFrame frame;
  frame.width_px = seen.width;
  frame.height_px = seen.height;
  const DeskSensor chip = sensor_at(entry, shot.exposure_s);
  frame.bits = chip.bits;
  frame.pixel_format = entry.pixel_format.empty() ? "Mono12" : entry.pixel_format;
  const std::size_t channels = seen.channels.size();
  frame.samples.resize(seen.pixels());
  for (std::size_t i = 0; i < frame.samples.size(); ++i) {
    double v = 0;
    for (std::size_t c = 0; c < channels; ++c) v += seen.data[i * channels + c] / static_cast<double>(channels);
    const double code = std::round(chip.black + chip.full * v);
    frame.samples[i] = static_cast<std::uint16_t>(std::clamp(code, 0.0, chip.white));
  }
  time_s += shot.exposure_s;
  frame.frame_id = ++frames[camera];
  frame.chunk_frame_id = frame.frame_id;
  frame.exposure_s = shot.exposure_s;
  frame.gain_db = shot.gain_db;
  frame.temperature_K = 293.15 + warmth_K(time_s);
  return frame;
}

}  // namespace gonio::acquisition
