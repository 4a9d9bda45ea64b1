// See true_state.h, true_laboratory.h.
#include "acquisition/desk/true_state.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "acquisition/desk/colour_filters.h"
#include "acquisition/laboratory/usual.h"
#include "acquisition/run/frame_record.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/text.h"
#include "camera/intrinsics.h"
#include "io/image.h"
#include "io/raster_header.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/file.h"
#include "manifest/sections/image.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/mesh.h"
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
constexpr double saturating_exposure_s = 0.01;  // at which a radiance of 1 saturates

// Entries of `truth` take the place of those of the same name.
template <class Section>
void replace(Section& section, const Section& truth) {
  for (const auto& [name, entry] : truth) section[name] = entry;
}

// Objects are taken as a whole: what lies on the table is what the truth says, or what the description says.
void take_truth(manifest::Document& document, const manifest::Document& other) {
  for (const auto& [id, use] : other.mechanisms) {
    const std::string at = manifest::place(other, "/mechanisms/" + id);
    const mechanism::Mechanism* m = mechanism::find_mechanism(id);
    if (m == nullptr) throw Error(Exit::data, at, "no such mechanism", "gonio-manifest(5) lists them");
    std::size_t count = 1;
    for (const auto& [name, parameter] : use.parameters) count = std::max(count, parameter.value.size());
    scene::amounts_of(*m, use, 0, count, at);  // refuses parameters that it has not
  }
  const manifest::Document truth = manifest::parse_document(manifest::print_document(other, document.folder),
                                                            other.name, document.folder, {document.allow_outside});
  replace(document.files, truth.files);
  replace(document.mechanisms, truth.mechanisms);
  replace(document.lights, truth.lights);
  replace(document.meshes, truth.meshes);
  replace(document.surfaces, truth.surfaces);
  replace(document.cameras, truth.cameras);
  if (!truth.objects.empty()) document.objects = truth.objects;
  if (!truth.laboratory.entry.empty()) document.laboratory = truth.laboratory;
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

// Which of the picture's channels a pixel's filter lets through; below 0: the mean of all.
int channel_of_filter(const std::string& mosaic, std::size_t row, std::size_t column) {
  const std::string corner = bayer_corner(mosaic);
  if (corner.empty()) return -1;
  const char filter = corner[row % 2 * 2 + column % 2];
  return filter == 'R' ? 0 : filter == 'G' ? 1 : 2;
}

// As the simulated camera's registers hold it.
Shot told(const Shot& shot) {
  Shot kept;
  kept.exposure_s = std::max(1.0, std::round(shot.exposure_s * 1e6)) / 1e6;
  kept.gain_db = std::round(shot.gain_db.value_or(0) * 100) / 100;
  return kept;
}

// What decides a picture, hashed: its noise is drawn by it, so that a frame taken again is the same frame, whatever
// else stands in the document and wherever its files lie.
std::string content_of(const manifest::Document& scene, manifest::ImageEntry image) {
  manifest::Document decides;
  decides.folder = scene.folder;
  decides.files = scene.files;
  for (auto& [id, file] : decides.files)
    if (!file.sha256.empty()) file.path = file.sha256;
  decides.cameras = scene.cameras;
  decides.meshes = scene.meshes;
  decides.surfaces = scene.surfaces;
  decides.lights = scene.lights;
  decides.objects = scene.objects;
  decides.mechanisms = scene.mechanisms;
  image.time_s.reset();
  image.temperature_K.reset();
  decides.images = {image};
  return sha256(manifest::print_document(decides, decides.folder));
}

// The same light, whatever a sensor makes of it: its picture is rendered once for a bracket of exposures, from the same
// random paths, as a scene that stands still sends the same light.
std::string light_content(const manifest::Document& scene, manifest::ImageEntry image) {
  const std::optional<double> time_s = image.time_s;
  image.id = "light";
  image.exposure_s.reset(), image.noise.reset(), image.gain.reset();
  const bool passes = std::ranges::any_of(scene.mechanisms, [](const auto& used) {
    const mechanism::Mechanism* m = mechanism::find_mechanism(used.first);
    return m == nullptr || std::ranges::find(m->inputs, "time_s", &mechanism::Input::name) != m->inputs.end();
  });
  return content_of(scene, image) + (passes && time_s ? format(" at %.17g", *time_s) : "");
}

// What turns a radiance into codes: code = black + full * v, v = gain * radiance through the sensor chain, up to white.
// The chain works on v, what the frame's file says of the light: what a sensor does to its codes depends on the
// exposure.
struct DeskSensor {
  double white = 4095, black = 0, full = 65535, gain = 1;
  manifest::Noise noise;  // of v
};

DeskSensor sensor_at(const manifest::LaboratoryCamera& entry, int bits, const Shot& shot) {
  DeskSensor sensor;
  sensor.white = entry.white.value_or((1 << bits) - 1);
  sensor.black = entry.black_code.value_or(0);
  sensor.full = bits > 8 ? 65535 : 255;
  sensor.gain = entry.codes_per_radiance_s.value_or(sensor.white / saturating_exposure_s) * shot.exposure_s *
                amplification(shot.gain_db) / sensor.full;
  const double electrons =
      entry.electrons_per_code.value_or(full_well_electrons / sensor.white) * sensor.full / amplification(shot.gain_db);
  sensor.noise = {.gain = electrons, .read = entry.read_electrons.value_or(usual_read_electrons) / electrons};
  return sensor;
}

}  // namespace

TrueState::TrueState(const manifest::Document& believed, const manifest::Document* truth, const DeskOptions& wanted,
                     double pace)
    : document(believed), options(wanted), clock(pace), faults(wanted.seed) {
  if (truth != nullptr) take_truth(document, *truth);
  laboratory = believed_laboratory(document);
  chain = chain_of(document);
  const manifest::Laboratory& lab = document.laboratory.entry.front();
  for (const auto& [name, arm] : laboratory.arms) {
    desk::TrueArmSettings settings;
    settings.joints_rad = arm.home;
    for (const robot::JointLimit& limit : arm.limits) {
      settings.lower_rad.push_back(limit.lower_rad);
      settings.upper_rad.push_back(limit.upper_rad);
    }
    settings.tool_pose = [links = arm.links](const desk::JointAngles& joints) {
      const auto pose = robot::flange(links, joints);
      const Vec3 turn = rotation_vector_of(pose.rotation);
      return desk::ToolPose{pose.translation_m.x, pose.translation_m.y, pose.translation_m.z, turn.x, turn.y, turn.z};
    };
    arms[name] = std::make_unique<desk::TrueArm>(settings, clock, faults);
  }
  for (const auto& [name, lamp] : lab.lamps) {
    if (!document.lights.contains(light_of(name, lamp)))
      throw Error(Exit::data, manifest::place(document, "/laboratory/lamps/" + name),
                  "lights no light of the scene: \"" + light_of(name, lamp) + "\"", "enter it in lights");
    std::erase_if(document.lights, [&](const auto& e) { return is_light_at_step(e.first, light_of(name, lamp)); });
    lamp_number.emplace(name, static_cast<int>(lamp_number.size()));
  }
  for (const auto& [name, screen] : lab.screens)  // what frames of earlier runs were lit by
    std::erase_if(document.lights, [&](const auto& e) { return is_light_at_step(e.first, name); });
  for (const auto& [name, table] : lab.turntables)
    tables[name] = std::make_unique<desk::TrueTurntable>(
        clock, table.speed_rad_per_s.value_or(usual_table_speed_rad_per_s),
        table.acceleration_rad_per_s2.value_or(usual_table_acceleration_rad_per_s2));
  for (const auto& [name, camera] : lab.cameras) format_of(name);
}

PixelFormat TrueState::format_of(const std::string& camera) const {
  const std::string& name = section().cameras.at(camera).pixel_format;
  const auto format = parse_pixel_format(name.empty() ? "Mono12" : name);
  if (!format || (format->mosaic != "Mono" && !format->mosaic.starts_with("Bayer")) ||
      format->mosaic.ends_with("Polarized"))
    throw Error(Exit::data, manifest::place(document, "/laboratory/cameras/" + camera + "/pixel_format"),
                "\"" + name + "\" is no format of a simulated camera",
                "Mono or BayerRG, BayerGR, BayerGB, BayerBG with 8 to 16 bits, as Mono12, BayerRG12Packed");
  return *format;
}

Rigid<frame::World, frame::Tool> TrueState::world_from_tool(const std::string& name) const {
  const LaboratoryArm& arm = laboratory.arms.at(name);
  robot::ChainInput input;
  input.links = arm.links;
  robot::ChainInput::View view;
  const desk::ArmSnapshot now = arms.at(name)->now();
  view.joints_rad = now.joints_rad;
  view.base_from_tool = robot::flange(arm.links, view.joints_rad);
  for (std::size_t j = 0; j < std::min(now.approach.size(), view.approach.size()); ++j)
    view.approach[j] = now.approach[j];
  view.warmer_K = desk::warmth_K(now.time_s);
  view.later_s = now.time_s;
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

void TrueState::show(const std::string& name, const std::string& path) {
  const manifest::LaboratoryScreen& screen = section().screens.at(name);
  if (path.empty()) {
    shown.erase(name);
    return;
  }
  const auto light = document.lights.find(name);
  if (light == document.lights.end() || !is_screen(light->second))
    throw Error(Exit::data, manifest::place(document, "/laboratory/screens/" + name),
                "is no light of the scene: it shows nothing but black",
                "enter it in lights, of model screen or projector");
  const io::RasterHeader head = io::read_raster_header(read_file(path), path);
  if (head.width != static_cast<std::uint64_t>(screen.width_px) ||
      head.height != static_cast<std::uint64_t>(screen.height_px))
    throw Error(Exit::data, path,
                format("has %llu x %llu pixels, screen %s has %lld x %lld", static_cast<unsigned long long>(head.width),
                       static_cast<unsigned long long>(head.height), name.c_str(),
                       static_cast<long long>(screen.width_px), static_cast<long long>(screen.height_px)),
                "nothing is scaled: make the picture as large as the screen");
  shown[name] = path;
}

void TrueState::light_screens(manifest::Document& scene) const {
  for (const auto& [name, path] : shown) {
    manifest::File& file = scene.files["screen-" + name];
    file.path = std::filesystem::absolute(path).lexically_relative(std::filesystem::absolute(scene.folder)).string();
    file.sha256 = sha256_of_file(path);
    file.bytes = std::filesystem::file_size(path);
    scene.lights.at(name).file = "screen-" + name;
    scene.allow_outside = true;
  }
}

// Objects on a turntable turn about its z.
void TrueState::turn_objects(manifest::Document& scene) const {
  for (const auto& [name, table] : document.laboratory.entry.front().turntables) {
    const Rigid<frame::World, frame::World> motion = turntable_motion(table, tables.at(name)->angle_rad());
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
  light_screens(scene);
  manifest::ImageEntry image;
  image.camera = camera;
  image.exposure_s = shot.exposure_s;
  image.time_s = clock.now_s();
  image.temperature_K = desk::room_K + desk::warmth_K(*image.time_s);
  for (const auto& [name, table] : lab.turntables)
    image.shapes.merge(deformations(table, tables.at(name)->angle_rad()));
  auto& pose = static_cast<Rigid<frame::World, frame::Camera>&>(image.world_from_camera.emplace());
  if (!entry.robot.empty() && entry.tool_from_camera)
    pose = world_from_tool(entry.robot) * Rigid<frame::Tool, frame::Camera>(*entry.tool_from_camera);
  else if (entry.world_from_camera)
    pose = *entry.world_from_camera;
  std::map<std::string, bool> of_lamps;
  for (const auto& [name, lamp] : lab.lamps) of_lamps[light_of(name, lamp)] |= lamps.lit(lamp_number.at(name));
  for (const auto& [name, screen] : lab.screens) of_lamps[name] = shown.contains(name);
  for (const auto& [name, light] : document.lights)
    if (const auto found = of_lamps.find(name); found == of_lamps.end() || found->second) image.light.push_back(name);
  if (image.light.empty()) image.dark = true;
  const PixelFormat own = format_of(camera);
  const DeskSensor sensor = sensor_at(entry, own.bits, shot);
  image.noise = sensor.noise;
  if (camera::mosaic_of(document, camera).empty() && own.mosaic == "Mono") {
    image.noise->gain /= 3;  // the mean of three readings has the noise of one
    image.noise->read *= std::sqrt(3.0);
  }
  image.gain = manifest::Parameter(sensor.gain);
  image.id = "frame";
  image.id = content_of(scene, image).substr(0, 16);
  scene.images = {image};
  // What drifts with time counts from the beginning of the run.
  scene.images.push_back(image);
  scene.images.back().id = "beginning";
  scene.images.back().time_s = 0;
  return scene;
}

RawFrame TrueState::expose(const std::string& camera, const Shot& asked, const PixelFormat* format) {
  const Shot shot = told(asked);
  const PixelFormat own = format_of(camera);
  manifest::Document scene = scene_of(camera, shot);
  render::SessionOptions how;
  how.seed = options.seed;
  how.spp = options.spp;
  how.geometry = false;
  how.transport.stokes = document.cameras.at(camera).mosaic == "polarizers";
  how.checkpoint_s = std::numeric_limits<double>::infinity();  // a frame is rendered in one go
  const render::Sensor sensor = render::sensor_of(scene, 0);
  const std::string id = scene.images.front().id;
  const double gain = scene.images.front().gain->scalar();
  if (const std::string light = light_content(scene, scene.images.front()); light != rendered_light) {
    scene.images.front().id = light.substr(0, 16);
    scene.images.front().gain = manifest::Parameter(1.0);
    const render::Session session(scene, how, [](const std::filesystem::path&) {});
    rendered = session.render(0, id + ".exr").picture;
    rendered_light = light;
  }
  const manifest::LaboratoryCamera& entry = document.laboratory.entry.front().cameras.at(camera);
  io::Image picture = desk::through_filters(rendered, entry.filters,
                                            manifest::place(document, "/laboratory/cameras/" + camera + "/filters"));
  for (float& v : picture.data) v = static_cast<float>(gain * v);
  const io::Image seen = render::recorded(picture, sensor, id, options.seed);
  RawFrame frame;
  frame.width_px = seen.width;
  frame.height_px = seen.height;
  const DeskSensor chip = sensor_at(entry, own.bits, shot);
  frame.bits = format == nullptr ? own.bits : format->bits;
  frame.pixel_format = format == nullptr ? own.unpacked() : format->unpacked();
  const double deeper = std::ldexp(1.0, frame.bits - own.bits);
  const std::size_t channels = seen.channels.size(), width = static_cast<std::size_t>(seen.width);
  const std::string& mosaic = format == nullptr ? own.mosaic : format->mosaic;
  frame.samples.resize(seen.pixels());
  for (std::size_t i = 0; i < frame.samples.size(); ++i) {
    const int filter = channels < 3 ? -1 : channel_of_filter(mosaic, i / width, i % width);
    double v = 0;
    if (filter >= 0)
      v = seen.data[i * channels + static_cast<std::size_t>(filter)];
    else
      for (std::size_t c = 0; c < channels; ++c) v += seen.data[i * channels + c] / static_cast<double>(channels);
    const double code = std::clamp(std::round(chip.black + chip.full * v), 0.0, chip.white);
    frame.samples[i] = static_cast<std::uint16_t>(std::floor(code * deeper));
  }
  clock.pass(shot.exposure_s);
  frame.frame_id = ++frames[camera];
  frame.chunk_frame_id = frame.frame_id;
  frame.exposure_s = shot.exposure_s;
  frame.gain_db = shot.gain_db;
  frame.temperature_K = desk::room_K + desk::warmth_K(clock.now_s());
  return frame;
}

}  // namespace gonio::acquisition
