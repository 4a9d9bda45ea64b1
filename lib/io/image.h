// A picture in memory: named channels of 32-bit floats, interleaved, rows from the top. Pixel (0, 0) is the top-left
// one and its centre lies at (0, 0).
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace gonio::io {

struct Image {
  int width = 0, height = 0;
  std::vector<std::string> channels;  // {"R", "G", "B"}, {"Y"}, or any EXR names such as "variance.R"
  std::vector<float> data;            // data[(y * width + x) * channels.size() + c]

  Image() = default;
  Image(int w, int h, std::vector<std::string> names)
      : width(w), height(h), channels(std::move(names)),
        data(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * channels.size()) {}
  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  std::size_t index(int x, int y, int c) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
               channels.size() + static_cast<std::size_t>(c);
  }
  float& at(int x, int y, int c) { return data[index(x, y, c)]; }
  float at(int x, int y, int c) const { return data[index(x, y, c)]; }
  int channel(const std::string& name) const {  // -1 where there is none
    for (std::size_t i = 0; i < channels.size(); ++i)
      if (channels[i] == name) return static_cast<int>(i);
    return -1;
  }
};

}  // namespace gonio::io
