// The module optical_flow (base/loaded_library.h): OpenCV's, whose library brings networks and protobuf along.
#pragma once
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

extern "C" {
// As cv::buildOpticalFlowPyramid and cv::calcOpticalFlowPyrLK (Bouguet 2001) with OpenCV's own defaults.
void gonio_flow_pyramid(const cv::Mat& picture, std::vector<cv::Mat>& pyramid, cv::Size window, int levels);
void gonio_flow(const std::vector<cv::Mat>& from_pyramid, const std::vector<cv::Mat>& to_pyramid,
                const std::vector<cv::Point2f>& from, std::vector<cv::Point2f>& to, std::vector<std::uint8_t>& found,
                cv::Size window, int levels);
}
