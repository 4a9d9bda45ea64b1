// See alignment_input.h.
#include "alignment/alignment_input.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "alignment/edge_spread.h"
#include "alignment/mask_regions.h"
#include "base/error.h"
#include "base/text.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/alignment.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "photograph/linear_picture.h"
#include "scene/amounts.h"
#include "scene/deformed.h"
#include "scene/mechanisms/bend.h"

namespace gonio::mechanism {
const Mechanism& geometry_bend();
const Mechanism& geometry_shrinkage();
}  // namespace gonio::mechanism

namespace gonio::alignment {
namespace {

using manifest::Document;

std::string at(const Document& d, const std::string& section, std::size_t i, const std::string& key = "") {
  return manifest::place(d, "/" + section + "/" + std::to_string(i) + (key.empty() ? "" : "/" + key));
}

std::size_t object_index(const Document& d, const std::string& id) {
  for (std::size_t i = 0; i < d.objects.size(); ++i)
    if (d.objects[i].id == id) return i;
  throw Error(Exit::usage, "--object", "names \"" + id + "\", which is not in objects");
}

Rigid<frame::World, frame::Object> pose_of(const manifest::Object& object) {
  return object.world_from_object ? Rigid<frame::World, frame::Object>(*object.world_from_object)
                                  : Rigid<frame::World, frame::Object>{};
}

void read_body(const Document& d, const std::string& id, AlignmentInput& in, const NoteFile& note) {
  const std::size_t i = object_index(d, id);
  const manifest::Mesh& mesh = d.meshes.at(d.objects[i].mesh);
  if (mesh.file.empty())
    throw Error(Exit::data, at(d, "objects", i, "mesh"), "is no mesh from a file",
                "spheres and planes have no rims to align");
  io::TriangleMesh raw = scene::deformed_mesh(d, d.objects[i].mesh, scene::deformation_of(d, id, ""), {}, note);
  in.shapes.emplace_back(raw.positions_m, raw.triangles);
  if (const auto curl = scene::amounts_on(d, mechanism::geometry_bend(), id)) {
    const Vec3 middle = in.shapes.back().centre_m();
    for (Vec3& p : raw.positions_m) p = equation::bent(p, middle, *curl);
    in.shapes.back() = Shape(raw.positions_m, raw.triangles);
  }
  if (in.shapes.back().triangles() == 0)
    throw Error(Exit::data, manifest::place(d, "/meshes/" + d.objects[i].mesh), "has no triangle with an area");
  Vec3 scale{1, 1, 1};
  if (const auto shrink = scene::amounts_on(d, mechanism::geometry_shrinkage(), id))
    scale = scale - Vec3{(*shrink)[0], (*shrink)[1], (*shrink)[2]};
  in.stated.bodies.push_back({&in.shapes.back(), pose_of(d.objects[i]), scale});
  in.bodies.push_back(id);
}

void read_ground(const Document& d, AlignmentInput& in) {
  for (std::size_t i = 0; i < d.objects.size(); ++i) {
    const manifest::Object& object = d.objects[i];
    if (object.mesh.empty() || !d.meshes.at(object.mesh).plane_size_m) continue;
    if (in.stated.ground)
      throw Error(Exit::data, at(d, "objects", i), "is a second plane beside " + in.ground,
                  "leave one: the ground that shadows fall on");
    const auto pose = pose_of(object);
    const Vec3 normal = pose.rotate({0, 0, 1});
    in.stated.ground = Ground{normal, dot(normal, pose.translation_m)};
    in.ground = object.id, in.world_from_ground = pose;
  }
}

std::size_t lens_of(const Document& d, std::size_t image, AlignmentInput& in) {
  const std::string& name = d.images[image].camera;
  if (name.empty())
    throw Error(Exit::data, at(d, "images", image, "camera"), "is missing", "rims need a calibrated camera");
  const auto known = std::find(in.cameras.begin(), in.cameras.end(), name);
  if (known != in.cameras.end()) return static_cast<std::size_t>(known - in.cameras.begin());
  const std::string place = manifest::place(d, "/cameras/" + name);
  const camera::CameraModel model(d.cameras.at(name), place);
  if (model.orthographic()) throw Error(Exit::data, place, "is orthographic", "align takes perspective cameras");
  const camera::Intrinsics& lens = model.intrinsics();
  in.models.push_back(model), in.cameras.push_back(name);
  in.stated.lenses.push_back({lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px});
  return in.cameras.size() - 1;
}

std::size_t station_of(const Document& d, std::size_t image, AlignmentInput& in) {
  const manifest::ImageEntry& entry = d.images[image];
  Station station;
  station.lens = lens_of(d, image, in);
  if (entry.world_from_camera) station.world_from_camera = *entry.world_from_camera;
  for (std::size_t s = 0; s < in.stated.stations.size(); ++s)
    if (in.stated.stations[s].lens == station.lens &&
        in.stated.stations[s].world_from_camera == station.world_from_camera) {
      auto& images = in.images_of_station[s];
      if (std::find(images.begin(), images.end(), entry.id) == images.end()) images.push_back(entry.id);
      return s;
    }
  in.stated.stations.push_back(station);
  in.images_of_station.push_back({entry.id});
  return in.stated.stations.size() - 1;
}

// The number that `lamp`, which a tool carries, has at the image's pose; nothing: it is the first image there. `place`:
// what to remember of it then.
std::optional<std::size_t> carried_lamp(const Document& d, const std::string& lamp, std::size_t image,
                                        AlignmentInput& in, CarriedPlace& place) {
  const manifest::ImageEntry& entry = d.images[image];
  if (!entry.base_from_tool)
    throw Error(Exit::data, at(d, "images", image, "base_from_tool"), "is missing, and a tool carries \"" + lamp + "\"",
                "give the robot's pose of every photograph under that lamp");
  for (auto& [number, known] : in.carried)
    if (in.lamps[number] == lamp && known.robot == entry.robot &&
        static_cast<const Rigid<frame::Base, frame::Tool>&>(known.base_from_tool) == *entry.base_from_tool) {
      if (std::find(known.images.begin(), known.images.end(), entry.id) == known.images.end())
        known.images.push_back(entry.id);
      return number;
    }
  place = {entry.robot, *entry.base_from_tool, {entry.id}};
  return {};
}

std::size_t lamp_of(const Document& d, std::size_t outline, std::size_t image, const InputWish& wish,
                    AlignmentInput& in) {
  std::string name = d.outlines[outline].light;
  const auto& on = d.images[image].light;
  if (name.empty() && on.size() == 1) name = on[0];
  if (name.empty())
    throw Error(Exit::data, at(d, "outlines", outline, "light"), "is missing", "say which lamp throws this shadow");
  CarriedPlace carried;
  if (wish.carried.contains(name)) {
    if (const auto number = carried_lamp(d, name, image, in, carried)) return *number;
    in.carried[in.lamps.size()] = carried;
  } else {
    const auto known = std::find(in.lamps.begin(), in.lamps.end(), name);
    if (known != in.lamps.end()) return static_cast<std::size_t>(known - in.lamps.begin());
  }
  const manifest::Light& light = d.lights.at(name);
  const auto position = light.parameters.find("position_m");
  const bool given = position != light.parameters.end() && position->second.value.size() == 3;
  if (!given && light.model != "point" && light.model != "sphere")
    throw Error(Exit::data, manifest::place(d, "/lights/" + name), "has no position: a " + light.model,
                "shadows place lamps that are like points");
  Vec3 place = given ? position->second.vector() : Vec3{};
  if (!given) {
    const Body& body = in.stated.bodies.front();
    place = body.centre_m() + in.stated.ground->normal * (6 * body.shape->radius_m());
  } else if (!(in.stated.ground->height_m(place) > 0)) {
    throw Error(Exit::data, manifest::place(d, "/lights/" + name + "/position_m"),
                format("lies %.3g m below the ground \"%s\"", -in.stated.ground->height_m(place), in.ground.c_str()),
                "a lamp throws shadows from above; or turn the ground's normal up");
  }
  in.lamps.push_back(name), in.lamp_stated.push_back(given), in.stated.lamps_m.push_back(place);
  return in.lamps.size() - 1;
}

void add_freedoms(const InputWish& wish, AlignmentInput& in) {
  auto& f = in.question.freedoms;
  for (std::size_t b = 0; b < in.bodies.size(); ++b) {
    if (!wish.held.contains("pose")) f.push_back({Block::body_turn, b}), f.push_back({Block::body_shift, b});
    if (wish.freed.contains("scale"))
      f.push_back({Block::body_scale, b, wish.scale_sigma, false});
    else if (wish.freed.contains("size"))
      f.push_back({Block::body_scale, b, wish.scale_sigma, true});
    if (in.stated.ground && wish.contact_m > 0) in.question.contacts.push_back({b, wish.contact_m});
  }
  if (!wish.held.contains("light"))
    for (std::size_t l = 0; l < in.lamps.size(); ++l) f.push_back({Block::lamp_shift, l});
  // Where the object moves as well, the first camera carries the world: both together would be moved by nothing seen.
  const std::size_t first = wish.held.contains("pose") ? 0 : 1;
  if (wish.freed.contains("camera") && in.stated.stations.size() <= first)
    throw Error(Exit::usage, "--free camera", "has one place of one camera, and the object moves as well",
                "--hold pose: the object stays as it is stated, and the camera is found");
  if (wish.freed.contains("camera"))
    for (std::size_t s = first; s < in.stated.stations.size(); ++s)
      f.push_back({Block::station_turn, s}), f.push_back({Block::station_shift, s});
  if (wish.freed.contains("focal"))
    for (std::size_t l = 0; l < in.cameras.size(); ++l) f.push_back({Block::lens_focal, l, 0.05});
  if (wish.freed.contains("ground") && in.stated.ground)
    f.push_back({Block::ground_tilt, 0, 0.05}), f.push_back({Block::ground_shift, 0, 0.01});
}

// A mesh in millimetres, or a camera in centimetres: no fit says that as plainly. Only of poses that somebody stated.
void check_sizes(const Document& d, const AlignmentInput& in) {
  for (std::size_t b = 0; b < in.bodies.size(); ++b)
    for (const Station& s : in.stated.stations) {
      const manifest::Object& object = d.objects[object_index(d, in.bodies[b])];
      if (!object.world_from_object) continue;
      const double distance = norm(s.world_from_camera.translation_m - in.stated.bodies[b].centre_m());
      const double size = 2 * in.stated.bodies[b].shape->radius_m();
      if (size < 1.2 * distance && size > 1e-3 * distance) continue;
      throw Error(Exit::data, manifest::place(d, "/meshes/" + object.mesh),
                  format("is %.3g m across, and a camera stands %.3g m away", size, distance),
                  "state both in metres: a mesh in millimetres is a thousand times too large");
    }
}

}  // namespace

std::string AlignmentInput::lamp_words(std::size_t lamp) const {
  const auto place = carried.find(lamp);
  return lamps[lamp] + (place == carried.end() ? "" : " at " + place->second.images.front());
}
Vec2 AlignmentInput::straight(std::size_t lens, Vec2 pixel) const {
  const Vec3 ray = models[lens].ray(pixel).direction;
  const camera::Intrinsics& l = models[lens].intrinsics();
  return {l.cx_px + l.fx_px * ray.x / ray.z, l.cy_px + l.fy_px * ray.y / ray.z};
}
Vec2 AlignmentInput::bent(std::size_t lens, Vec2 straight) const {
  const camera::Intrinsics& l = models[lens].intrinsics();
  const auto pixel = models[lens].project({(straight.x - l.cx_px) / l.fx_px, (straight.y - l.cy_px) / l.fy_px, 1});
  return pixel ? *pixel : Vec2{-1e6, -1e6};
}

void move_images(Document& document, const std::vector<std::string>& images,
                 const manifest::Pose<frame::World, frame::Camera>& pose) {
  for (const std::string& id : images)
    document.images[*manifest::index_of_image(document, id)].world_from_camera = pose;
}

namespace {

// Of images whose light is told: an 8-bit picture without a response is good enough to have been masked.
std::optional<Luminance> luminance_of(const Document& d, std::size_t image, const NoteFile& note) {
  const manifest::ImageEntry& entry = d.images[image];
  if (entry.file.empty()) return {};
  const auto path = manifest::picture_path(d, image);
  if (entry.response.is_null() && path.extension() != ".exr") return {};
  if (!std::filesystem::exists(path)) return {};
  if (note) note(path);
  return Luminance(photograph::read_linear(path, entry.response, at(d, "images", image), entry.saturation).colour);
}

}  // namespace

AlignmentInput read_alignment(const Document& document, const InputWish& wish, const NoteFile& note) {
  if (document.outlines.empty())
    throw Error(Exit::data, manifest::place(document, "/outlines"), "are missing",
                "give masks of the object and of its shadow");
  AlignmentInput in;
  std::vector<std::string> objects = wish.objects;
  if (objects.empty())
    for (const manifest::Outline& o : document.outlines)
      if (std::find(objects.begin(), objects.end(), o.object) == objects.end()) objects.push_back(o.object);
  for (const std::string& id : objects) read_body(document, id, in, note);
  read_ground(document, in);
  std::map<std::string, std::shared_ptr<const MaskRegions>> regions;  // by image
  for (std::size_t i = 0; i < document.outlines.size(); ++i) {
    const manifest::Outline& o = document.outlines[i];
    const auto body = std::find(in.bodies.begin(), in.bodies.end(), o.object);
    if (body == in.bodies.end()) continue;
    const bool shadow = o.kind == "shadow";
    if (shadow && !in.stated.ground)
      throw Error(Exit::data, at(document, "outlines", i), "is of a shadow, and there is no ground",
                  "add an object whose mesh is a plane, normal upwards");
    const std::size_t image = *manifest::index_of_image(document, o.image);
    const std::size_t station = station_of(document, image, in);
    RimSubject subject{station, static_cast<std::size_t>(body - in.bodies.begin()), {}};
    if (shadow) subject.lamp = lamp_of(document, i, image, wish, in);
    auto& known = regions[o.image];
    if (!known) known = std::make_shared<const MaskRegions>(read_regions(document, o.image, note));
    SeenRim rim{i, o.image, known->smoothed_by(i, wish.smooth_px),
                known->rim(i, wish.smooth_px, !shadow && wish.any_start)};
    Sighting sighting{subject, rim.in_picture, {}};
    const std::size_t lens = in.stated.stations[station].lens;
    straighten(sighting.points, [&](Vec2 p) { return in.straight(lens, p); });
    const camera::CameraModel model = in.models[lens];
    const camera::Intrinsics l = model.intrinsics();
    sighting.unseen = [known, model, l, i](Vec2 straight) {
      const auto p = model.project({(straight.x - l.cx_px) / l.fx_px, (straight.y - l.cy_px) / l.fy_px, 1});
      return !p || known->hides(i, *p);
    };
    if (shadow && wish.penumbrae)
      if (const auto picture = luminance_of(document, image, note))
        rim.spread_px = edge_spreads(*picture, rim.in_picture, [&](Vec2 pixel) { return known->hides(i, pixel); });
    in.question.sightings.push_back(std::move(sighting)), in.rims.push_back(std::move(rim));
  }
  for (std::size_t b = 0; b < in.bodies.size(); ++b) {
    const bool seen = std::any_of(in.question.sightings.begin(), in.question.sightings.end(),
                                  [&](const Sighting& s) { return s.subject.body == b && !s.subject.lamp; });
    if (!seen)
      throw Error(Exit::data, manifest::place(document, "/outlines"), "show no rim of \"" + in.bodies[b] + "\" itself",
                  "give a mask of kind \"object\"; a shadow alone does not say where it stands");
  }
  for (const std::string& name : wish.carried)
    if (std::find(in.lamps.begin(), in.lamps.end(), name) == in.lamps.end())
      throw Error(Exit::usage, "--carried", "names \"" + name + "\", which throws no shadow that outlines show");
  check_sizes(document, in);
  add_freedoms(wish, in);
  if (in.question.freedoms.empty()) throw Error(Exit::usage, "--hold", "leaves nothing to find");
  in.question.stated = in.stated;
  return in;
}

}  // namespace gonio::alignment
