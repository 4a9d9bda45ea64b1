// Shares of pictures joined; see session.h. What is no estimate (ids, normals, depth) stands in the shares' pictures
// and must be the same in all of them.
#include <algorithm>
#include <bit>

#include "base/error.h"
#include "io/picture.h"
#include "render/film.h"
#include "render/session.h"
#include "render/share.h"

namespace gonio::render {
namespace {

namespace fs = std::filesystem;

fs::path picture_path(const fs::path& sums) {
  return fs::path(sums).replace_extension(".exr");
}

// To the last bit, and whatever is no number.
bool same_values(const io::Image& a, const io::Image& b) {
  const auto bits = [](float v) { return std::bit_cast<std::uint32_t>(v); };
  return a.width == b.width && a.height == b.height && a.channels == b.channels &&
         std::ranges::equal(a.data, b.data, {}, bits, bits);
}

io::Image shared_geometry(const std::vector<fs::path>& ordered, const PictureIdentity& what) {
  std::optional<io::Image> geometry;
  for (const fs::path& sums : ordered) {
    const fs::path path = picture_path(sums);
    const io::Image picture = io::read_picture(path);
    if (picture.width != what.width_px || picture.height != what.height_px)
      throw Error(Exit::data, path.string(), "has another size than its sums", "render this share anew");
    io::Image own = geometry_of(picture);
    if (!geometry)
      geometry = std::move(own);
    else if (!same_values(*geometry, own))
      throw Error(Exit::data, path.string(), "shows other geometry than " + picture_path(ordered[0]).string(),
                  "render all from one manifest, with the same --aov");
  }
  return std::move(*geometry);
}

}  // namespace

std::map<std::string, std::vector<fs::path>> shares_by_image(const std::vector<fs::path>& shares) {
  std::map<std::string, std::vector<fs::path>> by_image;
  for (const fs::path& share : shares) {
    const fs::path sums = sums_path(share);
    if (share.extension() != ".exr" && share.extension() != ".sums")
      throw Error(Exit::usage, share.string(), "is no share of a picture by its name", "give files that end in .exr");
    if (!fs::exists(sums))
      throw Error(Exit::no_input, sums.string(), "is missing, the exact sums of a share",
                  "render shares with --samples, and keep the .sums beside the .exr");
    by_image[read_sums_header(sums).identity.image].push_back(sums);
  }
  for (auto& [image, paths] : by_image) paths = ordered_shares(paths);
  return by_image;
}

Rendered merge_shares(const std::vector<fs::path>& ordered) {
  const io::Image geometry = shared_geometry(ordered, read_sums_header(ordered.at(0)).identity);
  PassSums sums = joined_shares(ordered);
  Rendered rendered{.picture = develop(sums, geometry), .sums = {}, .facts = facts_of(sums)};
  rendered.sums = std::move(sums);
  return rendered;
}

}  // namespace gonio::render
