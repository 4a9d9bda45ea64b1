// The thesis's way (2.E), for comparison: edges (Canny) close regions, their insides are the markers of a watershed,
// and each region gets the material whose colour is nearest to its median. Everything by OpenCV but the last step.
#pragma once
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "io/picture.h"
#include "reassembly/labels.h"

namespace gonio::tests {

// `shading`: what regions' colours are divided by; null: by the picture's mean over that of the materials.
inline reassembly::LabelPicture thesis_watershed(const io::Image& picture, const io::Image* shading,
                                                 const std::vector<reassembly::Material>& materials) {
  cv::Mat codes(picture.height, picture.width, CV_8UC3), grey, edges, markers, inside;
  double level = 0, believed = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (int c = 0; c < 3; ++c) {
        level += picture.at(x, y, c) / (3.0 * static_cast<double>(picture.pixels()));
        codes.at<cv::Vec3b>(y, x)[c] =
            cv::saturate_cast<unsigned char>(255 * io::srgb_from_linear(picture.at(x, y, c)));
      }
  for (const auto& m : materials) believed += mean(m.albedo) / static_cast<double>(materials.size());
  cv::cvtColor(codes, grey, cv::COLOR_RGB2GRAY);
  cv::GaussianBlur(grey, grey, {3, 3}, 0);
  cv::Canny(grey, edges, 25, 75);
  cv::dilate(edges, edges, cv::Mat());
  cv::bitwise_not(edges, inside);
  cv::connectedComponents(inside, markers, 4, CV_32S);
  cv::watershed(codes, markers);
  std::map<int, std::array<std::vector<float>, 3>> regions;
  const auto colour = [&](int x, int y, int c) {
    return picture.at(x, y, c) /
           (shading != nullptr ? std::max(shading->at(x, y, c), 1e-4f) : static_cast<float>(level / believed));
  };
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (int c = 0; c < 3; ++c)
        if (markers.at<int>(y, x) > 0)
          regions[markers.at<int>(y, x)][static_cast<std::size_t>(c)].push_back(colour(x, y, c));
  std::map<int, std::int32_t> names;
  for (auto& [region, values] : regions) {
    std::array<double, 3> log{};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto middle = values[c].begin() + static_cast<std::ptrdiff_t>(values[c].size() / 2);
      std::nth_element(values[c].begin(), middle, values[c].end());
      log[c] = std::log(std::max(*middle, 1e-4f));
    }
    double least = 1e9;
    for (std::size_t k = 0; k < materials.size(); ++k) {
      double square = 0;
      for (int c = 0; c < 3; ++c)
        square += std::pow(log[static_cast<std::size_t>(c)] - std::log(materials[k].albedo[c]), 2);
      if (square >= least) continue;
      least = square;
      names[region] = static_cast<std::int32_t>(k);
    }
  }
  reassembly::LabelPicture result{picture.width, picture.height, {}, std::vector<float>(picture.pixels(), 0.9f)};
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const int region = markers.at<int>(y, x);
      result.label.push_back(region > 0 ? names[region] : reassembly::unlabelled);
    }
  return result;
}

}  // namespace gonio::tests
