// What stands round the pieces: the background gives way to them, and gets its surfaces.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "manifest/sections/placement.h"
#include "mesh/pixel_neighbours.h"
#include "tools/reassemble/work.h"

namespace gonio::tools::reassemble {
namespace {

manifest::Placement* placement_of(Work& work, const std::string& object) {
  for (manifest::Placement& p : work.call.document.placements)
    if (p.object == object) return &p;
  return nullptr;
}

void press_one(Work& work, const std::string& object) {
  const io::TriangleMesh hard = placed_mesh(work, object);
  reassembly::ContactWish wish;
  wish.yield = *work.asked.contact;
  wish.deepest_m = work.asked.deepest_m;
  const reassembly::Contact contact = reassembly::give_way(work.background, hard, wish, object);
  const std::string how = wish.yield == reassembly::Yield::push ? "push" : "elastic";
  if (!contact.refused.empty()) {
    work.complaints.push_back(object + ": the background does not give way: " + contact.refused);
    work.contacts.push_back({object, "background", how, contact.refused});
    return;
  }
  work.background = contact.soft;
  work.contacts.push_back(
      {object, "background", how,
       contact.moved.empty()
           ? "does not intersect"
           : format("%zu vertices gave way, %.3g mm at most, %.3g mm in the mean; %.3g mm^3 were swept; intersecting "
                    "triangles %zu -> %zu",
                    contact.moved.size(), 1e3 * contact.deepest_m, 1e3 * contact.mean_m, 1e9 * contact.volume_m3,
                    contact.pairs_before, contact.pairs_after)});
  if (contact.moved.empty()) return;
  if (manifest::Placement* entry = placement_of(work, object))
    entry->contacts.push_back(
        {.object = "background",
         .how = how,
         .deepest_m = contact.deepest_m,
         .volume_m3 = contact.volume_m3,
         .pairs = {static_cast<double>(contact.pairs_before), static_cast<double>(contact.pairs_after)}});
}

// A scan that says which pixel saw each point (structured-light) needs no faces of its own.
io::TriangleMesh read_background(const std::string& path) {
  io::TriangleMesh read = io::read_ply(path, {.properties = {"pixel_x", "pixel_y"}});
  if (read.triangles.empty() && !read.properties[0].empty() && !read.properties[1].empty()) {
    std::vector<Vec2> pixels;
    for (std::size_t i = 0; i < read.positions_m.size(); ++i)
      pixels.push_back({double{read.properties[0][i]}, double{read.properties[1][i]}});
    read = mesh::joined_neighbours(read.positions_m, pixels);
  }
  read.properties.clear();
  if (read.triangles.empty())
    throw Error(Exit::data, path, "has no faces", "a cloud of points is no background: mesh it first");
  return read;
}

}  // namespace

void take_background(Work& work) {
  if (work.asked.background.empty()) return;
  work.call.note_input(work.asked.background);
  work.background = read_background(work.asked.background);
  const bool said = manifest::has_entry(work.call.document, "surfaces", work.asked.background_surface);
  const std::string surface = said                                ? work.asked.background_surface
                              : work.asked.label_surfaces.empty() ? std::string()
                                                                  : work.asked.label_surfaces.front();
  enter_mesh(work, "background", work.background, surface);
}

void press(Work& work) {
  if (work.asked.background.empty()) return;
  if (work.asked.contact)
    for (const reassembly::Placed& placed : work.placement.pieces)
      if (placed.verdict == reassembly::Verdict::placed) press_one(work, placed.object);
  if (work.asked.contact) enter_mesh(work, "background", work.background, {});
}

}  // namespace gonio::tools::reassemble
