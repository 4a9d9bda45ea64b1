// See gather.h.
#include "glass/gather.h"

#include <array>
#include <optional>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "glass/make_cell.h"
#include "glass/tensors.h"
#include "io/exr.h"
#include "manifest/image_list.h"
#include "render/session.h"

namespace gonio::glass {
namespace {

constexpr std::array shares{Share::training, Share::validation, Share::test};

std::map<Share, std::size_t> count_made(const GlassSet& set) {
  std::map<Share, std::size_t> count;
  std::size_t missing = 0;
  std::string first;
  for (std::size_t n = 0; n < set.cells(); ++n) {
    throw_if_interrupted();
    const Cell cell = set.cell(n);
    ++count[cell.share];
    if (is_made(set, cell)) continue;
    if (missing++ == 0) first = set.folder_of(cell).string();
  }
  if (missing > 0)
    throw Error(Exit::data, first, format("is not made, nor are %zu others of %zu cells", missing - 1, set.cells()),
                "make them first: the same call without --gather, or in shards");
  return count;
}

void add_facts(CellRow& row, const GlassSet& set, const Cell& cell) {
  for (const std::string& image : manifest::names_in(cell.scene, "images")) {
    const std::filesystem::path path = set.folder_of(cell) / (image + ".exr");
    const auto facts = render::facts_in(io::exr_attributes(read_file(path), path.string()));
    if (!facts) throw Error(Exit::data, path.string(), "does not say how it was rendered", "make the cell anew");
    row.relative_error[image] = facts->relative_error;
    row.spp[image] = static_cast<double>(facts->samples());
  }
}

}  // namespace

Gathered gather(const GlassSet& set, const std::filesystem::path& folder, const std::function<void()>& on_cell) {
  const std::map<Share, std::size_t> count = count_made(set);
  std::map<Share, TensorFiles> files;
  for (const Share share : shares)
    files.try_emplace(share, folder / "tensors", share, count.contains(share) ? count.at(share) : 0,
                      set.wish().width_px, set.wish().height_px);
  Gathered all;
  for (std::size_t n = 0; n < set.cells(); ++n) {
    throw_if_interrupted();
    const Cell cell = set.cell(n);
    CellRow row{n, cell.object, cell.view, cell.share, cell.name, cell.facts, 0, 0, 0, {}, {}};
    const auto tensors = tensors_of(set, cell);
    files.at(cell.share).append(tensors);
    row.coverage = coverage_of(tensors.at("mask"));
    const RayDepth depth = ray_depth(cell);
    row.mean_interfaces = depth.mean, row.most_interfaces = depth.largest;
    all.interfaces.resize(std::max(all.interfaces.size(), depth.count.size()));
    for (std::size_t i = 0; i < depth.count.size(); ++i) all.interfaces[i] += depth.count[i];
    add_facts(row, set, cell);
    all.rows.push_back(std::move(row));
    on_cell();
  }
  for (const Share share : shares)
    for (const auto& path : files.at(share).commit()) all.tensors.push_back(path);
  return all;
}

std::string table_of(const Gathered& gathered) {
  std::set<std::string> facts, images;
  for (const CellRow& row : gathered.rows) {
    for (const auto& [name, value] : row.facts) facts.insert(name);
    for (const auto& [name, value] : row.spp) images.insert(name);
  }
  std::string text = "number,name,share,object,view";
  for (const std::string& name : facts) text += "," + name;
  text += ",coverage,mean_interfaces,most_interfaces";
  for (const std::string& image : images) text += "," + image + "_spp," + image + "_relative_error";
  text += "\n";
  for (const CellRow& row : gathered.rows) {
    text += format("%zu,%s,%s,%zu,%zu", row.number, row.name.c_str(), name_of(row.share), row.object, row.view);
    for (const std::string& name : facts) text += "," + (row.facts.contains(name) ? row.facts.at(name) : "");
    text += format(",%.6f,%.4f,%d", row.coverage, row.mean_interfaces, row.most_interfaces);
    for (const std::string& image : images)
      text += format(",%.0f,%.5f", row.spp.at(image), row.relative_error.at(image));
    text += "\n";
  }
  return text;
}

}  // namespace gonio::glass
