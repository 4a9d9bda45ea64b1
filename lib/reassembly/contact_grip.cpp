// What of the soft mesh has to give way: see contact_overlay.h.
#include <algorithm>

#include "reassembly/contact_overlay.h"

namespace gonio::reassembly::contact {

Grip grip_of(const Layered& soft, const Layered& hard, std::span<const std::uint32_t> meeting_faces, double window) {
  Grip grip{std::vector<std::uint8_t>(soft.at.size(), 0), std::vector<std::uint8_t>(soft.faces.size(), 0), 0, {}};
  const std::vector<Column> column = columns(soft.at, hard, window);
  std::vector<std::uint32_t> reached;
  const auto take = [&](std::uint32_t v) {
    if (grip.captive[v] != 0 || !(column[v].exit > 0)) return;
    grip.captive[v] = 1;
    reached.push_back(v);
  };
  std::vector<std::uint8_t> used(soft.at.size(), 0);
  for (const auto& face : soft.faces)
    for (const std::uint32_t v : face) used[v] = 1;
  for (std::uint32_t v = 0; v < soft.at.size(); ++v) {
    if (used[v] == 0 || !column[v].inside) continue;
    ++grip.inside;
    take(v);
    if (grip.captive[v] == 0) grip.stuck.push_back(v);
  }
  for (const std::uint32_t f : meeting_faces) {
    grip.gripped[f] = 1;
    for (const std::uint32_t v : soft.faces[f]) take(v);
  }
  std::vector<std::vector<std::uint32_t>> neighbours(soft.at.size());
  for (const auto& [a, b] : edges_of(soft.faces)) {
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  }
  for (std::size_t k = 0; k < reached.size(); ++k)
    for (const std::uint32_t w : neighbours[reached[k]]) take(w);
  for (std::size_t f = 0; f < soft.faces.size(); ++f)
    for (const std::uint32_t v : soft.faces[f])
      if (grip.captive[v] != 0) grip.gripped[f] = 1;
  return grip;
}

}  // namespace gonio::reassembly::contact
