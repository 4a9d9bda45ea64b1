// Names and cells of OpenCV's predefined dictionaries.
#include "camera/marker_dictionary.h"

#include <algorithm>
#include <cctype>
#include <opencv2/aruco.hpp>

#include "base/error.h"
#include "camera/aruco_dictionary.h"

namespace gonio::camera {
namespace {

struct Named {
  const char* name;
  cv::aruco::PREDEFINED_DICTIONARY_NAME value;
};
constexpr Named table[] = {
    {"4X4_50", cv::aruco::DICT_4X4_50},
    {"4X4_100", cv::aruco::DICT_4X4_100},
    {"4X4_250", cv::aruco::DICT_4X4_250},
    {"4X4_1000", cv::aruco::DICT_4X4_1000},
    {"5X5_50", cv::aruco::DICT_5X5_50},
    {"5X5_100", cv::aruco::DICT_5X5_100},
    {"5X5_250", cv::aruco::DICT_5X5_250},
    {"5X5_1000", cv::aruco::DICT_5X5_1000},
    {"6X6_50", cv::aruco::DICT_6X6_50},
    {"6X6_100", cv::aruco::DICT_6X6_100},
    {"6X6_250", cv::aruco::DICT_6X6_250},
    {"6X6_1000", cv::aruco::DICT_6X6_1000},
    {"7X7_50", cv::aruco::DICT_7X7_50},
    {"7X7_100", cv::aruco::DICT_7X7_100},
    {"7X7_250", cv::aruco::DICT_7X7_250},
    {"7X7_1000", cv::aruco::DICT_7X7_1000},
    {"ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL},
};

}  // namespace

cv::Ptr<cv::aruco::Dictionary> aruco_dictionary(const std::string& name) {
  const auto* found = std::ranges::find_if(table, [&](const Named& entry) { return name == entry.name; });
  if (found == std::end(table)) throw Error(Exit::internal, "dictionary", "\"" + name + "\" does not exist");
  return cv::aruco::getPredefinedDictionary(found->value);
}

const std::vector<std::string>& dictionary_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Named& entry : table) list.emplace_back(entry.name);
    return list;
  }();
  return names;
}

std::string dictionary_name(const std::string& name, const std::string& place) {
  std::string upper = name;
  std::ranges::transform(upper, upper.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  if (upper.starts_with("DICT_")) upper.erase(0, 5);
  if (std::ranges::find(dictionary_names(), upper) != dictionary_names().end()) return upper;
  throw Error(Exit::data, place, "\"" + name + "\" is no dictionary of markers",
              "use 4X4_50, 4X4_100, 4X4_250, 4X4_1000, the same with 5X5, 6X6, 7X7, or ARUCO_ORIGINAL");
}

int dictionary_size(const std::string& name) {
  return aruco_dictionary(name)->bytesList.rows;
}

MarkerCells marker_cells(const std::string& dictionary, int id) {
  const auto d = aruco_dictionary(dictionary);
  MarkerCells cells;
  cells.side = d->markerSize + 2;
  cv::Mat picture;
  d->drawMarker(id, cells.side, picture, 1);
  for (int y = 0; y < cells.side; ++y) {
    for (int x = 0; x < cells.side; ++x) cells.black.push_back(picture.at<unsigned char>(y, x) < 128);
  }
  return cells;
}

}  // namespace gonio::camera
