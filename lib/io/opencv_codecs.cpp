// See opencv_codecs.h. The functions go by their names in the ABI; CMake says which file the library is
// (GONIO_IMGCODECS), and the declarations are OpenCV's own.
#include "io/opencv_codecs.h"

#include <opencv2/imgcodecs.hpp>

#include "base/loaded_library.h"

namespace gonio::io {
namespace {

using Decode = cv::Mat (*)(cv::InputArray, int, cv::Mat*);
using Encode = bool (*)(const std::string&, cv::InputArray, std::vector<unsigned char>&, const std::vector<int>&);
// These do not compile where OpenCV declares something else.
using Decodes = decltype(static_cast<Decode>(&cv::imdecode));
using Encodes = decltype(static_cast<Encode>(&cv::imencode));

struct Codecs {
  Decodes decode;
  Encodes encode;
};

const Codecs& codecs() {
  static const Codecs loaded = [] {
    const auto found = [](const char* name) {
      return function_in(GONIO_IMGCODECS, name, "install OpenCV as it was when this was built");
    };
    return Codecs{
        reinterpret_cast<Decodes>(found("_ZN2cv8imdecodeERKNS_11_InputArrayEiPNS_3MatE")),
        reinterpret_cast<Encodes>(found("_ZN2cv8imencodeERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKNS_"
                                        "11_InputArrayERSt6vectorIhSaIhEERKSB_IiSaIiEE"))};
  }();
  return loaded;
}

}  // namespace

cv::Mat decode_by_opencv(const std::string& bytes, int flags, cv::Mat& picture) {
  const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
  return codecs().decode(buffer, flags, &picture);
}

bool encode_by_opencv(const std::string& extension, const cv::Mat& picture, std::vector<std::uint8_t>& bytes,
                      const std::vector<int>& parameters) {
  return codecs().encode(extension, picture, bytes, parameters);
}

}  // namespace gonio::io
