// Measurements that could be taken next with the same set-up: another exposure, which parts what adds to a reading from
// what adds to the light; the lamps off, which leaves what is there without them; the lamp elsewhere, which moves gloss
// and shadows and leaves what belongs to the camera or the surface where it is. A new exposure is the image's gain
// times a factor; its own gain is free where the image's is. Lamps turn as far as shadows are known
// (relighting/lamp_shadows.h).
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "explain/images/images_problem.h"
#include "geom/angle.h"
#include "geom/rigid.h"

namespace gonio::explain::images {
namespace {

constexpr std::size_t most_images = 3;  // of different views or lights nothing new is to be learned from more
constexpr std::size_t most_turned = 2;  // of these, with one lamp each
constexpr double turn_deg = 12;

struct Change {
  std::size_t image = 0;
  double exposure = 1;  // factor
  bool dark = false;    // lamps off
  double turn_rad = 0;  // of the only lamp, about the scene's centre and the camera's upright
};
std::vector<Change> changes_of(const Recordings& recordings) {
  std::vector<Change> all;
  const std::size_t images = std::min(most_images, recordings.images.size());
  for (std::size_t g = 0; g < images; ++g) all.insert(all.end(), {{g, 4}, {g, 0.25}, {g, 1, true}});
  std::vector<std::size_t> turned;
  for (std::size_t g = 0; g < images && turned.size() < most_turned; ++g) {
    const std::vector<std::size_t>& lights = recordings.images[g].lights;
    if (lights.size() != 1 || std::ranges::find(turned, lights[0]) != turned.end()) continue;
    turned.push_back(lights[0]);
    for (const double side : {1.0, -1.0}) all.push_back({g, 1, false, side * turn_deg * degree});
  }
  return all;
}

// From the scene's centre to a lamp: unit for a directional one.
Vec3 arm_of(const LightSource& lamp, Vec3 centre_m) {
  return lamp.directional ? lamp.direction : lamp.position_m - centre_m;
}
Vec3 turned_about_upright(Vec3 arm, const View& view, double angle_rad) {
  const Vec3 up = view.world_from_camera.rotate({0, -1, 0});
  return matrix_of(quaternion_of_rotation_vector(up * angle_rad)) * arm;
}
// The lamp's state with its arm turned from where it is.
LightState turned(const LightSource& given, LightState now, Vec3 centre_m, const View& view, double angle_rad) {
  const Vec3 arm = arm_of(moved(given, now, centre_m), centre_m), there = turned_about_upright(arm, view, angle_rad);
  if (!given.directional) {
    now.shift_m = now.shift_m + there - arm;
    return now;
  }
  const Vec3 axis = cross(given.direction, there);
  const double sine = norm(axis), angle = std::atan2(sine, dot(given.direction, there));
  const Basis basis(given.direction);
  now.tilt_x_rad = sine > 0 ? angle * dot(axis, basis.t) / sine : 0;
  now.tilt_y_rad = sine > 0 ? angle * dot(axis, basis.b) / sine : 0;
  return now;
}

// A directional lamp is drawn at the camera's distance.
report::FloorPlan floor_plan_of(const View& view, const std::string& lamp, bool directional, Vec3 from, Vec3 to,
                                Vec3 centre_m) {
  const auto camera_from_world = inverse(view.world_from_camera);
  const double distance = directional ? norm(camera_from_world * centre_m) : 1;
  const auto place = [&](const std::string& name, Vec3 arm) {
    const Vec3 there = camera_from_world * (centre_m + arm * distance);
    return report::FloorPlan::Place{name, there.x, there.z};
  };
  return {.title = lamp + " elsewhere, seen from above",
          .camera = {view.camera},
          .centre = place("the scene", {}),
          .from = place(lamp + " today", from),
          .to = place(lamp + " then", to)};
}

// As one who stands behind the camera says it.
std::string side_of(const View& view, Vec3 from, Vec3 to) {
  const Vec3 d = inverse(view.world_from_camera).rotate(to - from);
  if (std::abs(d.x) >= std::abs(d.z)) return d.x < 0 ? "further left" : "further right";
  return d.z < 0 ? "towards the camera" : "away from the camera";
}

}  // namespace

std::vector<Proposal> ImagesProblem::proposals() const {
  std::vector<Proposal> all;
  for (const Change& change : changes_of(recordings_)) {
    const Recording& image = recordings_.images[change.image];
    manifest::Value setup = manifest::Value::object();
    setup["image"] = image.id;
    const std::string again = "image " + image.id + " again ";
    if (change.turn_rad != 0) {
      const View& view = recordings_.views[image.view];
      const LightSource& lamp = layout_.lights[image.lights[0]];
      const std::string& name = recordings_.lights[image.lights[0]];
      const Vec3 from = arm_of(lamp, layout_.centre_m), to = turned_about_upright(from, view, change.turn_rad),
                 towards = normalized(to);
      setup["light"] = manifest::Value::Array{name};
      setup["light_towards"] = manifest::Value::Array{towards.x, towards.y, towards.z};
      if (const Vec3 there = layout_.centre_m + to; !lamp.directional)
        setup["light_position_m"] = manifest::Value::Array{there.x, there.y, there.z};
      all.push_back({again + "with " + name + format(" %.0f degrees ", turn_deg) + side_of(view, from, to), setup,
                     floor_plan_of(view, name, lamp.directional, from, to, layout_.centre_m)});
    } else if (change.dark) {
      setup["light"] = manifest::Value::array();
      all.push_back({again + "with the lamps off", setup});
    } else {
      if (image.exposure_s)
        setup["exposure_s"] = *image.exposure_s * change.exposure;
      else
        setup["exposure_scale"] = change.exposure;
      all.push_back({again + "at " + (change.exposure > 1 ? "four times" : "a quarter of") + " its exposure", setup});
    }
  }
  return all;
}

ProposedRows ImagesProblem::propose(std::span<const double> values, std::size_t proposal) const {
  const Change change = changes_of(recordings_)[proposal];
  const std::size_t g = change.image;
  const Recording& image = recordings_.images[g];
  SceneState raw = raw_state(values);
  raw.gain[g] *= change.exposure;
  if (change.dark)
    for (LightState& light : raw.lights) light.intensity = {};
  if (change.turn_rad != 0) {
    LightState& light = raw.lights[image.lights[0]];
    light = turned(layout_.lights[image.lights[0]], light, layout_.centre_m, recordings_.views[image.view],
                   change.turn_rad);
  }
  ProposedRows rows;
  rows.prediction.resize(3 * picked_[g].size());
  model_->predict(raw, g, picked_[g], rows.prediction);
  for (const double v : rows.prediction) rows.sigma.push_back(noise_sigma(image, v));
  if (image.gain.free) {
    SceneState above = raw;
    above.gain[g] *= 1 + 1e-4;
    std::vector<double> there(rows.prediction.size());
    model_->predict(above, g, picked_[g], there);
    for (std::size_t i = 0; i < there.size(); ++i) there[i] = (there[i] - rows.prediction[i]) * 1e4;
    rows.nuisance.push_back(std::move(there));
  }
  return rows;
}

}  // namespace gonio::explain::images
