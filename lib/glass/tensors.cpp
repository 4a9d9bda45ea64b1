// See tensors.h.
#include "glass/tensors.h"

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "glass/net/seen.h"
#include "io/picture.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"
#include "manifest/sections/object.h"
#include "render/virtual_sensor.h"

namespace gonio::glass {
namespace {

namespace fs = std::filesystem;
using Tensors = std::map<std::string, std::vector<float>>;

std::size_t channel(const io::Image& picture, const std::string& name, const fs::path& path) {
  const int c = picture.channel(name);
  if (c < 0) throw Error(Exit::data, path.string(), "has no layer " + name, "make the cell anew");
  return static_cast<std::size_t>(c);
}

io::Image read_layer_file(const fs::path& path, const SetWish& wish) {
  io::Image picture = io::read_picture(path);
  if (picture.width != wish.width_px || picture.height != wish.height_px)
    throw Error(Exit::data, path.string(), "has another size than the set's cells", "make the cell anew");
  return picture;
}

void add_planes(std::vector<float>& tensor, const io::Image& picture, const std::vector<std::size_t>& channels) {
  for (const std::size_t c : channels)
    for (std::size_t i = 0; i < picture.pixels(); ++i) tensor.push_back(picture.data[i * picture.channels.size() + c]);
}

std::vector<float> rgb_of(const io::Image& rendering, const manifest::ImageEntry& image, std::uint64_t seed) {
  const io::Image read = render::recorded(rendering, image.noise.value(), image.id + "-rgb", seed);
  std::vector<float> tensor;
  add_planes(tensor, read, {0, 1, 2});
  return tensor;
}

// Numbers of the objects that are glass, or in it; id is the place in the list + 1.
std::vector<bool> clear_ids(const manifest::Document& scene) {
  std::vector<bool> clear{false};
  for (const manifest::Object& object : scene.objects) clear.push_back(object.id != "table");
  return clear;
}

void add_truth(Tensors& all, const io::Image& rendering, const Cell& cell, const fs::path& path) {
  const std::vector<bool> clear = clear_ids(cell.scene);
  const std::size_t id = channel(rendering, "id", path), z = channel(rendering, "depth.Z", path);
  const std::size_t width = rendering.channels.size(), n = rendering.pixels();
  const Mat3 camera_from_world = transposed(matrix_of(cell.scene.images.front().world_from_camera->rotation));
  std::vector<float>&mask = all["mask"], &depth = all["depth"];
  mask.assign(n, 0), depth.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const auto number = static_cast<std::size_t>(rendering.data[i * width + id]);
    if (number >= clear.size() || !clear[number]) continue;
    mask[i] = 1, depth[i] = rendering.data[i * width + z];
  }
  for (const auto& [name, layer] : {std::pair{"front", "normal"}, std::pair{"back", "back_normal"}}) {
    const std::size_t first = channel(rendering, std::string(layer) + ".X", path),
                      second = channel(rendering, std::string(layer) + ".Y", path),
                      third = channel(rendering, std::string(layer) + ".Z", path);
    std::vector<float>& normals = all[name];
    normals.assign(3 * n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      if (mask[i] == 0) continue;
      const float* at = &rendering.data[i * width];
      const Vec3 normal = camera_from_world * Vec3{at[first], at[second], at[third]};
      for (int k = 0; k < 3; ++k) normals[static_cast<std::size_t>(k) * n + i] = static_cast<float>(normal[k]);
    }
  }
}

}  // namespace

const std::vector<TensorName>& tensor_names() {
  static const std::vector<TensorName> all{
      {"rgb-bare", 3},        {"rgb-lit", 3}, {"stokes-bare", 3}, {"stokes-lit", 3}, {"intensities-bare", 4},
      {"intensities-lit", 4}, {"mask", 1},    {"depth", 1},       {"front", 3},      {"back", 3}};
  return all;
}

Tensors tensors_of(const GlassSet& set, const Cell& cell) {
  Tensors all;
  const fs::path folder = set.folder_of(cell);
  for (const manifest::ImageEntry& image : cell.scene.images) {
    const fs::path path = folder / (image.id + ".exr");
    const io::Image rendering = read_layer_file(path, set.wish());
    const io::Image mosaic = read_layer_file(folder / (image.id + "-mosaic.exr"), set.wish());
    all["rgb-" + image.id] = rgb_of(rendering, image, split_mix(set.wish().seed) ^ cell.number);
    all["stokes-" + image.id] = stokes_of_mosaic(mosaic).values;
    all["intensities-" + image.id] = intensities_of_mosaic(mosaic).values;
    if (image.id == "bare") add_truth(all, rendering, cell, path);
  }
  return all;
}

double coverage_of(const std::vector<float>& mask) {
  double sum = 0;
  for (const float m : mask) sum += m;
  return mask.empty() ? 0 : sum / static_cast<double>(mask.size());
}

TensorFiles::TensorFiles(const fs::path& folder, Share share, std::size_t cells, int width_px, int height_px) {
  if (cells == 0) return;
  make_folder(folder);
  for (const auto& [name, channels] : tensor_names()) {
    paths_.push_back(folder / (std::string(name_of(share)) + "-" + name + ".npy"));
    files_[name] = std::make_unique<io::NpyWriter>(
        paths_.back(), std::vector<std::size_t>{cells, channels, static_cast<std::size_t>(height_px),
                                                static_cast<std::size_t>(width_px)});
  }
}

void TensorFiles::append(const Tensors& tensors) {
  for (auto& [name, file] : files_) file->append(tensors.at(name));
}

std::vector<fs::path> TensorFiles::commit() {
  for (auto& [name, file] : files_) file->commit();
  return paths_;
}

}  // namespace gonio::glass
