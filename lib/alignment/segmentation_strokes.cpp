// Segmentation by a user's strokes: OpenCV's GrabCut. See segmentation.h.
#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "alignment/segmentation.h"
#include "alignment/segmentation_field.h"
#include "base/error.h"

namespace gonio::alignment {
namespace {

constexpr int iterations = 5;    // of learning and cutting
constexpr double white = 0.995;  // quantile that becomes full scale: highlights say nothing of either side

// 8-bit tones in even steps for the eye; grey pictures three times the same.
cv::Mat tones(const io::Image& picture, const std::string& place) {
  const LampPicture taken = take_picture(picture, {}, place);
  const auto channels = static_cast<std::size_t>(colour_channels(picture, place));
  std::vector<float> sorted = taken.value;
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(white * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), at, sorted.end());
  const double full = std::max(static_cast<double>(*at), 1e-30);
  cv::Mat result(picture.height, picture.width, CV_8UC3);
  for (std::size_t p = 0; p < picture.pixels(); ++p)
    for (std::size_t c = 0; c < 3; ++c) {
      const double v =
          std::clamp(static_cast<double>(taken.value[p * channels + std::min(c, channels - 1)]) / full, 0.0, 1.0);
      result.data[3 * p + c] = static_cast<unsigned char>(std::lround(255 * std::pow(v, 1 / 2.2)));
    }
  return result;
}

// 1 per pixel in front, of what the mask leaves open.
std::vector<std::uint8_t> grab(const cv::Mat& picture, cv::Mat mask) {
  cv::Mat behind, front;
  cv::theRNG().state = 0x9e3779b97f4a7c15U;  // the start of its clusters: the same for the same strokes
  cv::grabCut(picture, mask, {}, behind, front, iterations, cv::GC_INIT_WITH_MASK);
  std::vector<std::uint8_t> result(mask.total());
  for (std::size_t p = 0; p < result.size(); ++p)
    result[p] = mask.data[p] == cv::GC_FGD || mask.data[p] == cv::GC_PR_FGD;
  return result;
}

// Strokes as GrabCut takes them, `front` said of each label: what is open begins on the side whose stroke is nearer, so
// that neither side's colours are first learned from the other's.
cv::Mat mask_of(const io::Image& picture, std::span<const Label> strokes, const std::function<bool(Label)>& front) {
  cv::Mat off_front(picture.height, picture.width, CV_8U, cv::Scalar(1)), off_behind = off_front.clone();
  for (std::size_t p = 0; p < strokes.size(); ++p)
    if (strokes[p] != Label::unknown) (front(strokes[p]) ? off_front : off_behind).data[p] = 0;
  cv::Mat to_front, to_behind, mask(picture.height, picture.width, CV_8U);
  cv::distanceTransform(off_front, to_front, cv::DIST_L2, cv::DIST_MASK_5);
  cv::distanceTransform(off_behind, to_behind, cv::DIST_L2, cv::DIST_MASK_5);
  for (std::size_t p = 0; p < strokes.size(); ++p) {
    const bool nearer = to_front.ptr<float>()[p] < to_behind.ptr<float>()[p];
    mask.data[p] = static_cast<unsigned char>(!off_front.data[p]    ? cv::GC_FGD
                                              : !off_behind.data[p] ? cv::GC_BGD
                                              : nearer              ? cv::GC_PR_FGD
                                                                    : cv::GC_PR_BGD);
  }
  return mask;
}

// The object among `things`, which are it and its shadow. What is around them is filled with colours of the shadow's
// strokes, so that what lies behind is the shadow alone: among much ground it would hardly count.
std::vector<std::uint8_t> grab_object(const cv::Mat& picture, cv::Mat mask, std::span<const Label> strokes,
                                      const std::vector<std::uint8_t>& things) {
  std::vector<std::size_t> shadow;
  for (std::size_t p = 0; p < strokes.size(); ++p)
    if (strokes[p] == Label::shadow) shadow.push_back(p);
  cv::Mat filled = picture.clone();
  for (std::size_t p = 0; p < strokes.size(); ++p) {
    if (things[p]) continue;
    const std::size_t from = shadow[(p * 7919) % shadow.size()];
    for (std::size_t c = 0; c < 3; ++c) filled.data[3 * p + c] = picture.data[3 * from + c];
    mask.data[p] = cv::GC_BGD;
  }
  return grab(filled, mask);
}

}  // namespace

Segmentation segment_by_strokes(const io::Image& picture, std::span<const Label> strokes, const std::string& place) {
  if (strokes.size() != picture.pixels())
    throw Error(Exit::data, place, "the strokes have another size than the picture", "draw them on this picture");
  const auto drawn = [&](Label label) { return std::count(strokes.begin(), strokes.end(), label); };
  constexpr std::ptrdiff_t least = 10;  // five clusters of colours on each side
  if (drawn(Label::object) < least || drawn(Label::ground) < least)
    throw Error(Exit::data, place, "fewer than 10 pixels are marked as object or as ground", "draw over both");
  const bool shadowed = drawn(Label::shadow) >= least;
  const cv::Mat colours = tones(picture, place);
  const std::vector<std::uint8_t> things = grab(colours, mask_of(picture, strokes, [&](Label label) {
                                                  return label == Label::object || (shadowed && label == Label::shadow);
                                                }));
  const std::vector<std::uint8_t> object =
      shadowed ? grab_object(colours, mask_of(picture, strokes, [](Label label) { return label == Label::object; }),
                             strokes, things)
               : things;
  Segmentation result{picture.width, picture.height, std::vector<Label>(strokes.size()), {}, {}, 1};
  for (std::size_t p = 0; p < strokes.size(); ++p) {
    result.labels[p] = object[p] ? Label::object : things[p] ? Label::shadow : Label::ground;
    result.object_share.push_back(object[p] ? 1.0f : 0.0f);
  }
  clean(result);
  check_object(result, place);
  return result;
}

}  // namespace gonio::alignment
