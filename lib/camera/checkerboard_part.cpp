// Parts of plain checkerboards: the board is cut off by the picture, covered by a hand, or over-exposed.
//
// A seed of a few squares (OpenCV's finder by sectors, Duda & Frese, BMVC 2018, told that the pattern may be larger)
// grows outwards as far as two crossing edges are found (corner_growth.h). The sheet of corners is then laid on the
// board: right-handed, the square inside the board's first four corners black, as many corners as possible on it. Where
// several places are left, the one is taken that leaves the fewest corners unseen that the picture should show; of
// those the one whose first corner lies nearest to the picture's top left.
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>
#include <tuple>

#include "camera/board_detectors.h"
#include "camera/checkerboard_grid.h"
#include "camera/corner_growth.h"

namespace gonio::camera {
namespace {

constexpr int search_sides_px[] = {1300, 2600};
constexpr int seeds[][2] = {{5, 4}, {4, 3}};  // columns, rows
constexpr double least_share = 0.4;           // of the board's corners

CornerGrid find_seed(const GreyPicture& picture) {
  double last_scale = 0;
  for (const int side : search_sides_px) {
    const Reduced small = reduced(picture, side);
    if (small.scale == last_scale) break;
    last_scale = small.scale;
    for (const auto& [columns, rows] : seeds) {
      std::vector<cv::Point2f> points;
      cv::Mat meta;
      if (!cv::findChessboardCornersSB(small.bytes, {columns, rows}, points,
                                       cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_LARGER,
                                       meta))
        continue;
      CornerGrid grid{meta.cols, meta.rows, {}};
      if (static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows) != points.size()) continue;
      for (const cv::Point2f p : points) grid.points.push_back(small.to_full(p));
      return right_handed(grid) ? grid : mirrored(grid);
    }
  }
  return {};
}

using Lattice = std::map<std::pair<int, int>, Corner>;  // by column and row of a sheet that knows no border

Lattice grown(const GreyPicture& picture, const Board& board, const CornerGrid& seed, const DetectionOptions& options) {
  const int margin = std::max(board.corner_columns, board.corner_rows);
  Board sheet = board;
  sheet.corner_columns = seed.columns + 2 * margin, sheet.corner_rows = seed.rows + 2 * margin;
  std::vector<Corner> corners = refine(picture.values, predictions_of(seed), 1, options);
  for (Corner& c : corners) c.id = (c.id / seed.columns + margin) * sheet.corner_columns + c.id % seed.columns + margin;
  Growth growth;
  growth.rounds = margin;
  grow(picture, sheet, growth, options, corners);
  Lattice lattice;
  for (const Corner& c : corners) lattice[{c.id % sheet.corner_columns, c.id / sheet.corner_columns}] = c;
  return lattice;
}

// The sheet on the board: turned by quarters, then shifted.
struct Place {
  int quarters = 0, columns = 0, rows = 0;
  std::pair<int, int> turned(int x, int y) const {
    switch (quarters) {
      case 1: return {-y, x};
      case 2: return {-x, -y};
      case 3: return {y, -x};
      default: return {x, y};
    }
  }
  std::pair<int, int> of(const std::pair<int, int>& corner) const {
    const auto [x, y] = turned(corner.first, corner.second);
    return {x + columns, y + rows};
  }
  // Of the square whose four corners are `corner` and those to its right and below it: its first corner on the board.
  std::pair<int, int> square_of(const std::pair<int, int>& corner) const {
    const auto a = of(corner), b = of({corner.first + 1, corner.second + 1});
    return {std::min(a.first, b.first), std::min(a.second, b.second)};
  }
};

// Brightness of the squares that should be white less that of the others, over all whose four corners are known.
class Squares {
 public:
  Squares(const cv::Mat& values, const Lattice& lattice) {
    for (const auto& [at, corner] : lattice) {
      const auto [x, y] = at;
      std::array<cv::Point2f, 4> around;
      std::size_t known = 0;
      for (const std::pair<int, int>& other :
           {std::pair{x, y}, std::pair{x + 1, y}, std::pair{x, y + 1}, std::pair{x + 1, y + 1}})
        if (const auto found = lattice.find(other); found != lattice.end())
          around[known++] = {static_cast<float>(found->second.pixel.x), static_cast<float>(found->second.pixel.y)};
      if (known == 4) squares_.push_back({at, mean_inside(values, around)});
    }
  }
  double contrast(const Place& place) const {
    double sum[2] = {0, 0};
    int count[2] = {0, 0};
    for (const auto& [at, value] : squares_) {
      const auto [x, y] = place.square_of(at);
      const int white = (x + y) & 1;
      sum[white] += value, ++count[white];
    }
    return count[0] > 0 && count[1] > 0 ? sum[1] / count[1] - sum[0] / count[0] : 0;
  }

 private:
  std::vector<std::pair<std::pair<int, int>, double>> squares_;
};

class Laying {
 public:
  Laying(const GreyPicture& picture, const Board& board, const Lattice& lattice)
      : picture_(picture), board_(board), lattice_(lattice), squares_(picture.values, lattice) {}

  std::vector<Corner> best() const {
    std::vector<Corner> corners;
    std::tuple<std::size_t, int, double> least{0, 0, 0};  // corners (negated), unseen ones, where the first lies
    bool any = false;
    const auto try_at = [&](const Place& place) {
      if (!(squares_.contrast(place) > 0)) return;
      std::vector<Corner> on = on_board(place);
      if (on.size() < least_corners()) return;
      const auto [unseen, first] = left_out(on);
      const std::tuple rank{lattice_.size() - on.size(), unseen, first};
      if (any && !(rank < least)) return;
      any = true, least = rank, corners = std::move(on);
    };
    for (int quarters = 0; quarters < 4; ++quarters) each_shift(quarters, try_at);
    return corners;
  }

 private:
  std::size_t least_corners() const {
    return static_cast<std::size_t>(std::ceil(least_share * static_cast<double>(board_.corners())));
  }

  template <class Try>
  void each_shift(int quarters, const Try& try_at) const {
    Place place{quarters, 0, 0};
    int left = 1 << 20, top = left, right = -left, bottom = right;
    for (const auto& [at, corner] : lattice_) {
      const auto [x, y] = place.of(at);
      left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
    }
    for (place.columns = -right; place.columns < board_.corner_columns - left; ++place.columns)
      for (place.rows = -bottom; place.rows < board_.corner_rows - top; ++place.rows) try_at(place);
  }

  std::vector<Corner> on_board(const Place& place) const {
    std::vector<Corner> on;
    for (const auto& [at, corner] : lattice_) {
      const auto [x, y] = place.of(at);
      if (x < 0 || y < 0 || x >= board_.corner_columns || y >= board_.corner_rows) continue;
      on.push_back(corner);
      on.back().id = y * board_.corner_columns + x;
    }
    std::ranges::sort(on, {}, &Corner::id);
    return on;
  }

  // Corners of the board that the picture should show and that are not among these; x + y of the first of all.
  std::pair<int, double> left_out(const std::vector<Corner>& on) const {
    std::vector<cv::Point2f> from, to, all, seen;
    for (const Corner& c : on) {
      from.emplace_back(static_cast<float>(board_.corner_m(c.id).x), static_cast<float>(board_.corner_m(c.id).y));
      to.emplace_back(static_cast<float>(c.pixel.x), static_cast<float>(c.pixel.y));
    }
    const cv::Mat homography = cv::findHomography(from, to, 0);
    if (homography.empty()) return {board_.corners(), 0};
    for (int id = 0; id < board_.corners(); ++id)
      all.emplace_back(static_cast<float>(board_.corner_m(id).x), static_cast<float>(board_.corner_m(id).y));
    cv::perspectiveTransform(all, seen, homography);
    const cv::Rect2f inside(0, 0, static_cast<float>(picture_.values.cols - 1),
                            static_cast<float>(picture_.values.rows - 1));
    const auto shown = std::ranges::count_if(seen, [&](const cv::Point2f& p) { return inside.contains(p); });
    return {static_cast<int>(shown) - static_cast<int>(on.size()), static_cast<double>(seen[0].x + seen[0].y)};
  }

  const GreyPicture& picture_;
  const Board& board_;
  const Lattice& lattice_;
  Squares squares_;
};

}  // namespace

Detection detect_checkerboard_part(const GreyPicture& picture, const Board& board, const DetectionOptions& options) {
  Detection result;
  const CornerGrid seed = find_seed(picture);
  if (seed.points.empty()) return result;
  const Lattice lattice = grown(picture, board, seed, options);
  if (lattice.empty()) return result;
  result.corners = Laying(picture, board, lattice).best();
  result.part = !result.corners.empty() && result.corners.size() < static_cast<std::size_t>(board.corners());
  return result;
}

}  // namespace gonio::camera
