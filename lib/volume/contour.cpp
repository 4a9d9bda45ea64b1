#include "volume/contour.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "volume/polygons.h"

namespace gonio::volume {
namespace {

constexpr std::size_t largest_axis = 8190;  // beyond, single precision does not keep vertices within their cells

std::string place_of(const io::VolumeHead& head) {
  return head.files.empty() ? "volume" : head.files.front().string();
}

class Contouring {
 public:
  Contouring(io::VolumeSource& source, const ContourWish& wish)
      : size_(source.head().size), place_(place_of(source.head())), wish_(wish), window_(source, wish.threshold, 4) {
    for (CellLayer& layer : layers_) {
      layer.columns = size_[0] + 1;
      layer.row_first.assign(size_[1] + 2, 0);
      layer.place.resize(layer.columns * (size_[1] + 1));
    }
    drawn_.resize((size_[1] + rows_at_once) / rows_at_once);
  }

  Contour run() {
    // Layer size_[2] + 1 has no cells: it is there for the faces below it.
    for (std::size_t layer = 0; layer <= size_[2] + 1; ++layer) {
      if (layer <= size_[2]) {
        window_.advance_to(std::min(layer + 1, size_[2] - 1));
        find_cells(window_, layer, wish_.inside == Connectivity::six ? 0 : 255, here());
      } else {
        clear(here());
      }
      place_vertices(layer);
      draw(layer);
      std::rotate(order_.begin(), order_.begin() + 1, order_.end());
    }
    return std::move(made_);
  }

 private:
  CellLayer& here() { return layers_[order_[2]]; }
  static void clear(CellLayer& layer) {
    layer.cells.clear();
    std::fill(layer.row_first.begin(), layer.row_first.end(), 0u);
  }

  // Room for vertices that are about to be added; the number of the first.
  std::uint32_t add_vertices(std::size_t count) {
    const std::size_t before = made_.positions.size();
    if (count > std::numeric_limits<std::uint32_t>::max() - before)
      throw Error(Exit::data, place_, "its surface at this threshold needs more than 4294967295 vertices",
                  "choose a threshold outside the noise, or denoise first");
    made_.positions.resize(before + count);
    made_.normals.resize(before + count);
    return static_cast<std::uint32_t>(before);
  }

  void place_vertices(std::size_t layer) {
    std::size_t count = 0;
    for (Cell& cell : here().cells) {
      const CellCase& kind = cell.kind();
      cell.first_vertex = static_cast<std::uint32_t>(count);
      count += kind.sheets;
      if (kind.shared) ++made_.shared_cells;
    }
    if (here().cells.empty()) return;
    const std::uint32_t first = add_vertices(count);
    const VertexWish wish{wish_.threshold, wish_.sharpness, wish_.hermite};
    const auto place_row = [&](std::size_t row) {
      if (here().row_first[row] == here().row_first[row + 1]) return;
      const RowsRound samples = rows_round(window_, size_, row, layer);
      for (std::uint32_t c = here().row_first[row]; c < here().row_first[row + 1]; ++c) {
        Cell& cell = here().cells[c];
        cell.first_vertex += first;
        const CellCase& kind = cell.kind();
        const Neighbourhood near = neighbourhood(samples, cell.column);
        for (std::size_t s = 0; s < kind.sheets; ++s) {
          const SheetVertex vertex = sheet_vertex(near, kind.sheet[s], wish);
          const Vec3 p =
              Vec3{cell.column - 1.0, static_cast<double>(row) - 1, static_cast<double>(layer) - 1} + vertex.point;
          made_.positions[cell.first_vertex + s] = {static_cast<float>(p.x), static_cast<float>(p.y),
                                                    static_cast<float>(p.z)};
          made_.normals[cell.first_vertex + s] = {static_cast<float>(vertex.normal.x),
                                                  static_cast<float>(vertex.normal.y),
                                                  static_cast<float>(vertex.normal.z)};
        }
      }
    };
    parallel_for(0, here().rows(), place_row, rows_at_once);
  }

  void draw(std::size_t layer) {
    Layers layers{{&layers_[order_[0]], &layers_[order_[1]], &here()},
                  layer,
                  made_.positions,
                  wish_.inside == Connectivity::six,
                  wish_.threshold};
    if (!here().cells.empty()) {
      each_stretch([&](std::size_t row, Drawn& drawn) {
        if (here().row_first[row] == here().row_first[row + 1]) return;
        draw_polygons(layers, row, rows_round(window_, size_, row, layer), drawn);
      });
      add_drawn();
    }
    const std::vector<Cell>& below = layers.layer[1]->cells;
    if (std::none_of(below.begin(), below.end(), [](const Cell& cell) { return cell.kind().marked; })) return;
    each_stretch([&](std::size_t row, Drawn& drawn) { draw_faces(layers, row, drawn); });
    add_drawn();
  }

  // Stretches of rows do not depend on the number of threads, nor does then the order of what they give.
  template <class Body>
  void each_stretch(const Body& body) {
    parallel_for(0, drawn_.size(), [&](std::size_t n) {
      drawn_[n].clear();
      const std::size_t last = std::min((n + 1) * rows_at_once, size_[1] + 1);
      for (std::size_t row = n * rows_at_once; row < last; ++row) body(row, drawn_[n]);
    });
  }

  void add_drawn() {
    std::vector<std::array<std::size_t, 2>> first(drawn_.size());  // crossing vertex, triangle
    std::size_t vertices = 0, triangles = made_.triangles.size();
    for (std::size_t n = 0; n < drawn_.size(); ++n) {
      first[n] = {vertices, triangles};
      vertices += drawn_[n].positions.size();
      triangles += drawn_[n].triangles.size() + drawn_[n].fans.size();
      made_.crossed_edges += drawn_[n].crossed_edges;
      made_.split_polygons += drawn_[n].split_polygons;
    }
    const std::size_t base = add_vertices(vertices);
    made_.triangles.resize(triangles);
    parallel_for(0, drawn_.size(), [&](std::size_t n) {
      const Drawn& drawn = drawn_[n];
      const std::size_t crossing = base + first[n][0];
      std::copy(drawn.positions.begin(), drawn.positions.end(),
                made_.positions.begin() + static_cast<std::ptrdiff_t>(crossing));
      std::copy(drawn.normals.begin(), drawn.normals.end(),
                made_.normals.begin() + static_cast<std::ptrdiff_t>(crossing));
      auto to = std::copy(drawn.triangles.begin(), drawn.triangles.end(),
                          made_.triangles.begin() + static_cast<std::ptrdiff_t>(first[n][1]));
      for (const Triangle& fan : drawn.fans) *to++ = {fan[0] + static_cast<std::uint32_t>(crossing), fan[1], fan[2]};
      if (drawn.positions.empty()) return;
      const std::size_t last = std::min((n + 1) * rows_at_once, size_[1] + 1);
      for (std::uint32_t c = here().row_first[n * rows_at_once]; c < here().row_first[last]; ++c)
        here().cells[c].first_crossing += static_cast<std::uint32_t>(crossing);
    });
  }

  std::array<std::size_t, 3> size_;
  std::string place_;
  ContourWish wish_;
  SampleWindow window_;
  std::array<CellLayer, 3> layers_;
  std::array<std::size_t, 3> order_{0, 1, 2};
  std::vector<Drawn> drawn_;
  Contour made_;
};

}  // namespace

Contour contour(io::VolumeSource& source, const ContourWish& wish) {
  const io::VolumeHead& head = source.head();
  for (const std::size_t count : head.size) {
    if (count == 0) return {};
    if (count > largest_axis)
      throw Error(Exit::data, place_of(head),
                  std::to_string(count) + " voxels along an axis (limit " + std::to_string(largest_axis) + ")",
                  "crop or bin the volume");
  }
  return Contouring(source, wish).run();
}

}  // namespace gonio::volume
