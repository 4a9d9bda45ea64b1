// See alignment_entry.h.
#include "alignment/alignment_entry.h"

#include <algorithm>
#include <cmath>

#include "alignment/lamp_size.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/pose_sigma.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/light.h"
#include "manifest/sections/light_position.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/object.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& geometry_shrinkage();
}

namespace gonio::alignment {
namespace {

using Eigen::Index;

std::vector<double> numbers(Vec3 v) {
  return {v.x, v.y, v.z};
}

// Where the numbers of a block begin; -1: it is held.
Index place_of(const std::vector<Freedom>& freedoms, Block block, std::size_t which) {
  Index at = 0;
  for (const Freedom& f : freedoms) {
    if (f.block == block && f.which == which) return at;
    at += static_cast<Index>(f.size());
  }
  return -1;
}
double sigma_at(const Fitted& f, Index at) {
  return std::sqrt(std::max(0.0, f.covariance(at, at)));
}
std::vector<double> sigmas(const Fitted& f, Index at) {
  return at < 0 ? std::vector<double>{0, 0, 0}
                : std::vector<double>{sigma_at(f, at), sigma_at(f, at + 1), sigma_at(f, at + 2)};
}
// Of one block of three numbers, 3 x 3, row by row.
std::vector<double> covariance_of(const Fitted& f, Index at) {
  std::vector<double> out;
  for (Index i = 0; i < 3; ++i)
    for (Index k = 0; k < 3; ++k) out.push_back(f.covariance(at + i, at + k));
  return out;
}
// Of two blocks of three numbers, 6 x 6, row by row; zeros for what is held.
std::vector<double> joint(const Fitted& f, Index first, Index second) {
  std::vector<double> out(36, 0);
  for (Index i = 0; i < 6; ++i)
    for (Index k = 0; k < 6; ++k) {
      const Index a = i < 3 ? first : second, b = k < 3 ? first : second;
      if (a >= 0 && b >= 0) out[static_cast<std::size_t>(6 * i + k)] = f.covariance(a + i % 3, b + k % 3);
    }
  return out;
}

manifest::Pose<frame::World, frame::Object> pose_of(const Body& body) {
  manifest::Pose<frame::World, frame::Object> pose;
  pose.rotation = body.world_from_object.rotation, pose.translation_m = body.world_from_object.translation_m;
  return pose;
}

bool scaled(const std::vector<Freedom>& freedoms, std::size_t body, bool& uniform) {
  for (const Freedom& f : freedoms)
    if (f.block == Block::body_scale && f.which == body) return uniform = f.uniform, true;
  return false;
}

manifest::AlignedLight light_entry(const AlignmentInput& in, std::size_t lamp, const Fitted& f, const LampSize& size) {
  manifest::AlignedLight light;
  light.light = in.lamps[lamp], light.position_m = numbers(f.setting.lamps_m[lamp]);
  const Index at = place_of(in.question.freedoms, Block::lamp_shift, lamp);
  if (at >= 0) light.covariance_m2 = covariance_of(f, at);
  if (const auto place = in.carried.find(lamp); place != in.carried.end()) light.images = place->second.images;
  if (size.edges > 0) light.radius_m = size.radius_m, light.sigma["radius_m"] = {size.sigma_m};
  return light;
}

manifest::AlignedCamera camera_entry(const AlignmentInput& in, std::size_t station, const Fitted& f) {
  manifest::AlignedCamera camera;
  const Station& s = f.setting.stations[station];
  camera.camera = in.cameras[s.lens], camera.images = in.images_of_station[station];
  camera.world_from_camera.emplace();
  camera.world_from_camera->rotation = s.world_from_camera.rotation;
  camera.world_from_camera->translation_m = s.world_from_camera.translation_m;
  const auto& freedoms = in.question.freedoms;
  camera.covariance =
      joint(f, place_of(freedoms, Block::station_turn, station), place_of(freedoms, Block::station_shift, station));
  const Index focal = place_of(freedoms, Block::lens_focal, s.lens);
  if (focal >= 0) {
    camera.focal_factor = f.setting.lenses[s.lens].fx_px / in.stated.lenses[s.lens].fx_px;
    camera.sigma["focal_factor"] = {*camera.focal_factor * sigma_at(f, focal)};
  }
  return camera;
}

// The ground's plane turned the shortest way to where it was found, about the point beneath the first body.
manifest::Pose<frame::World, frame::Object> ground_pose(const AlignmentInput& in, const Fitted& f) {
  const Ground& ground = *f.setting.ground;
  const GroundAxes axes = ground_axes(f.setting);
  const Rigid<frame::World, frame::Object> carried =
      carried_along(in.world_from_ground, *in.stated.ground, ground, axes.pivot_m);
  manifest::Pose<frame::World, frame::Object> pose;
  pose.rotation = carried.rotation, pose.translation_m = carried.translation_m;
  const Index tilt = place_of(in.question.freedoms, Block::ground_tilt, 0),
              shift = place_of(in.question.freedoms, Block::ground_shift, 0);
  const std::array<Index, 3> number{tilt, tilt + 1, shift};
  const std::array<Vec3, 3> motion{axes.t, axes.b, ground.normal};  // two turns and a shift
  std::vector<double> covariance(36, 0);
  const auto part = [&](std::size_t number_of, Index i) {
    const bool turns = number_of < 2;
    const Vec3 v = motion[number_of];
    return turns == (i < 3) ? std::array<double, 3>{v.x, v.y, v.z}[static_cast<std::size_t>(i % 3)] : 0.0;
  };
  for (Index i = 0; i < 6; ++i)
    for (Index k = 0; k < 6; ++k)
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b)
          covariance[static_cast<std::size_t>(6 * i + k)] +=
              part(a, i) * f.covariance(number[a], number[b]) * part(b, k);
  pose.sigma = manifest::sigma_at(std::span<const double, 36>(covariance), pose.translation_m - axes.pivot_m);
  return pose;
}

}  // namespace

std::vector<std::size_t> loose_lamps(const AlignmentInput& in, const Fitted& f) {
  std::vector<std::size_t> loose;
  for (std::size_t l = 0; l < in.lamps.size(); ++l) {
    const Index at = place_of(in.question.freedoms, Block::lamp_shift, l);
    if (at < 0) continue;
    double nearest = HUGE_VAL;
    for (const Body& body : f.setting.bodies) nearest = std::min(nearest, norm(f.setting.lamps_m[l] - body.centre_m()));
    const std::vector<double> sigma = sigmas(f, at);
    if (*std::max_element(sigma.begin(), sigma.end()) > 0.5 * nearest) loose.push_back(l);
  }
  return loose;
}

manifest::Alignment entry_of(const AlignmentInput& in, std::size_t body, const Aligned& found) {
  const Fitted& f = found.fitted;
  const Body& b = f.setting.bodies[body];
  const auto& freedoms = in.question.freedoms;
  manifest::Alignment a;
  a.object = in.bodies[body], a.verdict = word_of(found.verdict), a.why = found.why;
  a.rms_px = f.rms_px, a.sigma_px = f.sigma_px, a.correlation_px = f.correlation_px, a.explained = f.explained;
  a.world_from_object = pose_of(b), a.centre_m = numbers(b.centre_m());
  if (found.verdict == Verdict::lost || found.verdict == Verdict::mirrored) return a;  // how sure nobody asks
  a.covariance = joint(f, place_of(freedoms, Block::body_turn, body), place_of(freedoms, Block::body_shift, body));
  bool uniform = false;
  if (scaled(freedoms, body, uniform)) {
    a.scale = numbers(b.scale);
    const Index at = place_of(freedoms, Block::body_scale, body);
    const double s = uniform ? b.scale.x * sigma_at(f, at) : 0;
    a.sigma["scale"] = uniform ? std::vector<double>{s, s, s}
                               : std::vector<double>{b.scale.x * sigma_at(f, at), b.scale.y * sigma_at(f, at + 1),
                                                     b.scale.z * sigma_at(f, at + 2)};
  }
  a.open = found.open;
  a.open.insert(a.open.end(), found.symmetries.begin(), found.symmetries.end());
  for (const std::size_t l : loose_lamps(in, f)) a.open.push_back("the place of lamp " + in.lamp_words(l));
  if (found.pictures) a.pictures = pictures_entry(in, body, *found.pictures);
  for (const Rival& r : found.rivals) a.candidates.push_back({pose_of(r.setting.bodies[body]), r.rms_px, r.explained});
  const std::vector<LampSize> sizes = lamp_sizes(in, f.setting);
  for (std::size_t l = 0; l < in.lamps.size(); ++l)
    if (place_of(freedoms, Block::lamp_shift, l) >= 0 || sizes[l].told())
      a.lights.push_back(light_entry(in, l, f, sizes[l]));
  for (std::size_t s = 0; s < in.stated.stations.size(); ++s)
    if (place_of(freedoms, Block::station_turn, s) >= 0 ||
        place_of(freedoms, Block::lens_focal, in.stated.stations[s].lens) >= 0)
      a.cameras.push_back(camera_entry(in, s, f));
  return a;
}

manifest::AlignedPictures pictures_entry(const AlignmentInput& in, std::size_t body, const PictureAnswer& answer) {
  manifest::AlignedPictures p;
  p.verdict = answer.taken ? "taken" : "refused", p.why = answer.why;
  p.photographs = static_cast<std::int64_t>(answer.photographs), p.pixels = static_cast<std::int64_t>(answer.pixels);
  p.independent = answer.independent, p.correlation_px = answer.correlation_px;
  p.relative_error = answer.relative_error, p.relative_error_rims = answer.relative_before;
  p.chi2 = answer.chi2, p.chi2_limit = answer.chi2_limit, p.numbers = static_cast<std::int64_t>(answer.numbers);
  p.move_px = answer.move_px, p.sigma_px = answer.sigma_px;
  p.world_from_object = pose_of(answer.fitted.setting.bodies[body]);
  const auto& freedoms = in.question.freedoms;
  p.covariance =
      joint(answer.fitted, place_of(freedoms, Block::body_turn, body), place_of(freedoms, Block::body_shift, body));
  return p;
}

void enter_figures(const SightingFit& fit, manifest::Outline& outline) {
  outline.points = static_cast<std::int64_t>(fit.counted + fit.left_out),
  outline.left_out = static_cast<std::int64_t>(fit.left_out);
  outline.rms_px = fit.rms_px, outline.mean_px = fit.mean_px, outline.explained = fit.explained;
}

void move_document(manifest::Document& document, const AlignmentInput& in, std::size_t body, const Aligned& found) {
  const Fitted& f = found.fitted;
  const auto& freedoms = in.question.freedoms;
  const Body& b = f.setting.bodies[body];
  for (manifest::Object& object : document.objects) {
    if (object.id == in.ground && place_of(freedoms, Block::ground_tilt, 0) >= 0)
      object.world_from_object = ground_pose(in, f);
    if (object.id != in.bodies[body]) continue;
    object.world_from_object = pose_of(b);
    const Index turn = place_of(freedoms, Block::body_turn, body), shift = place_of(freedoms, Block::body_shift, body);
    if (turn >= 0) {
      const std::vector<double> of_motion = joint(f, turn, shift);
      object.world_from_object->sigma =
          manifest::sigma_at(std::span<const double, 36>(of_motion), b.world_from_object.translation_m - b.centre_m());
    }
  }
  bool uniform = false;
  if (scaled(freedoms, body, uniform)) {
    manifest::MechanismUse& use = document.mechanisms[mechanism::geometry_shrinkage().id];
    use.on = {in.bodies[body]};
    const std::array<const char*, 3> names{"shrink_x", "shrink_y", "shrink_z"};
    const Index at = place_of(freedoms, Block::body_scale, body);
    for (std::size_t k = 0; k < 3; ++k) {
      const double s = k == 0 ? b.scale.x : k == 1 ? b.scale.y : b.scale.z;
      use.parameters[names[k]] = 1 - s;
      use.sigma[names[k]] = {s * sigma_at(f, uniform ? at : at + static_cast<Index>(k))};
    }
  }
  const std::vector<std::size_t> loose = loose_lamps(in, f);
  for (std::size_t l = 0; l < in.lamps.size(); ++l) {
    const Index at = place_of(freedoms, Block::lamp_shift, l);
    if (at < 0 || in.carried.contains(l) || std::find(loose.begin(), loose.end(), l) != loose.end()) continue;
    manifest::Light& light = document.lights.at(in.lamps[l]);
    light.parameters["position_m"].value = numbers(f.setting.lamps_m[l]);
    light.sigma["position_m"] = sigmas(f, at);
  }
  for (std::size_t s = 0; s < in.stated.stations.size(); ++s) {
    const Index turn = place_of(freedoms, Block::station_turn, s), shift = place_of(freedoms, Block::station_shift, s);
    if (turn < 0) continue;
    manifest::Pose<frame::World, frame::Camera> pose;
    pose.rotation = f.setting.stations[s].world_from_camera.rotation;
    pose.translation_m = f.setting.stations[s].world_from_camera.translation_m;
    pose.sigma = manifest::PoseSigma{sigmas(f, turn), sigmas(f, shift)};
    move_images(document, in.images_of_station[s], pose);
  }
  for (std::size_t c = 0; c < in.cameras.size(); ++c) {
    const Index at = place_of(freedoms, Block::lens_focal, c);
    if (at < 0) continue;
    manifest::Camera& camera = document.cameras.at(in.cameras[c]);
    const Lens& lens = f.setting.lenses[c];
    camera.fx_px.value = {lens.fx_px}, camera.fy_px.value = {lens.fy_px};
    camera.sigma["fx_px"] = {lens.fx_px * sigma_at(f, at)};
    camera.sigma["fy_px"] = {lens.fy_px * sigma_at(f, at)};
    camera.covariance = {};  // of a calibration that this is no longer
  }
}

void enter_carried(manifest::Document& document, const AlignmentInput& in, const Fitted& f) {
  const std::vector<std::size_t> loose = loose_lamps(in, f);
  for (const auto& [lamp, place] : in.carried)
    std::erase_if(document.light_positions,
                  [&](const manifest::LightPosition& p) { return p.light == in.lamps[lamp]; });
  for (const auto& [lamp, place] : in.carried) {
    const Index at = place_of(in.question.freedoms, Block::lamp_shift, lamp);
    if (at < 0 || std::find(loose.begin(), loose.end(), lamp) != loose.end()) continue;
    manifest::LightPosition entry;
    entry.id = in.lamps[lamp] + "-" + place.images.front(), entry.light = in.lamps[lamp], entry.robot = place.robot;
    entry.base_from_tool = place.base_from_tool, entry.position_m = numbers(f.setting.lamps_m[lamp]);
    entry.sigma_m = sigmas(f, at), entry.covariance_m2 = covariance_of(f, at);
    document.light_positions.push_back(std::move(entry));
  }
}

std::string point_table(const AlignmentInput& in, const Setting& setting, std::size_t sighting,
                        const SightingFit& fit) {
  const Sighting& seen = in.question.sightings[sighting];
  const std::vector<RimPoint>& picture = in.rims[sighting].in_picture;
  const ModelRim rim(setting, seen.subject);
  const Body& body = setting.bodies[seen.subject.body];
  const Station& station = setting.stations[seen.subject.station];
  std::string out =
      "x_px,y_px,normal_x,normal_y,offset_px,weight,sigma_px,loop,arc_px,mesh_x_m,mesh_y_m,mesh_z_m,depth_m\n";
  for (std::size_t i = 0; i < picture.size(); ++i) {
    if (!std::isfinite(fit.offset_px[i]) || !rim.exists()) continue;
    const RimPoint& point = seen.points[i];
    const auto place = rim.nearest(point.pixel, point.outward, std::abs(fit.offset_px[i]) + 1e-6);
    if (!place) continue;
    const Vec3 world = body.place_m(place->mesh_point);
    const double depth = (inverse(station.world_from_camera) * world).z;
    out += format("%.4f,%.4f,%.5f,%.5f,%.5f,%.4f,%.4f,%u,%.2f,%.7g,%.7g,%.7g,%.6g\n", picture[i].pixel.x,
                  picture[i].pixel.y, picture[i].outward.x, picture[i].outward.y, fit.offset_px[i], fit.weight[i],
                  fit.sigma_px, point.loop, point.arc_px, place->mesh_point.x, place->mesh_point.y, place->mesh_point.z,
                  depth);
  }
  return out;
}

}  // namespace gonio::alignment
