#include "glass/net/onnx_module.h"

#include <algorithm>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>

namespace {

struct Kept {
  std::vector<char> bytes;
  cv::dnn::Net net;
};
Kept& kept() {
  static Kept one;
  return one;
}

}  // namespace

void gonio_onnx_answers(const std::vector<char>& bytes, const std::vector<float>& seen, std::size_t channels,
                        std::size_t height, std::size_t width, std::vector<float>& answers, std::size_t& channels_out,
                        std::size_t& height_out, std::size_t& width_out, std::string& error) {
  try {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // the exception says it
    Kept& here = kept();
    if (here.bytes != bytes) here = {bytes, cv::dnn::readNetFromONNX(bytes.data(), bytes.size())};
    const int size[] = {1, static_cast<int>(channels), static_cast<int>(height), static_cast<int>(width)};
    here.net.setInput(cv::Mat(4, size, CV_32F, const_cast<float*>(seen.data())));
    const cv::Mat out = here.net.forward();
    if (out.dims != 4 || out.type() != CV_32F) {
      error = "answers are no picture";
      return;
    }
    channels_out = static_cast<std::size_t>(out.size[1]);
    height_out = static_cast<std::size_t>(out.size[2]), width_out = static_cast<std::size_t>(out.size[3]);
    answers.assign(out.ptr<float>(), out.ptr<float>() + out.total());
  } catch (const std::exception& e) {
    error = e.what();
    std::replace(error.begin(), error.end(), '\n', ' ');
  }
}

void gonio_onnx_threads(int count) {
  cv::setNumThreads(count);
}
