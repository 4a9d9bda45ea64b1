// What the layers of an archive will print: read from the last one down, cured, with the printer's noise; a relief and
// a mesh of it.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "manifest/sections/ground_noise.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/relief.h"
#include "relief/document.h"
#include "relief/measured.h"
#include "tools/dlp-slice/work.h"

namespace gonio::tools::dlp_slice {
namespace {

constexpr std::size_t most_points = std::size_t{1} << 26;

print::PixelBox window_of(const Work& work) {
  const print::PixelGrid grid = work.printer.grid();
  if (!work.call.given("window")) return {0, 0, grid.width_px, grid.height_px};
  const std::vector<double> w = lengths_of(work.call.text("window"), 4, "--window");
  const auto pixel = [](double m, double corner, double size, int count) {
    return std::clamp(static_cast<int>(std::lround((m - corner) / size)), 0, count);
  };
  const print::PixelBox box{pixel(w[0], grid.corner_m.x, grid.pixel_m.x, grid.width_px),
                            pixel(w[1], grid.corner_m.y, grid.pixel_m.y, grid.height_px),
                            pixel(w[0] + w[2], grid.corner_m.x, grid.pixel_m.x, grid.width_px),
                            pixel(w[1] + w[3], grid.corner_m.y, grid.pixel_m.y, grid.height_px)};
  if (box.empty())
    throw Error(Exit::usage, "--window", "lies outside of the picture, or is empty",
                "give X,Y,WIDTH,HEIGHT on the platform");
  return box;
}

// The display's picture as light over the print's pixels.
std::vector<float> light_of(const std::vector<std::uint8_t>& picture, const print::Job& job,
                            const print::PixelBox& box) {
  std::vector<float> light;
  const bool flip_x = job.mirror_x.value_or(false), flip_y = job.mirror_y.value_or(false);
  for (int y = box.y_begin; y < box.y_end; ++y) {
    const std::uint8_t* row =
        picture.data() + static_cast<std::ptrdiff_t>(flip_y ? y : job.height_px - 1 - y) * job.width_px;
    for (int x = box.x_begin; x < box.x_end; ++x) light.push_back(row[flip_x ? job.width_px - 1 - x : x] / 255.0f);
  }
  return light;
}

// Of the part of the window that any layer lights, as wide as light spreads about it.
print::PixelBox lit_box(print::ArchiveReader& archive, const print::PixelBox& window, const print::Job& job) {
  std::vector<std::uint8_t> picture(static_cast<std::size_t>(job.width_px) * static_cast<std::size_t>(job.height_px));
  print::PixelBox lit{window.x_end, window.y_end, window.x_begin, window.y_begin};
  for (std::size_t k = 0; k < archive.layers(); ++k) {
    archive.read(k, picture);
    const std::vector<float> light = light_of(picture, job, window);
    const int wide = window.x_end - window.x_begin;
    for (std::size_t i = 0; i < light.size(); ++i)
      if (light[i] > 0) {
        const int x = window.x_begin + static_cast<int>(i) % wide, y = window.y_begin + static_cast<int>(i) / wide;
        lit.x_begin = std::min(lit.x_begin, x), lit.x_end = std::max(lit.x_end, x + 1);
        lit.y_begin = std::min(lit.y_begin, y), lit.y_end = std::max(lit.y_end, y + 1);
      }
  }
  constexpr int margin = 4;
  return {std::max(window.x_begin, lit.x_begin - margin), std::max(window.y_begin, lit.y_begin - margin),
          std::min(window.x_end, lit.x_end + margin), std::min(window.y_end, lit.y_end + margin)};
}

}  // namespace

std::optional<print::GroundAt> ground_asked(Work& work) {
  const std::string name = work.call.given("ground") ? work.call.text("ground") : work.entry().ground;
  if (name.empty() || name == "none") return {};
  if (name == "published") return print::published_ground();
  const auto found = work.call.document.ground_noises.find(name);
  if (found == work.call.document.ground_noises.end())
    throw Error(Exit::data, "--ground", "\"" + name + "\" is not in ground_noises",
                "fit it: relief ground-noise; or name none, published");
  return print::ground_of(found->second, work.call.seed);
}

void check_prediction(Work& work) {
  window_of(work);
  ground_asked(work);
}

void predict(Work& work) {
  const std::unique_ptr<print::ArchiveReader> archive = print::open_archive(work.archive);
  print::Job job = archive->job();
  if (job.width_px != work.printer.width_px || job.height_px != work.printer.height_px)
    throw Error(Exit::data, work.archive.string(),
                format("has pictures of %d x %d pixels, the printer %d x %d", job.width_px, job.height_px,
                       work.printer.width_px, work.printer.height_px),
                "name the printer that it is for");
  if (!job.mirror_x) job.mirror_x = work.call.text("mirror").find('x') != std::string::npos;
  if (!job.mirror_y) job.mirror_y = work.call.text("mirror").find('y') != std::string::npos;
  const int points = static_cast<int>(work.call.integer("points"));
  const print::PixelBox box = lit_box(*archive, window_of(work), job);
  if (box.empty())
    throw Error(Exit::data, work.archive.string(), "lights nothing in the window", "choose another window");
  const std::size_t pixels =
      static_cast<std::size_t>(box.x_end - box.x_begin) * static_cast<std::size_t>(box.y_end - box.y_begin);
  if (pixels * static_cast<std::size_t>(points * points) > most_points)
    throw Error(
        Exit::data, "--points",
        format("makes %zu points, %zu are the most", pixels * static_cast<std::size_t>(points * points), most_points),
        "take fewer, or a smaller --window");
  std::vector<double> bottoms{0};
  for (std::size_t k = 0; k < archive->layers(); ++k) bottoms.push_back(bottoms.back() + work.printer.thickness_m(k));
  print::Cure cure(work.printer, box, points);
  std::vector<std::uint8_t> picture(static_cast<std::size_t>(job.width_px) * static_cast<std::size_t>(job.height_px));
  Progress progress("cure", archive->layers());
  for (std::size_t k = archive->layers(); k-- > 0; progress.advance()) {
    archive->read(k, picture);
    cure.add(light_of(picture, job, box), bottoms[k], bottoms[k + 1]);
    throw_if_interrupted();
  }
  work.predicted = cure.surface();
  if (const auto ground = ground_asked(work)) print::add_ground(*work.predicted, *ground);
  const io::HeightMap map = print::height_map_of(*work.predicted);
  const std::filesystem::path to = work.call.output_path("predicted.x3p"),
                              shape = work.call.output_path("predicted.ply");
  io::write_height_map(to, map);
  manifest::Print& entry = work.entry();
  entry.relief = relief::enter_map(work.call.document, to, map);
  io::write_ply(shape, print::mesh_of(*work.predicted));
  entry.mesh = "predicted";
  work.call.document.meshes[entry.mesh] =
      manifest::Mesh{.file = manifest::add_file(work.call.document, shape, entry.mesh),
                     .sphere_radius_m = {},
                     .plane_size_m = {},
                     .normals = "smooth"};
}

}  // namespace gonio::tools::dlp_slice
