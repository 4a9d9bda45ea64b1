// See finished_view.h.
#include "photograph/finished_view.h"

#include <algorithm>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "io/exr.h"
#include "io/raster.h"

namespace gonio::photograph {
namespace {

using manifest::Value;

std::string hash_of(const std::vector<float>& values) {
  return sha256({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)});
}
std::string hash_of(const std::vector<std::uint8_t>& values) {
  return sha256({reinterpret_cast<const char*>(values.data()), values.size()});
}
Value number_or_null(const std::optional<double>& number) {
  return number ? Value(*number) : Value();
}

std::string text_in(const io::ExrAttributes& attributes, const std::string& name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? "" : found->second;
}

}  // namespace

std::string identity_of(const RawRecipe& recipe) {
  Value all;
  all["version"] = GONIO_VERSION;
  all["mosaic"] = recipe.stated.mosaic;
  all["black"] = number_or_null(recipe.stated.black), all["white"] = number_or_null(recipe.stated.white);
  if (recipe.stated.linearity) all["linearity"] = sha256(linearity_csv(recipe.stated.linearity->rows()));
  if (recipe.dark) {
    all["dark"] = hash_of(recipe.dark->offset) + hash_of(recipe.dark->rate_per_s) + hash_of(recipe.dark->hot);
    all["dark frames"] = static_cast<std::int64_t>(recipe.dark->frames);
  }
  if (recipe.flat) {
    all["flat"] = hash_of(recipe.flat->factor) + hash_of(recipe.flat->variance) + hash_of(recipe.flat->dead);
    all["flat frames"] = static_cast<std::int64_t>(recipe.flat->frames);
  }
  if (recipe.noise) all["gain"] = recipe.noise->gain, all["read"] = recipe.noise->read;
  all["demosaic"] = demosaicing_names[static_cast<std::size_t>(recipe.demosaicing)];
  all["refine"] = recipe.refine_exposures;
  all["blooming"] = std::int64_t{recipe.blooming_px};
  return sha256(manifest::canonical_json(all));
}

std::string identity_of(const RawView& view, const std::string& recipe) {
  Value frames = Value::array();
  for (std::size_t k = 0; k < view.frames.size(); ++k) {
    Value frame;
    frame["sha256"] = sha256_of_file(view.frames[k]);
    frame["exposure_s"] = number_or_null(view.exposures_s[k]);
    // What a file is to be read as.
    frame["kind"] = view.frames[k].extension().string();
    frames.push_back(std::move(frame));
  }
  return sha256(recipe + manifest::canonical_json(frames));
}

void write_view(const DevelopedView& developed, const Value& steps, const std::string& identity,
                const ViewFiles& files) {
  io::Image counts(developed.picture.width, developed.picture.height, {"Y"});
  std::ranges::transform(developed.trusted, counts.data.begin(),
                         [](std::uint8_t trusted) { return trusted != 0 ? 1.0f : 0.0f; });
  const std::string mask = io::encode_raster_png(counts);
  const io::ExrAttributes attributes{{"software", "gonio " GONIO_VERSION},
                                     {"recipe", identity},
                                     {"developed", manifest::canonical_json(steps)},
                                     {"mask", sha256(mask)}};
  write_file(files.mask, mask);
  write_file(files.picture, io::encode_exr(developed.picture, attributes));
}

std::optional<Value> finished_view(const RawView& view, const std::string& identity, const ViewFiles& files) {
  if (!std::filesystem::exists(files.picture)) return {};
  const auto refuse = [&](const std::filesystem::path& path) {
    return Error(Exit::cannot_create, path.string(), "is not what this call makes of \"" + view.name + "\"",
                 "--force replaces it");
  };
  const std::string place = files.picture.string();
  const io::ExrAttributes attributes = io::exr_attributes(read_file(files.picture), place);
  if (text_in(attributes, "recipe") != identity) throw refuse(files.picture);
  if (!std::filesystem::exists(files.mask)) return {};
  if (text_in(attributes, "mask") != sha256_of_file(files.mask)) throw refuse(files.mask);
  return manifest::parse_json(text_in(attributes, "developed"), place);
}

}  // namespace gonio::photograph
