// Which raw frames are exposures of one view.
//   names     what stands before an exposure in a file's name is the view's: scene_20ms.png, scene_80ms.png
//   sequence  files in their order; a view ends where an exposure comes again (brackets of a camera)
//   one       all of them
//   each      every frame alone
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "photograph/raw_view.h"

namespace gonio::photograph {

enum class Grouping { names, sequence, one, each };
inline constexpr std::array grouping_names{"names", "sequence", "one", "each"};

// "wall_1250us_3" -> 1.25e-3, and where it begins: a number with s, ms or us between characters that are neither
// letters nor digits. The last one counts.
struct NamedExposure {
  double exposure_s = 0;
  std::size_t at = 0;
};
std::optional<NamedExposure> exposure_in_name(const std::string& stem);

// By names where all have an exposure, else in sequence.
Grouping usual_grouping(const std::vector<std::filesystem::path>& frames);

// `exposures_s`: as stated for all frames in their order; empty: by names, else by the files themselves. Views have
// unique names, in the order of their first frames. Error(data) for `names` where a file's has no exposure.
std::vector<RawView> raw_views(const std::vector<std::filesystem::path>& frames, const std::vector<double>& exposures_s,
                               Grouping grouping, const RawStated& stated);

}  // namespace gonio::photograph
