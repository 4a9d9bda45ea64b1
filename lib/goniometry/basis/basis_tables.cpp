// Where a basis' tables come from: files of a folder, or functions evaluated on the cells.
#include <algorithm>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "goniometry/basis/basis.h"
#include "io/merl.h"

namespace gonio::goniometry {
namespace {

class Folder final : public Tables {
 public:
  explicit Folder(const std::vector<std::filesystem::path>& files) {
    for (const auto& file : files) {
      files_.push_back(std::make_unique<io::MerlFile>(file));
      names_.push_back(file.stem().string());
      if (files_.back()->bins() != files_.front()->bins())
        throw Error(Exit::data, file.string(),
                    "has " + words(files_.back()->bins()) + " bins where " + files.front().filename().string() +
                        " has " + words(files_.front()->bins()),
                    "a basis is made of tables with the same bins");
    }
    cells_ = std::make_unique<Cells>(files_.front()->bins());
  }
  const Cells& cells() const override { return *cells_; }
  std::size_t materials() const override { return files_.size(); }
  const std::string& name(std::size_t material) const override { return names_.at(material); }

  // Both halves of phi_d are averaged; negative numbers were not measured.
  void read(std::size_t material, std::size_t channel, std::size_t first, std::size_t last,
            std::span<float> f) const override {
    std::vector<float> rings = files_.at(material)->rings(channel, first, last);
    const auto [all, tilts, turns] = cells_->bins();
    for (std::size_t h = first; h < last; ++h) {
      float* ring = rings.data() + (h - first) * tilts * turns;
      fill(ring, tilts, turns);
      for (std::size_t d = 0; d < tilts; ++d)
        for (std::size_t p = 0; p < (turns + 1) / 2; ++p)
          if (const auto cell = cells_->cell_of(h, d, p); cell != Cells::none)
            f[cell - cells_->ring_begin(first)] = 0.5F * (ring[d * turns + p] + ring[d * turns + turns - 1 - p]);
    }
  }

 private:
  static std::string words(const Bins& bins) {
    return std::to_string(bins[0]) + " x " + std::to_string(bins[1]) + " x " + std::to_string(bins[2]);
  }
  // The mirrored cell, else the next with smaller theta_d, else with larger, else 0.
  static void fill(float* ring, std::size_t tilts, std::size_t turns) {
    for (std::size_t i = 0; i < tilts * turns; ++i)
      if (ring[i] < 0) ring[i] = std::max(-1.0F, ring[i / turns * turns + turns - 1 - i % turns]);
    for (std::size_t d = 1; d < tilts; ++d)
      for (std::size_t p = 0; p < turns; ++p)
        if (ring[d * turns + p] < 0) ring[d * turns + p] = ring[(d - 1) * turns + p];
    for (std::size_t d = tilts - 1; d-- > 0;)
      for (std::size_t p = 0; p < turns; ++p)
        if (ring[d * turns + p] < 0) ring[d * turns + p] = ring[(d + 1) * turns + p];
    std::replace_if(
        ring, ring + tilts * turns, [](float v) { return v < 0; }, 0.0F);
  }

  std::vector<std::unique_ptr<io::MerlFile>> files_;
  std::vector<std::string> names_;
  std::unique_ptr<Cells> cells_;
};

class InMemory final : public Tables {
 public:
  InMemory(const std::vector<Material>& materials, const Bins& bins, std::size_t channels)
      : cells_(bins), channels_(channels) {
    for (const Material& m : materials) {
      names_.push_back(m.name);
      values_.emplace_back(channels * cells_.count());
    }
    constexpr std::size_t chunk = 4096;
    const std::size_t chunks = (cells_.count() + chunk - 1) / chunk;
    parallel_for(0, chunks * materials.size(), [&](std::size_t task) {
      const std::size_t m = task / chunks, first = task % chunks * chunk;
      for (std::size_t c = first; c < std::min(first + chunk, cells_.count()); ++c) {
        const auto [wo, wi] = cells_.directions(c);
        const Rgb f = materials[m].brdf(wo, wi);
        for (std::size_t k = 0; k < channels; ++k)
          values_[m][k * cells_.count() + c] = static_cast<float>(f[static_cast<int>(k)]);
      }
    });
  }
  const Cells& cells() const override { return cells_; }
  std::size_t materials() const override { return names_.size(); }
  std::size_t channels() const override { return channels_; }
  const std::string& name(std::size_t material) const override { return names_.at(material); }
  void read(std::size_t material, std::size_t channel, std::size_t first, std::size_t last,
            std::span<float> f) const override {
    const float* from = values_.at(material).data() + channel * cells_.count();
    std::copy(from + cells_.ring_begin(first), from + cells_.ring_begin(last), f.begin());
  }

 private:
  Cells cells_;
  std::size_t channels_;
  std::vector<std::string> names_;
  std::vector<std::vector<float>> values_;
};

}  // namespace

std::unique_ptr<Tables> tables_of(const std::vector<Material>& materials, const Bins& bins, std::size_t channels) {
  return std::make_unique<InMemory>(materials, bins, channels);
}

Basis basis_of_folder(const std::filesystem::path& folder, const BasisOptions& options) {
  std::error_code missing;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, missing))
    if (entry.path().extension() == ".binary") files.push_back(entry.path());
  if (missing) throw Error(Exit::no_input, folder.string(), "is no folder that can be read");
  if (files.empty())
    throw Error(Exit::no_input, folder.string(), "holds no *.binary",
                "give a folder of tables in MERL format, or leave it out for the built-in basis");
  std::ranges::sort(files);
  return {Folder(files), std::to_string(files.size()) + " tables of the folder " + folder.string(), options};
}

}  // namespace gonio::goniometry
