// Names and cells of OpenCV's predefined dictionaries; those of the user's own: the flat keys of OpenCV's YAML and
// JSON, and whether the markers can be told apart.
#include "camera/marker_dictionary.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <opencv2/aruco.hpp>

#include "base/atomic_file.h"
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

constexpr int least_side = 3, largest_side = 10, most_markers = 10000;
constexpr std::uint64_t largest_file = 4 << 20;

using Keys = std::map<std::string, std::string, std::less<>>;
using Bits = std::vector<bool>;

bool is_word(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '-';
}

// Every `key: value` of which both are words, quoted or not.
Keys keys_of(std::string_view text) {
  Keys keys;
  std::size_t at = 0;
  const auto skip = [&](auto&& unwanted) {
    while (at < text.size() && unwanted(text[at])) ++at;
  };
  const auto word = [&] {
    const std::size_t first = at;
    skip(is_word);
    return std::string(text.substr(first, at - first));
  };
  while (at < text.size()) {
    skip([](char c) { return !is_word(c); });
    const std::string key = word();
    skip([](char c) { return c == '"' || c == '\'' || c == ' '; });
    if (at >= text.size() || text[at] != ':') continue;
    ++at;
    skip([](char c) { return c == '"' || c == '\'' || c == ' '; });
    if (const std::string value = word(); !value.empty()) keys[key] = value;
  }
  return keys;
}

int number(const Keys& keys, const char* key, int least, int most, const std::string& place) {
  const auto found = keys.find(key);
  if (found == keys.end()) {
    throw Error(Exit::data, place, std::string("no \"") + key + "\"",
                "write nmarkers, markersize and marker_0, marker_1, ...");
  }
  int value = 0;
  const char *begin = found->second.data(), *end = begin + found->second.size();
  const auto read = std::from_chars(begin, end, value);
  if (read.ec != std::errc{} || read.ptr != end || value < least || value > most) {
    throw Error(Exit::data, place, std::string(key) + " is " + found->second,
                "use a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  }
  return value;
}

Bits bits_of(const Keys& keys, const std::string& key, int side, const std::string& place) {
  const auto found = keys.find(key);
  if (found == keys.end()) throw Error(Exit::data, place, "no \"" + key + "\"", "nmarkers says that there is one");
  const std::string& text = found->second;
  if (text.size() != static_cast<std::size_t>(side * side) || text.find_first_not_of("01") != std::string::npos) {
    throw Error(Exit::data, place, key + " is not " + std::to_string(side * side) + " digits 0 and 1",
                "write markersize^2 cells row by row, 1 for white");
  }
  Bits bits;
  for (const char c : text) bits.push_back(c == '1');
  return bits;
}

Bits turned(const Bits& bits, int side) {
  Bits result;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      result.push_back(bits[static_cast<std::size_t>((side - 1 - column) * side + row)]);
    }
  }
  return result;
}

int differing(const Bits& a, const Bits& b) {
  int n = 0;
  for (std::size_t i = 0; i < a.size(); ++i) n += a[i] != b[i] ? 1 : 0;
  return n;
}

// The least distance over all pairs and turns. Error(data) where it is zero.
int least_distance(const OwnDictionary& dictionary, const std::string& place) {
  int least = dictionary.side * dictionary.side;
  for (std::size_t i = 0; i < dictionary.white.size(); ++i) {
    Bits bits = dictionary.white[i];
    for (int turn = 0; turn < 4; ++turn, bits = turned(bits, dictionary.side)) {
      for (std::size_t k = turn == 0 ? i + 1 : i; k < dictionary.white.size(); ++k) {
        const int distance = differing(bits, dictionary.white[k]);
        least = std::min(least, distance);
        if (distance > 0) continue;
        const std::string first = "marker_" + std::to_string(i);
        throw Error(
            Exit::data, place,
            i == k ? first + " looks the same when turned"
                   : first + " and marker_" + std::to_string(k) + " are the same" + (turn > 0 ? " but for a turn" : ""),
            "replace one: which corner is which could not be told");
      }
    }
  }
  return least;
}

}  // namespace

cv::Ptr<cv::aruco::Dictionary> aruco_dictionary(const std::string& name) {
  const auto* found = std::ranges::find_if(table, [&](const Named& entry) { return name == entry.name; });
  if (found == std::end(table)) throw Error(Exit::internal, "dictionary", "\"" + name + "\" does not exist");
  return cv::aruco::getPredefinedDictionary(found->value);
}

cv::Ptr<cv::aruco::Dictionary> aruco_dictionary(const Board& board) {
  if (!board.own_dictionary) return aruco_dictionary(board.dictionary);
  const OwnDictionary& own = *board.own_dictionary;
  cv::Mat bytes;
  for (const std::vector<bool>& white : own.white) {
    cv::Mat bits(own.side, own.side, CV_8U);
    for (int i = 0; i < own.side * own.side; ++i) bits.data[i] = white[static_cast<std::size_t>(i)] ? 1 : 0;
    bytes.push_back(cv::aruco::Dictionary::getByteListFromBits(bits));
  }
  return cv::makePtr<cv::aruco::Dictionary>(bytes, own.side, own.correctable);
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

OwnDictionary parse_dictionary(std::string_view text, const std::string& name, const std::string& place) {
  const Keys keys = keys_of(text);
  OwnDictionary dictionary;
  dictionary.name = name;
  const int count = number(keys, "nmarkers", 1, most_markers, place);
  dictionary.side = number(keys, "markersize", least_side, largest_side, place);
  for (int i = 0; i < count; ++i) {
    dictionary.white.push_back(bits_of(keys, "marker_" + std::to_string(i), dictionary.side, place));
  }
  dictionary.distance = least_distance(dictionary, place);
  dictionary.correctable = (dictionary.distance - 1) / 2;
  if (keys.contains("maxCorrectionBits")) {
    dictionary.correctable = std::min(dictionary.correctable, number(keys, "maxCorrectionBits", 0, 50, place));
  }
  return dictionary;
}

std::shared_ptr<const OwnDictionary> read_dictionary(const std::filesystem::path& path) {
  const std::string text = read_file(path, largest_file);
  auto dictionary = std::make_shared<OwnDictionary>(parse_dictionary(text, path.filename().string(), path.string()));
  dictionary->file = path;
  return dictionary;
}

MarkerCells marker_cells(const OwnDictionary& dictionary, int id) {
  MarkerCells cells;
  cells.side = dictionary.side + 2;
  const Bits& white = dictionary.white.at(static_cast<std::size_t>(id));
  for (int y = -1; y <= dictionary.side; ++y) {
    for (int x = -1; x <= dictionary.side; ++x) {
      const bool border = x < 0 || y < 0 || x == dictionary.side || y == dictionary.side;
      cells.black.push_back(border || !white[static_cast<std::size_t>(y * dictionary.side + x)]);
    }
  }
  return cells;
}

}  // namespace gonio::camera
