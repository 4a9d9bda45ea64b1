// cv::imdecode and cv::imencode, whose library is loaded when the first picture is read or written: it brings GDAL and
// 60 libraries behind it, 40 of the 75 ms that a program would take to start, and most runs never open a picture.
#pragma once
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace gonio::io {

// As cv::imdecode(bytes, flags, &picture): into the memory that `picture` has, where size and type fit. What cannot be
// decoded leaves an empty result, or cv::Exception.
cv::Mat decode_by_opencv(const std::string& bytes, int flags, cv::Mat& picture);
bool encode_by_opencv(const std::string& extension, const cv::Mat& picture, std::vector<std::uint8_t>& bytes,
                      const std::vector<int>& parameters);

}  // namespace gonio::io
