#include "mesh/register/register_document.h"

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/frame_graph.h"
#include "manifest/pose_sigma.h"
#include "manifest/sections/cloud.h"
#include "manifest/sections/image.h"
#include "manifest/sections/registration.h"
#include "mesh/reconstruct/measured_clouds.h"
#include "mesh/reconstruct/viewpoints.h"
#include "mesh/register/moved_cloud.h"
#include "mesh/register/register_page.h"
#include "mesh/register/register_words.h"

namespace gonio::mesh {
namespace {

using manifest::Document;

std::vector<std::string> views_of(const Document& document, const CloudRegisterRequest& request) {
  std::vector<std::string> names = chosen_clouds(document, request.clouds, request.viewpoints_m);
  if (names.size() < 2)
    throw Error(Exit::data, manifest::place(document, "/clouds"), "have one view alone: " + names[0],
                "two and more can agree or not");
  if (!request.fixed.empty() && std::ranges::find(names, request.fixed) == names.end())
    throw Error(Exit::usage, "--fixed", request.fixed + " is none of the clouds that are taken", "see --view");
  return names;
}

// The image that says where the cloud's first camera stood.
const manifest::ImageEntry* placed_image(const Document& document, const std::string& cloud) {
  const manifest::Cloud& own = document.clouds.at(cloud);
  for (const std::size_t i : images_of_cloud(document, cloud)) {
    const manifest::ImageEntry& image = document.images[i];
    if (image.camera == own.cameras.front() && image.world_from_camera) return &image;
  }
  return nullptr;
}

std::optional<PoseDoubt> doubt_of(const Document& document, const std::string& cloud) {
  const manifest::ImageEntry* image = placed_image(document, cloud);
  if (image == nullptr || !image->world_from_camera->sigma) return std::nullopt;
  const auto& pose = *image->world_from_camera;
  const manifest::FrameEdge edge{
      "world", "camera", {pose.rotation, pose.translation_m}, manifest::covariance_of(*pose.sigma), ""};
  return PoseDoubt{manifest::with_rounding(edge), pose.translation_m};
}

std::vector<double> numbers(Vec3 v) {
  return {v.x, v.y, v.z};
}

std::vector<double> sigmas(const std::array<double, 36>& covariance, std::size_t first) {
  std::vector<double> all;
  for (std::size_t k = first; k < first + 3; ++k) all.push_back(std::sqrt(std::max(0.0, covariance[7 * k])));
  return all;
}

manifest::RegisteredPair entry_of(const PairFigures& f, const std::vector<std::string>& names) {
  manifest::RegisteredPair pair;
  pair.clouds = {names[f.first], names[f.second]};
  pair.overlap = {f.overlap[0], f.overlap[1]};
  pair.residuals = static_cast<std::int64_t>(f.residuals), pair.patches = static_cast<std::int64_t>(f.patches);
  pair.rms_m = f.rms_m, pair.consistency = f.consistency, pair.typical = f.typical;
  pair.rigid = f.rigid, pair.rest = f.rest, pair.rigid_p = f.rigid_p;
  if (f.held > 0) pair.shift_m = f.shift_m, pair.turn_rad = f.turn_rad;
  pair.sigma = {{"consistency", {f.sigma}}, {"rest", {f.rest_sigma}}};
  return pair;
}

manifest::RegisteredView entry_of(const ViewShift& shift, const std::string& name, bool moved) {
  manifest::RegisteredView view;
  view.cloud = name;
  view.held = static_cast<std::int64_t>(shift.held), view.open = shift.open;
  if (!moved) return view;
  view.refined_from_stated.emplace();
  view.refined_from_stated->rotation = shift.motion.rotation;
  view.refined_from_stated->translation_m = shift.motion.translation_m;
  view.centre_m = numbers(shift.centre_m), view.shift_m = numbers(shift.shift_m);
  view.turn_rad = numbers(shift.turn_rad);
  view.covariance.assign(shift.covariance.begin(), shift.covariance.end());
  view.sigma = {{"shift_m", sigmas(shift.covariance, 3)}, {"turn_rad", sigmas(shift.covariance, 0)}};
  return view;
}

manifest::Registration entry_of(const Registration& found, const CloudRegisterRequest& request,
                                const std::vector<std::string>& names) {
  manifest::Registration entry;
  entry.verdict = !request.wish.refine ? "compared" : found.refused.empty() ? "refined" : "refused";
  entry.why = found.refused;
  entry.fixed = names[request.wish.fixed];
  const Consistency& c = found.after;
  entry.consistency = c.value, entry.typical = c.typical, entry.rigid = c.rigid, entry.rest = c.rest;
  entry.rigid_p = c.rigid_p;
  entry.sigma = {{"consistency", {c.sigma}}, {"rest", {c.rest_sigma}}};
  entry.residuals = static_cast<std::int64_t>(c.residuals), entry.patches = static_cast<std::int64_t>(c.patches);
  entry.reach_m = found.reach_m;
  for (const PairFigures& pair : found.pairs) entry.pairs.push_back(entry_of(pair, names));
  if (!request.wish.refine) return entry;
  entry.consistency_before = found.before.value;
  entry.limit_m = request.wish.limit_m, entry.inflation = found.inflation;
  for (std::size_t v = 0; v < found.views.size(); ++v)
    entry.views.push_back(entry_of(found.views[v], names[v], found.refused.empty() && v != request.wish.fixed));
  return entry;
}

void move(Document& document, const CloudRegisterRequest& request, const std::string& name, const ViewShift& shift) {
  const auto path = request.output_path(file_stem(name) + ".ply");
  write_moved_cloud(cloud_path(document, name), shift.motion, path);
  document.clouds.at(name).file = manifest::add_file(document, path, "cloud-" + name);
  for (const std::size_t i : images_of_cloud(document, name)) {
    auto& pose = document.images[i].world_from_camera;
    if (!pose) continue;
    const Rigid<frame::World, frame::Camera> moved = shift.motion * *pose;
    pose->rotation = moved.rotation, pose->translation_m = moved.translation_m;
    // What nothing holds is as badly known as it was.
    if (shift.open.empty()) pose->sigma = manifest::sigma_at(shift.covariance, moved.translation_m - shift.centre_m);
  }
}

}  // namespace

void check_cloud_register(const Document& document, const CloudRegisterRequest& request) {
  const std::vector<std::string> names = views_of(document, request);
  (void)viewpoints_of(document, names, request.viewpoints_m);
  for (const std::string& name : names) {
    const std::filesystem::path path = cloud_path(document, name);
    if (request.note_input) request.note_input(path);
  }
}

CloudRegisterSummary cloud_register_document(Document& document, const CloudRegisterRequest& asked) {
  CloudRegisterRequest request = asked;
  const std::vector<std::string> names = views_of(document, request);
  const auto fixed = std::ranges::find(names, request.fixed);
  request.wish.fixed = fixed == names.end() ? 0 : static_cast<std::size_t>(fixed - names.begin());
  const MeasuredPoints points = points_of_clouds(document, names, request.viewpoints_m);
  std::vector<std::optional<PoseDoubt>> doubts;
  for (const std::string& name : names) doubts.push_back(doubt_of(document, name));
  const Registration found = register_views(points, doubts, request.wish);
  log_registration(found, names, request.wish);
  const manifest::Registration entry = entry_of(found, request, names);
  const std::string page = request.page.empty() ? std::string() : register_page(points, found, names, request.wish);
  if (request.wish.refine && found.refused.empty())
    for (std::size_t v = 0; v < found.views.size(); ++v)
      if (v != request.wish.fixed) {
        move(document, request, names[v], found.views[v]);
        document.clouds.at(names[v]).points = std::ranges::count(points.view, static_cast<std::uint32_t>(v));
      }
  if (!request.page.empty()) write_file(request.page, page);
  document.registration.entry = {entry};
  return {found.pairs.size(), !found.refused.empty(), found.after.value};
}

}  // namespace gonio::mesh
