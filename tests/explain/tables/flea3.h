// Raw frames of a Flea3 camera (hdr/flea3: dark disks on a bright sheet, seven narrow bands, seven shutters, GBRG) as a
// table of grey levels: the mean code of one filter over tiles of 16 x 16 pixels that are even and neither dark nor
// near full scale in any pixel (the 8 bits are cut off, not rounded: half a code, 2 % at most here), less the mean of
// the dark frames of that shutter. One patch is one tile of one filter in one band; its radiance is unknown. Rows of
// one frame share its shutter's error: they are a block.
#pragma once
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/text.h"
#include "io/picture.h"

namespace gonio::tests {

struct Flea3Frame {
  io::Image image;
  int band_nm = 0, shutter_ms = 0;
};

inline int number_before(const std::string& name, const std::string& unit) {
  const auto end = name.find(unit + "_");
  const auto start = name.rfind('_', end) + 1;
  int value = 0;
  std::from_chars(name.data() + start, name.data() + end, value);
  return value;
}

struct TileMean {
  double mean = 0, spread = 0;
  float most = 0;
};
inline TileMean tile_mean(const io::Image& image, int tile_x, int tile_y, int filter) {
  TileMean m;
  double sum = 0, squares = 0;
  int n = 0;
  for (int y = filter / 2; y < 16; y += 2)
    for (int x = filter % 2; x < 16; x += 2) {
      const float v = image.at(16 * tile_x + x, 16 * tile_y + y, 0) * 255;
      m.most = std::max(m.most, v);
      sum += v;
      squares += v * v;
      ++n;
    }
  m.mean = sum / n;
  m.spread = std::sqrt(std::max(0.0, squares / n - m.mean * m.mean));
  return m;
}

// CSV with the columns patch, frame, exposure_s, value.
inline std::string flea3_csv(const std::filesystem::path& folder) {
  std::map<int, std::pair<double, int>> dark;  // shutter -> sum of means, frames
  for (const auto& entry : std::filesystem::directory_iterator(folder / "dark")) {
    const io::Image image = io::read_picture(entry.path());
    double sum = 0;
    for (const float v : image.data) sum += 255 * v / static_cast<double>(image.data.size());
    auto& [total, frames] = dark[number_before(entry.path().filename().string(), "ms")];
    total += sum;
    ++frames;
  }
  std::vector<Flea3Frame> frames;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "disks")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    const std::string name = file.filename().string();
    frames.push_back({io::read_picture(file), number_before(name, "nm"), number_before(name, "ms")});
  }
  std::map<std::array<int, 4>, std::vector<std::pair<const Flea3Frame*, double>>> patches;
  for (const Flea3Frame& f : frames)
    for (int y = 0; y < f.image.height / 16; y += 3)
      for (int x = 0; x < f.image.width / 16; x += 3)
        for (int filter = 0; filter < 4; ++filter) {
          const TileMean m = tile_mean(f.image, x, y, filter);
          if (m.most > 245 || m.mean < 20 || m.spread > 0.05 * m.mean) continue;
          const auto& [total, count] = dark.at(f.shutter_ms);
          patches[{f.band_nm, x, y, filter}].emplace_back(&f, m.mean - total / count);
        }
  std::string csv = "patch,frame,exposure_s,value\n";
  int patch = 0;
  for (const auto& [key, readings] : patches) {
    if (readings.size() < 3) continue;
    for (const auto& [frame, value] : readings)
      csv += std::to_string(patch) + "," + std::to_string(frame - frames.data()) + "," +
             shortest_text(frame->shutter_ms * 1e-3) + "," + shortest_text(value) + "\n";
    ++patch;
  }
  return csv;
}

}  // namespace gonio::tests
