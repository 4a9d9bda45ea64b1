// Which volume, and the built-in one.
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {
namespace {

constexpr std::size_t side = 64;  // voxels
constexpr double voxel_m = 1e-4;
constexpr double edge_voxels = 0.8;  // sd of the spread at an edge
constexpr double air = 100, glass = 2100, plastic = 4100, noise = 60;
constexpr double inner = 16, outer = 20, marker = 4, glued_at = 23.5;

// Values at a place, voxels from the middle: glass between two spheres, markers in three directions.
double value_at(Vec3 p) {
  const auto share = [](double distance) { return 0.5 * std::erfc(distance / (edge_voxels * std::sqrt(2.0))); };
  const double r = norm(p);
  double value = air + (glass - air) * share(std::max(inner - r, r - outer));
  for (const Vec3& d : {Vec3{1, 0, 0}, Vec3{0, 0.8, 0.6}, Vec3{-0.6, 0, -0.8}})
    value += (plastic - value) * share(norm(p - d * glued_at) - marker);
  return value;
}

}  // namespace

void choose(Work& work) {
  cli::Invocation& call = work.call;
  const manifest::Document& d = call.document;
  work.path = call.given("VOLUME") ? call.text("VOLUME") : "";
  if (!work.path.empty()) {
    work.name = call.given("name") ? call.text("name") : file_stem(std::filesystem::path(work.path).stem().string());
    return;
  }
  if (d.volumes.empty())
    throw Error(Exit::usage, "VOLUME", "is missing, and the manifest has no volumes",
                "name a file, or a folder of slices");
  if (call.given("name") ? !d.volumes.contains(call.text("name")) : d.volumes.size() > 1)
    throw Error(Exit::usage, "--name",
                call.given("name") ? "\"" + call.text("name") + "\" is none of the manifest's volumes"
                                   : "is missing: the manifest has " + std::to_string(d.volumes.size()) + " volumes",
                manifest::names_in(d, "volumes").front() + " is one");
  work.name = call.given("name") ? call.text("name") : d.volumes.begin()->first;
  const manifest::Volume& volume = d.volumes.at(work.name);
  work.path = manifest::resolve(d, volume.file, "/volumes/" + work.name + "/file").string();
  io::VolumeWish& wish = work.asked.file;
  if (!wish.spacing_m && volume.spacing_m.size() == 3)
    wish.spacing_m = Vec3{volume.spacing_m[0], volume.spacing_m[1], volume.spacing_m[2]};
  if (!wish.tiles && volume.tiles.size() == 2)
    wish.tiles = {static_cast<std::size_t>(volume.tiles[0]), static_cast<std::size_t>(volume.tiles[1])};
}

void write_specimen(cli::Invocation& call) {
  io::VolumeData made;
  made.head.size = {side, side, side}, made.head.type = io::VoxelType::u16;
  made.head.spacing_m = Vec3{voxel_m, voxel_m, voxel_m};
  const double middle = 0.5 * (static_cast<double>(side) - 1);
  made.head.origin_m = Vec3{-middle * voxel_m, -middle * voxel_m, -middle * voxel_m};
  Random random(call.seed);
  made.values.reserve(side * side * side);
  for (std::size_t k = 0; k < side; ++k)
    for (std::size_t j = 0; j < side; ++j)
      for (std::size_t i = 0; i < side; ++i) {
        const Vec3 p{static_cast<double>(i) - middle, static_cast<double>(j) - middle, static_cast<double>(k) - middle};
        const double value = value_at(p) + noise * random.normal();
        made.values.push_back(static_cast<float>(std::round(std::max(0.0, value))));
      }
  const std::filesystem::path path = call.output_path("ornament.nrrd");
  io::write_nrrd(path, made);
  manifest::Volume entry;
  entry.file = manifest::add_file(call.document, path, "ornament-volume");
  entry.size = {side, side, side}, entry.spacing_m = {voxel_m, voxel_m, voxel_m}, entry.type = "uint16";
  call.document.volumes["ornament"] = std::move(entry);
}

}  // namespace gonio::tools::ct_mesh_clean
