// See corner_growth.h.
#include "camera/corner_growth.h"

#include <algorithm>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>

#include "stats/intervals.h"

namespace gonio::camera {
namespace {

constexpr double neighbourhood = 3.2;  // squares
constexpr std::size_t least_neighbours = 6;
constexpr double most_moved = 0.1, most_sigmas = 3;  // of a square; of the median sigma

// Where a corner would be; nothing where its neighbours are few, or on one line.
std::optional<Prediction> predict_beside(const std::vector<Corner>& corners, const Board& board, int id) {
  const Vec2 corner = board.corner_m(id);
  std::vector<std::pair<double, const Corner*>> near;
  for (const Corner& c : corners) {
    const double distance = norm(board.corner_m(c.id) - corner) / board.square_m;
    if (distance < neighbourhood) near.emplace_back(distance, &c);
  }
  if (near.size() < least_neighbours) return {};
  std::vector<cv::Point2f> from, to;
  for (const auto& [distance, c] : near) {
    const Vec2 at = (board.corner_m(c->id) - corner) * (1 / board.square_m);
    from.emplace_back(static_cast<float>(at.x), static_cast<float>(at.y));
    to.emplace_back(static_cast<float>(c->pixel.x), static_cast<float>(c->pixel.y));
  }
  const auto spread = cv::minAreaRect(from).size;
  if (std::min(spread.width, spread.height) < 0.9F) return {};
  const cv::Mat homography = cv::findHomography(from, to, 0);
  if (homography.empty()) return {};
  std::vector<cv::Point2f> p;
  cv::perspectiveTransform(std::vector<cv::Point2f>{{0, 0}, {0.5F, 0}, {-0.5F, 0}, {0, 0.5F}, {0, -0.5F}}, p,
                           homography);
  return Prediction{id, p[0], p[1] - p[2], p[3] - p[4], 0};
}

}  // namespace

void grow(const GreyPicture& picture, const Board& board, const Growth& growth, const DetectionOptions& options,
          std::vector<Corner>& corners) {
  for (int round = 0; round < growth.rounds && corners.size() >= least_neighbours; ++round) {
    std::vector<double> sigmas;
    std::set<int> present;
    for (const Corner& c : corners) {
      sigmas.push_back(c.sigma_px);
      present.insert(c.id);
    }
    const double usual = stats::median(sigmas);
    std::map<int, Prediction> predictions;
    std::vector<Prediction> list;
    for (int id = 0; id < board.corners(); ++id) {
      if (present.contains(id)) continue;
      auto p = predict_beside(corners, board, id);
      if (!p) continue;
      if (growth.bare != nullptr) p->bare = growth.bare(board, id, growth.legacy);
      predictions[id] = *p;
      list.push_back(*p);
    }
    std::size_t added = 0;
    for (const Corner& c : refine(picture.values, list, growth.clear_share, options)) {
      const Prediction& p = predictions.at(c.id);
      const double moved = cv::norm(cv::Point2d(c.pixel.x, c.pixel.y) - p.pixel);
      if (moved > most_moved * p.square_px() || c.sigma_px > most_sigmas * usual) continue;
      corners.push_back(c);
      ++added;
    }
    if (added == 0) break;
  }
  std::ranges::sort(corners, {}, &Corner::id);
}

}  // namespace gonio::camera
