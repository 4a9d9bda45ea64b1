// Simulated heights as an instrument sees them: means over the square that a point of a map stands for, blurred by the
// instrument's resolution, a Gaussian. Lengths in cells, places from the field's outer corner; between knots, a twelfth
// of a cell apart, weights of the cells are linear: with a quarter, walls would stand wrong by 0.004 pixels.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "explain/prints/printed_field.h"

namespace gonio::explain::prints {

inline constexpr int knots_per_cell = 12;  // maps with points every half or third of a pixel are exact

// Weights of the cells about each of the knots of a cell: those from `-reach` to `reach` beside the one that it is in.
struct Weights {
  int reach = 0;
  std::array<std::vector<double>, knots_per_cell> of;
  Weights(double width_cells, double sigma_cells);
};

// One place after the other.
class Seen {
 public:
  Seen(const Field& field, Vec2 point_cells, double resolution_cells)
      : field_(field), along_(point_cells.x, resolution_cells), down_(point_cells.y, resolution_cells) {}
  double at(double x_cells, double y_cells) const;

 private:
  const Field& field_;
  Weights along_, down_;
};

// Means over the points of readings, all at once, with what moves them. Points of a reading that stand in the same rows
// and columns, as those of a map that is not turned do, share their weights.
class Sight {
 public:
  struct View {
    Vec2 shift_m{};    // of the map: what it shows lies so much less far
    Vec3 shrinkage{};  // z is not read
    Vec2 point_m{};    // that a point stands for
    double resolution_m = 0;
  };
  struct Slopes {  // by the view's shift, metre by metre, and resolution
    double shift_x = 0, shift_y = 0, resolution = 0;
  };
  // `points` of the platform, `count[i]` of them of reading i, one after the other.
  Sight(const Sent& sent, std::span<const Vec2> points, std::span<const std::uint32_t> count);
  // Mean heights over the platform, m, of each reading. Slopes where they are asked for.
  void heights(const Field& field, const View& view, std::vector<double>& mean_m, std::vector<Slopes>* slopes) const;

 private:
  using List = std::vector<double>;  // of coordinates, m
  struct Block {                     // points at the crossings of these columns and rows
    std::uint32_t columns = 0, rows = 0;
  };
  Vec2 corner_m_, centre_m_;
  std::vector<List> columns_, rows_;  // those that differ
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> first_;  // of blocks, of each reading
  std::vector<double> points_;        // of each reading
};

}  // namespace gonio::explain::prints
