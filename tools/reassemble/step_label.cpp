// --labels: which surface each face of the background has, by the photographs.
#include <algorithm>
#include <cmath>
#include <memory>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/text.h"
#include "camera/camera_model.h"
#include "io/picture.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "mesh/triangle_tree.h"
#include "photograph/linear_picture.h"
#include "render/session.h"
#include "scene/scene.h"
#include "tools/reassemble/work.h"

namespace gonio::tools::reassemble {
namespace {

using manifest::Document;

// The photographs that say what the background is made of, as the labelling takes them.
struct Shot {
  std::string image;
  std::size_t index = 0;
  std::unique_ptr<camera::CameraModel> camera;
  Rigid<frame::World, frame::Camera> world_from_camera;
  photograph::LinearPicture picture;
  std::vector<std::uint8_t> hidden;  // saturated, or a piece stands before the background
  reassembly::LabelWish wish;
  reassembly::LabelPicture labels;
};

// What shows a piece or a marker, or what lies behind its glass, says nothing of the background.
class Pieces {
 public:
  explicit Pieces(const Work& work) : work_(work) {
    for (const reassembly::Placed& placed : work.placement.pieces) {
      if (placed.verdict != reassembly::Verdict::placed) continue;
      const io::TriangleMesh mesh = placed_mesh(work, placed.object);
      const auto first = static_cast<std::uint32_t>(positions_.size());
      positions_.insert(positions_.end(), mesh.positions_m.begin(), mesh.positions_m.end());
      for (const auto& t : mesh.triangles) triangles_.push_back({first + t[0], first + t[1], first + t[2]});
    }
    tree_ = std::make_unique<mesh::TriangleTree>(positions_, triangles_);
  }

  void hide(Shot& shot) const {
    const int width = shot.camera->width_px(), height = shot.camera->height_px();
    shot.hidden = shot.picture.clipped;
    shot.hidden.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
    const auto row = [&](std::size_t y) {
      for (int x = 0; x < width && !triangles_.empty(); ++x) {
        const camera::Ray ray = shot.camera->ray({static_cast<double>(x), static_cast<double>(y)});
        if (tree_->first_hit(shot.world_from_camera * ray.origin_m, shot.world_from_camera.rotate(ray.direction), 1e-6))
          shot.hidden[y * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] = 1;
      }
    };
    parallel_for(0, static_cast<std::size_t>(height), row);
    for (const reassembly::View& view : work_.seen.views) {
      if (view.image != shot.image) continue;
      for (const reassembly::Outline& o : view.outlines) {
        const double reach = o.radius_px + 1.5;
        for (int y = std::max(0, static_cast<int>(o.centre_px.y - reach));
             y <= std::min(height - 1, static_cast<int>(o.centre_px.y + reach)); ++y)
          for (int x = std::max(0, static_cast<int>(o.centre_px.x - reach));
               x <= std::min(width - 1, static_cast<int>(o.centre_px.x + reach)); ++x)
            if (std::hypot(x - o.centre_px.x, y - o.centre_px.y) <= reach)
              shot.hidden[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
                  1;
      }
    }
  }

 private:
  const Work& work_;
  std::vector<Vec3> positions_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::unique_ptr<mesh::TriangleTree> tree_;
};

std::vector<Shot> shots_of(const Work& work) {
  const Document& document = work.call.document;
  const Pieces pieces(work);
  std::vector<Shot> shots;
  for (const reassembly::View& view : work.seen.views) {
    Shot shot;
    shot.image = view.image, shot.index = *manifest::index_of_image(document, view.image);
    const manifest::ImageEntry& entry = document.images[shot.index];
    shot.camera = std::make_unique<camera::CameraModel>(reassembly::camera_of(document, shot.index));
    shot.world_from_camera = view.world_from_camera;
    const std::string at = manifest::place(document, "/images/" + std::to_string(shot.index));
    shot.picture =
        photograph::read_linear(manifest::picture_path(document, shot.index), entry.response, at, entry.saturation);
    if (entry.noise) shot.wish.noise_gain = entry.noise->gain, shot.wish.noise_read = entry.noise->read;
    pieces.hide(shot);
    shots.push_back(std::move(shot));
  }
  return shots;
}

// The scene with another surface on everything opaque; glass stays glass.
Document with_white_surfaces(const Document& document, double albedo) {
  Document white = document;
  for (auto& [name, surface] : white.surfaces) {
    if (surface.model == "dielectric" || surface.model == "beckmann-dielectric") continue;
    surface = {};
    surface.parameters["albedo"] = manifest::Parameter(std::vector<double>{albedo, albedo, albedo});
  }
  return white;
}

// Mean over directions of what a surface reflects of uniform light.
Vec3 mean_albedo(const scene::Surface& surface) {
  constexpr int steps = 32;
  Vec3 sum{};
  for (int k = 0; k < steps; ++k) {
    const double cosine = std::sqrt((k + 0.5) / steps);  // equal parts of 2 cos dcos
    const Rgb part = surface.model->albedo(surface.values, {std::sqrt(1 - cosine * cosine), 0, cosine});
    sum = sum + part * (1.0 / steps);
  }
  return sum;
}

std::vector<reassembly::Material> materials_of(const Work& work, const scene::Scene& scene) {
  std::vector<reassembly::Material> materials;
  for (const std::string& name : work.asked.label_surfaces) {
    const auto found = std::ranges::find(scene.appearance.surfaces, name, &scene::Surface::id);
    reassembly::Material material{.surface = name, .albedo = mean_albedo(*found)};
    if (!(std::min({material.albedo.x, material.albedo.y, material.albedo.z}) > 0))
      throw Error(Exit::data, manifest::place(work.call.document, "/surfaces/" + name), "reflects nothing by diffusion",
                  "give --label-surface what the background is made of");
    materials.push_back(material);
  }
  return materials;
}

void render_shading(Work& work, std::vector<Shot>& shots) {
  constexpr double albedo = 0.5;  // neighbours light each other as things of middling lightness do
  render::SessionOptions options;
  options.seed = work.call.seed;
  options.geometry = false;
  options.spp = work.asked.shading_spp;
  options.force = true, options.allow_open = true;
  const Document white = with_white_surfaces(work.call.document, albedo);
  const render::Session session(white, options, [](const std::filesystem::path&) {});
  Progress progress("shading", shots.size());
  for (Shot& shot : shots) {
    const std::filesystem::path path = work.call.output_path(file_stem(shot.image) + "-shading.exr");
    io::Image shading = session.render(shot.index, path).picture;
    render::Session::remove_checkpoint(path);
    const std::array<int, 3> colour{shading.channel("R"), shading.channel("G"), shading.channel("B")};
    io::Image rgb(shading.width, shading.height, {"R", "G", "B"});
    for (int y = 0; y < rgb.height; ++y)
      for (int x = 0; x < rgb.width; ++x)
        for (int c = 0; c < 3; ++c)
          rgb.at(x, y, c) = shading.at(x, y, colour[static_cast<std::size_t>(c)]) / static_cast<float>(albedo);
    io::write_picture(path, rgb);
    shot.wish.shading = std::move(rgb);
    progress.advance();
  }
}

std::vector<reassembly::Material> found_materials(Work& work, const std::vector<Shot>& shots) {
  std::vector<reassembly::LitPicture> lit;
  for (const Shot& shot : shots) lit.push_back({&shot.picture.colour, &shot.hidden, nullptr});
  auto materials = reassembly::find_materials(lit);
  for (reassembly::Material& material : materials) {
    const std::string name = "background-" + material.surface;
    manifest::Surface surface;
    surface.parameters["albedo"] =
        manifest::Parameter(std::vector<double>{material.albedo.x, material.albedo.y, material.albedo.z});
    work.call.document.surfaces[name] = surface;
    material.surface = name;
  }
  log(LogLevel::warning, format("%zu surfaces were found by their colours; how light they are is not known without "
                                "--label-surface",
                                materials.size()));
  return materials;
}

void label_pictures(Work& work, std::vector<Shot>& shots) {
  for (const auto& [image, file] : work.asked.seeds) {
    const auto shot = std::ranges::find(shots, image, &Shot::image);
    if (shot == shots.end())
      throw Error(Exit::usage, "--seeds", "\"" + image + "\" is no image that is looked at", "name one of them");
    work.call.note_input(file);
    shot->wish.seeds =
        reassembly::read_seeds(file, shot->camera->width_px(), shot->camera->height_px(), shot->wish.materials.size());
  }
  Progress progress("labels", shots.size());
  parallel_for(0, shots.size(), [&](std::size_t k) {
    Shot& shot = shots[k];
    shot.labels = reassembly::label_picture(shot.picture.colour, shot.hidden, shot.wish);
    const bool codes = !shot.picture.clipped.empty();
    for (std::size_t i = 0; i < shot.hidden.size(); ++i)
      if (shot.hidden[i] != 0 &&
          !(codes && shot.picture.clipped[i] != 0))  // a highlight's label may follow from around
        shot.labels.label[i] = reassembly::unlabelled, shot.labels.confidence[i] = 0;
    progress.advance();
  });
  for (const Shot& shot : shots) {
    const std::string labels = io::encode_png(reassembly::coloured_labels(shot.labels));
    const std::string confidence = io::encode_png(reassembly::coloured_confidence(shot.labels));
    write_file(work.call.output_path(file_stem(shot.image) + "-labels.png"), labels);
    write_file(work.call.output_path(file_stem(shot.image) + "-confidence.png"), confidence);
    work.label_pictures.push_back({shot.image, labels, confidence});
  }
}

// One object for each surface: models differ, and an object has one.
void enter_labelled(Work& work, const reassembly::LabelledMesh& labelled,
                    const std::vector<reassembly::Material>& materials) {
  for (std::size_t l = 0; l < materials.size(); ++l) {
    io::TriangleMesh part;
    std::vector<std::uint32_t> place(labelled.mesh.positions_m.size(), UINT32_MAX);
    for (std::size_t f = 0; f < labelled.mesh.triangles.size(); ++f) {
      if (labelled.mesh.labels[f] != static_cast<std::int32_t>(l)) continue;
      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t v = labelled.mesh.triangles[f][c];
        if (place[v] == UINT32_MAX) {
          place[v] = static_cast<std::uint32_t>(part.positions_m.size());
          part.positions_m.push_back(labelled.mesh.positions_m[v]);
          if (!labelled.mesh.normals.empty()) part.normals.push_back(labelled.mesh.normals[v]);
        }
        triangle[c] = place[v];
      }
      part.triangles.push_back(triangle);
    }
    if (!part.triangles.empty()) enter_mesh(work, "background-" + materials[l].surface, part, materials[l].surface);
  }
}

}  // namespace

void label(Work& work) {
  if (!work.asked.labels) return;
  // Normals over the whole, so that no seam shows where one surface ends.
  if (work.background.normals.empty())
    work.background.normals = mesh::averaged_normals(work.background.positions_m, work.background.triangles);
  std::vector<Shot> shots = shots_of(work);
  std::vector<reassembly::Material> materials;
  if (work.asked.label_surfaces.empty()) {
    materials = found_materials(work, shots);
  } else {
    scene::Reading reading;
    reading.allow_open = true;
    materials = materials_of(work, scene::build_scene(work.call.document, reading));
    if (work.asked.shading_spp > 0) render_shading(work, shots);
  }
  std::erase_if(work.call.document.objects, [](const manifest::Object& o) { return o.id == "background"; });
  for (Shot& shot : shots) shot.wish.materials = materials;
  label_pictures(work, shots);
  std::vector<reassembly::LabelView> views;
  for (const Shot& shot : shots) views.push_back({&shot.labels, shot.camera.get(), shot.world_from_camera});
  const reassembly::LabelledMesh labelled = reassembly::label_faces(work.background, views, {});
  work.split_faces = labelled.split;
  work.unseen_faces = static_cast<std::size_t>(std::ranges::count(labelled.seen, std::uint8_t{0}));
  work.label_confidence = labelled.confidence;
  enter_labelled(work, labelled, materials);
}

}  // namespace gonio::tools::reassemble
