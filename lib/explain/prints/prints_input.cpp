// See prints_problem.h: from the manifest to pictures and maps.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "explain/prints/prints_problem.h"
#include "explain/switched_on.h"
#include "manifest/document.h"
#include "manifest/sections/print.h"
#include "manifest/sections/relief.h"
#include "print/archive.h"
#include "relief/document.h"

namespace gonio::explain {
namespace {

constexpr int beside_px = 8;  // of light that reaches the maps
constexpr int most_pixels = 512 * 512;

PrintedMap map_of(const manifest::Document& document, const manifest::MeasuredPrint& measured) {
  const manifest::ReliefMap& relief = document.reliefs.at(measured.relief);
  PrintedMap map;
  map.relief = measured.relief, map.place = manifest::place(document, "/reliefs/" + measured.relief);
  if (relief.file.empty())
    throw Error(Exit::data, map.place, "names no file", "give the height map: \"file\": id of a .sur, .x3p, ...");
  map.map = io::read_height_map(manifest::resolve(document, relief.file, "/reliefs/" + measured.relief + "/file"),
                                relief::picture_of(relief));
  map.at_m = {measured.at_m.at(0), measured.at_m.at(1)}, map.turn_rad = measured.turn_rad;
  return map;
}

// Pixels that the maps lie on, and some beside.
print::PixelBox box_of(const print::Printer& printer, const std::vector<PrintedMap>& maps, const std::string& place) {
  const print::PixelGrid grid = printer.grid();
  Vec2 least{1e300, 1e300}, most{-1e300, -1e300};
  for (const PrintedMap& map : maps)
    for (const std::size_t x : {std::size_t{0}, map.map.width - 1})
      for (const std::size_t y : {std::size_t{0}, map.map.height - 1}) {
        const Vec2 p = map.at(x, y);
        least = {std::min(least.x, p.x), std::min(least.y, p.y)};
        most = {std::max(most.x, p.x), std::max(most.y, p.y)};
      }
  const auto pixel = [&](double p, double corner, double size, int beside, int end) {
    return static_cast<int>(std::clamp(std::floor((p - corner) / size) + beside, 0.0, static_cast<double>(end)));
  };
  const print::PixelBox box{pixel(least.x, grid.corner_m.x, grid.pixel_m.x, -beside_px, grid.width_px),
                            pixel(least.y, grid.corner_m.y, grid.pixel_m.y, -beside_px, grid.height_px),
                            pixel(most.x, grid.corner_m.x, grid.pixel_m.x, beside_px + 1, grid.width_px),
                            pixel(most.y, grid.corner_m.y, grid.pixel_m.y, beside_px + 1, grid.height_px)};
  if (box.empty() || most.x < grid.corner_m.x || most.y < grid.corner_m.y)
    throw Error(
        Exit::data, place + "/measured/0/at_m", "puts the map beside the projector's picture",
        format("the picture reaches from %.4g, %.4g m to the opposite of that", grid.corner_m.x, grid.corner_m.y));
  if (static_cast<long>(box.x_end - box.x_begin) * (box.y_end - box.y_begin) > most_pixels)
    throw Error(Exit::data, place + "/measured",
                format("covers %d x %d pixels, and explain takes at most 512 x 512", box.x_end - box.x_begin,
                       box.y_end - box.y_begin),
                "measure, or crop the map to, a part of it");
  return box;
}

std::unique_ptr<print::ArchiveReader> open_layers(const manifest::Document& document, const std::string& name) {
  const std::string at = "/prints/" + name + "/layers";
  const std::string& id = document.prints.at(name).layers;
  if (id.empty())
    throw Error(Exit::data, manifest::place(document, at), "is missing",
                "name the archive that was sent, or the first of a folder's numbered PNG files");
  const std::filesystem::path path = manifest::resolve(document, id, at);
  if (path.extension() != ".png") return print::open_archive(path);
  return print::open_archive(path.has_parent_path() ? path.parent_path() : std::filesystem::path("."));
}

std::vector<std::vector<float>> layers_of(print::ArchiveReader& archive, const print::Printer& printer,
                                          const print::PixelBox& box) {
  const int width = archive.job().width_px, height = archive.job().height_px;
  if (width != printer.width_px || height != printer.height_px)
    throw Error(
        Exit::data, printer.place + "/layers",
        format("has pictures of %d x %d pixels, the print %d x %d", width, height, printer.width_px, printer.height_px),
        "name what was sent to this printer");
  std::vector<std::uint8_t> picture(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::vector<std::vector<float>> layers;
  for (std::size_t k = 0; k < archive.layers(); ++k) {
    archive.read(k, picture);
    std::vector<float>& layer = layers.emplace_back();
    for (int y = box.y_begin; y < box.y_end; ++y)
      for (int x = box.x_begin; x < box.x_end; ++x)
        layer.push_back(
            static_cast<float>(
                picture[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)]) /
            255);
  }
  return layers;
}

PrintsInput read_input(const manifest::Document& document, const std::string& name) {
  PrintsInput input;
  input.name = name;
  prints::Sent& sent = input.sent;
  sent.printer = print::printer_of(document, name);
  input.place = sent.printer.place;
  for (const manifest::MeasuredPrint& measured : document.prints.at(name).measured)
    input.maps.push_back(map_of(document, measured));
  sent.box = box_of(sent.printer, input.maps, input.place);
  const print::PixelGrid grid = sent.printer.grid();
  sent.corner_m = grid.corner_m + Vec2{sent.box.x_begin * grid.pixel_m.x, sent.box.y_begin * grid.pixel_m.y};
  for (const PrintedMap& map : input.maps)
    sent.centre_m = sent.centre_m + (map.at(0, 0) + map.at(map.map.width - 1, map.map.height - 1)) *
                                        (0.5 / static_cast<double>(input.maps.size()));
  sent.layers = layers_of(*open_layers(document, name), sent.printer, sent.box);
  input.given = switched_on_for(document, "prints", input.name);
  return input;
}

}  // namespace

Vec2 PrintedMap::at(std::size_t column, std::size_t row) const {
  const double x = static_cast<double>(column) * map.step_x_m, y = -static_cast<double>(row) * map.step_y_m;
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  return at_m + Vec2{c * x - s * y, s * x + c * y};
}

bool has_prints(const manifest::Document& document) {
  return std::ranges::any_of(document.prints, [](const auto& p) { return !p.second.measured.empty(); });
}

std::vector<PrintsInput> prints_inputs(const manifest::Document& document, const ProblemOptions&) {
  std::vector<PrintsInput> inputs;
  for (const auto& [name, print] : document.prints)
    if (!print.measured.empty()) inputs.push_back(read_input(document, name));
  return inputs;
}

std::vector<std::filesystem::path> prints_files(const manifest::Document& document) {
  std::vector<std::filesystem::path> files;
  for (const auto& [name, print] : document.prints) {
    if (print.measured.empty()) continue;
    if (!print.layers.empty())
      files.push_back(manifest::resolve(document, print.layers, "/prints/" + name + "/layers"));
    for (const manifest::MeasuredPrint& measured : print.measured)
      files.push_back(manifest::resolve(document, document.reliefs.at(measured.relief).file,
                                        "/reliefs/" + measured.relief + "/file"));
  }
  return files;
}

}  // namespace gonio::explain
