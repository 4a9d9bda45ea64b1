// See frame_record.h.
#include "acquisition/run/frame_record.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "acquisition/device/unpack.h"
#include "acquisition/plan/stations.h"
#include "base/hash.h"
#include "base/text.h"
#include "io/codes.h"
#include "io/image.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/file.h"
#include "manifest/sections/image.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/light.h"
#include "manifest/sections/plan.h"
#include "manifest/sections/robot.h"
#include "robot/kinematics.h"

namespace gonio::acquisition {
namespace {

using manifest::Value;

Value numbers_by_name(const State& state) {
  Value out = Value::object();
  for (const auto& [name, joints] : state) out[name] = Value(joints);
  return out;
}

std::vector<double> numbers_in(const Value& v) {
  std::vector<double> out;
  for (const Value& number : v.as_array()) out.push_back(number.as_number());
  return out;
}

std::optional<double> number_in(const Value& event, const char* key) {
  const Value* v = event.find(key);
  return v == nullptr ? std::nullopt : std::optional(v->as_number());
}

std::string text_in(const Value& event, const char* key) {
  const Value* v = event.find(key);
  return v == nullptr ? std::string() : v->as_string();
}

void enter_robots(manifest::Document& d) {
  for (const manifest::Laboratory& lab : d.laboratory.entry)
    for (const auto& [name, robot] : lab.robots) {
      if (d.robots.contains(name) || robot.model == "urdf") continue;
      manifest::Robot entry;
      entry.model = robot.model;
      entry.dh = robot.dh;
      entry.calibration = robot.calibration;
      d.robots[name] = entry;
    }
}

double full_code(const FrameRecord& r) {
  return r.bits > 8 ? 65535 : 255;
}

// From a radiance to what the file says, 0 to 1 for its codes: known of a camera whose sensitivity is known.
manifest::Parameter gain_of(const manifest::LaboratoryCamera& camera, const FrameRecord& r) {
  if (camera.codes_per_radiance_s)
    return *camera.codes_per_radiance_s * r.exposure_s * amplification(r.gain_db) / full_code(r);
  manifest::Parameter gain(1.0);
  gain.free = true;
  return gain;
}

// The scene's world turns with what stands on the turntable: seen from there, cameras and lamps have gone round the
// other way.
Rigid<frame::World, frame::World> seen_from_table(const manifest::Laboratory& lab, const FrameRecord& r) {
  Rigid<frame::World, frame::World> motion{};
  for (const auto& [name, angle] : r.turntables)
    if (const auto table = lab.turntables.find(name); table != lab.turntables.end())
      motion = turntable_motion(table->second, angle) * motion;
  return inverse(motion);
}

bool has_turned(const manifest::Laboratory& lab, const FrameRecord& r) {
  return std::ranges::any_of(r.turntables, [&lab](const auto& table) {
    const auto entry = lab.turntables.find(table.first);
    return table.second != 0 && (entry == lab.turntables.end() || !is_drive(entry->second));
  });
}

// The light that a lamp is in this frame. One that an arm held, or that went round a turntable, is a light of its own
// for every place: the same power, another position. Empty: the scene knows nothing of it.
std::string light_there(manifest::Document& d, const Laboratory& laboratory, const manifest::Laboratory& lab,
                        const std::string& lamp, const FrameRecord& r) {
  const auto named = lab.lamps.find(lamp);
  const bool known = named != lab.lamps.end();
  const std::string light = !known || named->second.light.empty() ? lamp : named->second.light;
  if (!d.lights.contains(light)) return "";
  const bool held = known && !named->second.robot.empty() && !named->second.in_tool_m.empty();
  manifest::Light there = d.lights.at(light);
  const auto position = there.parameters.find("position_m"), towards = there.parameters.find("towards");
  const bool placed = position != there.parameters.end();
  if (!(held && placed) && !(has_turned(lab, r) && (placed || towards != there.parameters.end()))) return light;
  const Rigid<frame::World, frame::World> seen = seen_from_table(lab, r);
  const auto put = [](manifest::Parameter& parameter, Vec3 v) { parameter.value = {v.x, v.y, v.z}; };
  if (placed)
    put(position->second, seen * (held ? lamp_position(d, laboratory, lamp, r.joints) : position->second.vector()));
  if (towards != there.parameters.end()) put(towards->second, seen.rotate(towards->second.vector()));
  for (auto& [name, parameter] : there.parameters)
    if (name != "position_m" && name != "towards" && parameter.share.empty()) parameter.share = light + "." + name;
  const std::string id = light_at_step(light, r.group);
  d.lights[id] = there;
  return id;
}

// A screen's light is one of its own for every step: the same screen, another picture.
std::string light_of_screen(manifest::Document& d, const std::string& screen, const std::string& picture,
                            const std::string& step) {
  const auto light = d.lights.find(screen);
  if (picture.empty() || light == d.lights.end() || !is_screen(light->second)) return "";
  manifest::Light there = light->second;
  there.file = picture;
  const std::string id = light_at_step(screen, step);
  d.lights[id] = there;
  return id;
}

// A sensor's own numbers, above what it reads in the dark.
Value response_of(const manifest::LaboratoryCamera& camera, const FrameRecord& r) {
  const double black = camera.black_code.value_or(0) / full_code(r);
  if (black == 0) return "linear";
  Value table = Value::array();
  table.push_back(Value(std::vector<double>{0, -black}));
  table.push_back(Value(std::vector<double>{1, 1 - black}));
  return table;
}

// Frames behind a Bayer grid are no pictures: what reads them has to know of the grid.
void state_mosaic(manifest::Document& d, const manifest::Laboratory& lab, const std::string& name) {
  const auto device = lab.cameras.find(name);
  const auto camera = d.cameras.find(name);
  if (device == lab.cameras.end() || camera == d.cameras.end() || !camera->second.mosaic.empty()) return;
  if (const auto format = parse_pixel_format(device->second.pixel_format))
    camera->second.mosaic = bayer_corner(format->mosaic);
}

// In the unit of the linear values, code / full: shot noise, and read noise with that of rounding (1 / 12 code^2).
std::optional<manifest::Noise> noise_of(const manifest::LaboratoryCamera& camera, const FrameRecord& r) {
  if (!camera.electrons_per_code) return std::nullopt;
  const double per_code = *camera.electrons_per_code / amplification(r.gain_db), full = full_code(r);
  const double read = camera.read_electrons.value_or(0) / per_code;
  return manifest::Noise{.gain = full * per_code, .read = std::sqrt(read * read + 1.0 / 12) / full};
}

}  // namespace

double amplification(std::optional<double> gain_db) {
  return std::pow(10.0, gain_db.value_or(0) / 20);
}

std::string light_at_step(const std::string& light, const std::string& step) {
  return light + "@" + step;
}

bool is_light_at_step(const std::string& id, const std::string& light) {
  return id.starts_with(light + "@");
}

std::vector<std::string> images_of(const manifest::PlanStep& step) {
  if (step.exposures_s.size() < 2) return {step.image};
  std::vector<std::string> ids;
  for (std::size_t k = 0; k < step.exposures_s.size(); ++k) ids.push_back(step.image + "-" + std::to_string(k + 1));
  return ids;
}

std::filesystem::path write_frame_file(const std::filesystem::path& out, const RawFrame& frame, FrameRecord& record) {
  record.file = "frames/" + file_stem(record.image) + ".png";
  const std::filesystem::path path = out / record.file;
  const int code_bits = frame.bits > 8 ? 16 : 8;
  io::Image picture(frame.width_px, frame.height_px, {"Y"});
  const auto full = static_cast<float>((1 << code_bits) - 1);
  for (std::size_t i = 0; i < frame.samples.size(); ++i) picture.data[i] = static_cast<float>(frame.samples[i]) / full;
  io::write_png(path, picture, code_bits);
  record.bytes = std::filesystem::file_size(path);
  record.sha256 = sha256_of_file(path);
  return path;
}

bool file_stands(const std::filesystem::path& out, const FrameRecord& record) {
  std::error_code error;
  const std::filesystem::path path = out / record.file;
  return std::filesystem::file_size(path, error) == record.bytes && !error && sha256_of_file(path) == record.sha256;
}

Value to_event(const FrameRecord& r) {
  Value e = Value::object({{"what", "frame"},
                           {"image", r.image},
                           {"group", r.group},
                           {"camera", r.camera},
                           {"file", r.file},
                           {"sha256", r.sha256},
                           {"bytes", r.bytes},
                           {"lamps", r.lamps},
                           {"exposure_s", r.exposure_s},
                           {"time_s", r.time_s},
                           {"robot", r.robot},
                           {"joints_rad", numbers_by_name(r.joints)},
                           {"frame_id", r.frame_id},
                           {"saturated_share", r.figures.saturated_share},
                           {"mean_code", r.figures.mean_code},
                           {"bright_code", r.figures.bright_code},
                           {"noise", r.figures.noise},
                           {"focus", r.figures.focus},
                           {"tries", r.tries},
                           {"bits", r.bits}});
  if (r.gain_db) e["gain_db"] = *r.gain_db;
  if (r.temperature_K) e["temperature_K"] = *r.temperature_K;
  if (!r.turntables.empty()) {
    Value tables = Value::object();
    for (const auto& [name, angle] : r.turntables) tables[name] = angle;
    e["turntable_rad"] = tables;
  }
  return e;
}

FrameRecord frame_of(const Value& e) {
  FrameRecord r;
  r.image = text_in(e, "image");
  r.group = text_in(e, "group");
  r.camera = text_in(e, "camera");
  r.file = text_in(e, "file");
  r.sha256 = text_in(e, "sha256");
  r.robot = text_in(e, "robot");
  r.bytes = static_cast<std::uint64_t>(number_in(e, "bytes").value_or(0));
  if (const Value* lamps = e.find("lamps"))
    for (const Value& lamp : lamps->as_array()) r.lamps.push_back(lamp.as_string());
  r.exposure_s = number_in(e, "exposure_s").value_or(0);
  r.gain_db = number_in(e, "gain_db");
  r.temperature_K = number_in(e, "temperature_K");
  r.time_s = number_in(e, "time_s").value_or(0);
  if (const Value* joints = e.find("joints_rad"))
    for (const auto& [name, angles] : joints->as_object()) r.joints[name] = numbers_in(angles);
  if (const Value* tables = e.find("turntable_rad"))
    for (const auto& [name, angle] : tables->as_object()) r.turntables[name] = angle.as_number();
  r.frame_id = static_cast<std::uint64_t>(number_in(e, "frame_id").value_or(0));
  r.figures = {number_in(e, "saturated_share").value_or(0), number_in(e, "mean_code").value_or(0),
               number_in(e, "bright_code").value_or(0), number_in(e, "noise").value_or(0),
               number_in(e, "focus").value_or(0)};
  r.bits = static_cast<int>(number_in(e, "bits").value_or(16));
  r.tries = static_cast<int>(number_in(e, "tries").value_or(1));
  return r;
}

std::string words_of(const FrameRecord& r) {
  std::string out = r.image + format(": %.4g ms, mean code %.0f", 1e3 * r.exposure_s, r.figures.mean_code);
  if (r.figures.saturated_share > 0) out += format(", %.2g %% saturated", 100 * r.figures.saturated_share);
  if (r.tries > 1) out += format(", %d tries", r.tries);
  return out;
}

namespace {

// Poses that were measured in the plan's joints, by place: of the step itself, or of another take of its view.
class MeasuredPlaces {
 public:
  explicit MeasuredPlaces(const manifest::Plan& plan) : plan_(plan) {
    for (const manifest::MeasuredView& view : plan.measured)
      if (const auto step = std::ranges::find(plan.steps, view.image, &manifest::PlanStep::image);
          step != plan.steps.end() && view.world_from_camera)
        by_place_.emplace(place_key(*step), &view);
  }
  const manifest::MeasuredView* at(const manifest::PlanStep& step) const {
    const auto own = std::ranges::find(plan_.measured, step.image, &manifest::MeasuredView::image);
    if (own != plan_.measured.end() && own->world_from_camera) return &*own;
    const auto other = by_place_.find(place_key(step));
    return other == by_place_.end() ? nullptr : other->second;
  }

 private:
  const manifest::Plan& plan_;
  std::map<std::string, const manifest::MeasuredView*> by_place_;
};

}  // namespace

std::int64_t enter_frames(manifest::Document& d, const Laboratory& laboratory, const manifest::Plan& plan,
                          const std::map<std::string, FrameRecord>& records, const std::filesystem::path& folder) {
  enter_robots(d);
  const manifest::Laboratory lab = d.laboratory.entry.empty() ? manifest::Laboratory{} : d.laboratory.entry.front();
  const MeasuredPlaces places(plan);
  std::int64_t measured = 0;
  for (const manifest::PlanStep& step : plan.steps)
    for (const std::string& id : images_of(step)) {
      const auto found = records.find(id);
      if (found == records.end()) continue;
      const FrameRecord& r = found->second;
      manifest::ImageEntry image;
      image.id = r.image;
      image.file = manifest::add_file(d, folder / r.file, r.image);
      image.exposure_s = r.exposure_s;
      image.time_s = r.time_s;
      image.temperature_K = r.temperature_K;
      image.group = step.group.empty() ? r.group : step.group;
      image.projection = step.projection, image.shows = step.shows;
      image.response = "linear";  // a sensor's own numbers
      if (d.cameras.contains(r.camera)) image.camera = r.camera;
      state_mosaic(d, lab, r.camera);
      for (const std::string& lamp : r.lamps) {
        const std::string light = light_there(d, laboratory, lab, lamp, r);
        if (!light.empty()) image.light.push_back(light);
      }
      if (const auto camera = lab.cameras.find(r.camera); camera != lab.cameras.end()) {
        image.gain = gain_of(camera->second, r);
        if (camera->second.white) image.saturation = (*camera->second.white - 0.5) / full_code(r);
        image.response = response_of(camera->second, r);
        image.noise = noise_of(camera->second, r);
      }
      for (const auto& [screen, picture] : step.screens)
        if (const std::string light = light_of_screen(d, screen, picture, r.group); !light.empty())
          image.light.push_back(light);
      if (r.lamps.empty() && !lab.lamps.empty() && image.light.empty()) image.dark = true;
      for (const auto& [name, angle] : r.turntables)
        if (const auto table = lab.turntables.find(name); table != lab.turntables.end())
          image.shapes.merge(deformations(table->second, angle));
      if (const auto* view = places.at(step); view != nullptr)
        image.world_from_camera = view->world_from_camera, ++measured;
      else if (const auto camera = lab.cameras.find(r.camera); camera != lab.cameras.end())
        if (tool_from_camera(d, r.camera) || camera->second.world_from_camera)
          static_cast<Rigid<frame::World, frame::Camera>&>(image.world_from_camera.emplace()) =
              seen_from_table(lab, r) * world_from_camera(d, laboratory, r.camera, r.joints);
      if (const auto arm = laboratory.arms.find(r.robot); arm != laboratory.arms.end() && d.robots.contains(r.robot)) {
        image.robot = r.robot;
        image.joints_rad = r.joints.at(r.robot);
        static_cast<Rigid<frame::Base, frame::Tool>&>(image.base_from_tool.emplace()) =
            robot::flange(arm->second.links, image.joints_rad);
      }
      const auto there = std::ranges::find(d.images, image.id, &manifest::ImageEntry::id);
      if (there != d.images.end())
        *there = image;
      else
        d.images.push_back(image);
    }
  return measured;
}

}  // namespace gonio::acquisition
