#include "nrsfm/make/optical_flow_module.h"

#include <opencv2/video/tracking.hpp>

void gonio_flow_pyramid(const cv::Mat& picture, std::vector<cv::Mat>& pyramid, cv::Size window, int levels) {
  cv::buildOpticalFlowPyramid(picture, pyramid, window, levels);
}

void gonio_flow(const std::vector<cv::Mat>& from_pyramid, const std::vector<cv::Mat>& to_pyramid,
                const std::vector<cv::Point2f>& from, std::vector<cv::Point2f>& to, std::vector<std::uint8_t>& found,
                cv::Size window, int levels) {
  cv::calcOpticalFlowPyrLK(from_pyramid, to_pyramid, from, to, found, cv::noArray(), window, levels);
}
