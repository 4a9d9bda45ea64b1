// Rendering as a person asks for it: a manifest and a goal become pictures, with checkpoints on the way.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/exr.h"
#include "io/image.h"
#include "manifest/sections/forward.h"
#include "render/passes.h"
#include "render/ray_caster.h"
#include "render/stopping.h"
#include "scene/scene.h"

namespace gonio::render {

struct SessionOptions {
  Transport transport{};
  std::uint64_t seed = 1;
  bool geometry = true;
  std::optional<int> spp{};  // left out: 256, or no limit where time or noise decide
  std::optional<double> time_s{}, relative_error{};
  std::string samples{};                // "A:B", a share of `spp`; empty: all
  std::vector<double> wavelengths_m{};  // of spectral channels
  bool allow_open = false;
  std::string purpose{};  // what else pictures depend on, for their identity
  std::string image{};    // whose shapes things that deform have; empty: of all images
  double checkpoint_s = 10;
  bool resume = false, force = false;
};

// What is known of a finished picture; it stands in the file's attributes, too.
struct Facts {
  std::string scene;  // identity: PictureIdentity::scene
  std::uint64_t seed = 1;
  std::int64_t first_sample = 0, end_sample = 0;
  double relative_error = 0;    // not a number where there is but one pass
  std::int64_t not_finite = 0;  // pixels that are no numbers
  std::int64_t samples() const { return end_sample - first_sample; }
};
Facts facts_of(const PassSums& sums);
io::ExrAttributes attributes_of(const Facts& facts, const io::Image& picture);  // with those of spectral channels
std::optional<Facts> facts_in(const io::ExrAttributes& attributes);

// Passes of the samples that are asked for. Error(usage) at --samples.
struct PassRange {
  int samples_per_pass = 1;
  std::uint32_t first = 0, end = 2;
};
PassRange pass_range(const SessionOptions& options);

struct Rendered {
  io::Image picture;
  std::optional<PassSums> sums;
  Facts facts;
};

class Session {
 public:
  // Builds the scenes: in colour, and for each three wavelengths.
  Session(const manifest::Document& document, const SessionOptions& options,
          const std::function<void(const std::filesystem::path&)>& on_file);

  // Renders an image of the manifest. Under `resume` it goes on from the checkpoint beside `path`; checkpoints appear
  // there while it works. Error(cannot_create) where there is one that nobody asked to go on from.
  Rendered render(std::size_t view, const std::filesystem::path& path) const;
  // The facts of the picture at `path`, if it is what render() would make. Error(cannot_create) where it is another.
  std::optional<Facts> finished(std::size_t view, const std::filesystem::path& path) const;
  // Once the picture is written: its checkpoint is no longer needed.
  static void remove_checkpoint(const std::filesystem::path& path);

  const scene::Scene& scene() const { return scene_; }

 private:
  std::unique_ptr<Integrator> integrator(std::size_t view) const;
  PassSums start(const PictureIdentity& identity, const std::filesystem::path& checkpoint, double& spent_s) const;

  SessionOptions options_;
  PassRange range_;
  scene::Scene scene_;
  std::vector<scene::Scene> spectral_;
  std::unique_ptr<RayCaster> caster_;
  std::string hash_;
};

// Shares of pictures, each an EXR with its sums beside it (X.exr, X.sums; either may be named), by their image: paths
// of the sums, in the order in which they follow each other. Error(data) where shares of an image do not fit together.
std::map<std::string, std::vector<std::filesystem::path>> shares_by_image(
    const std::vector<std::filesystem::path>& shares);
// The shares of one image become the picture that one call over all their samples renders, to the last bit.
Rendered merge_shares(const std::vector<std::filesystem::path>& ordered);

// X.exr -> X.sums.
std::filesystem::path sums_path(const std::filesystem::path& picture);

}  // namespace gonio::render
