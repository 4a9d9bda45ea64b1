#include "render/session.h"

#include <algorithm>
#include <chrono>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/progress.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/comparison.h"
#include "manifest/sections/file.h"
#include "manifest/sections/image.h"
#include "manifest/sections/rendering.h"
#include "render/caustic.h"
#include "render/film.h"
#include "render/layers.h"
#include "render/path_tracer.h"
#include "render/share.h"
#include "render/spectral.h"

namespace gonio::render {
namespace {

namespace fs = std::filesystem;

constexpr double share_for_checkpoints = 0.05;  // of the time, at most

fs::path checkpoint_path(const fs::path& picture) {
  return fs::path(picture).replace_extension(".checkpoint");
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The ids of a file in the manifest.
std::string names_of(const manifest::Document& document, const fs::path& path) {
  std::string names;
  std::error_code failure;
  for (const auto& [id, file] : document.files)
    if (fs::equivalent(document.folder / file.path, path, failure)) names += " " + id;
  return names;
}

// Of everything that the pixels depend on, but for the image, the seed and the samples, which are said apart.
std::string hash_of(manifest::Document document, const std::set<fs::path>& files, const SessionOptions& options) {
  document.renderings.clear();
  document.comparisons.clear();
  document.explanations.clear();
  document.provenance = manifest::Value::object();
  document.original = {};  // digits as typed, x-* keys
  for (manifest::ImageEntry& image : document.images) image.file.clear(), image.mask.clear();
  // Of files that were read the names matter by which the scene calls them, and their contents; not their places.
  std::set<std::string> contents;
  for (const fs::path& file : files) contents.insert(sha256_of_file(file) + names_of(document, file));
  document.files.clear();
  std::string text = manifest::content_id(document) + " " GONIO_VERSION;
  for (const std::string& content : contents) text += " " + content;
  for (const double wavelength : options.wavelengths_m) text += " " + shortest_text(wavelength);
  text += " " + std::to_string(options.transport.max_bounces) + (options.transport.per_light ? " per-light" : "") +
          (options.transport.stokes ? " stokes" : "") + (options.geometry ? " geometry" : "") + " " + options.purpose;
  return sha256(text).substr(0, 32);
}

// Writes a checkpoint now and then, the more rarely the longer it takes.
class Checkpoints {
 public:
  Checkpoints(fs::path path, double every_s, double spent_s)
      : path_(std::move(path)), every_s_(every_s), last_s_(spent_s) {}
  void after_round(const PassSums& sums, double spent_s) {
    if (spent_s - last_s_ < std::max(every_s_, took_s_ / share_for_checkpoints)) return;
    const double before_s = now_s();
    write_sums(path_, sums, spent_s);
    took_s_ = every_s_ > 0 ? now_s() - before_s : 0;
    last_s_ = spent_s;
  }

 private:
  fs::path path_;
  double every_s_, last_s_, took_s_ = 0;
};

}  // namespace

Session::Session(const manifest::Document& document, const SessionOptions& options,
                 const std::function<void(const fs::path&)>& on_file)
    : options_(options), range_(pass_range(options)) {
  std::set<fs::path> files;
  scene::Reading reading;
  reading.allow_open = options.allow_open;
  reading.image = options.image;
  reading.on_file = [&](const fs::path& path) {
    files.insert(path);
    if (on_file) on_file(path);
  };
  scene_ = scene::build_scene(document, reading);
  for (const optics::Bands& bands : spectral_bands(options.wavelengths_m)) {
    reading.bands = bands;
    spectral_.push_back(scene::build_scene(document, reading));
    spectral_.back().instances = scene_.instances;  // one copy of the meshes, which know no wavelength
  }
  caster_ = std::make_unique<RayCaster>(scene_.instances);
  hash_ = hash_of(document, files, options);
}

std::unique_ptr<Integrator> Session::integrator(std::size_t view) const {
  auto colour = path_integrator(scene_, view, *caster_, options_.transport);
  if (spectral_.empty()) return colour;
  std::vector<std::unique_ptr<Integrator>> spectral;
  for (const scene::Scene& scene : spectral_)
    spectral.push_back(path_integrator(scene, view, *caster_, options_.transport));
  return with_spectrum(std::move(colour), std::move(spectral), options_.wavelengths_m);
}

PassSums Session::start(const PictureIdentity& identity, const fs::path& checkpoint, double& spent_s) const {
  if (fs::exists(checkpoint) && !options_.force) {
    if (!options_.resume)
      throw Error(Exit::cannot_create, checkpoint.string(), "is a rendering that was interrupted",
                  "--resume goes on from it, --force begins anew");
    const SumsHeader header = read_sums_header(checkpoint);
    if (!(header.identity == identity) || header.first_pass != range_.first)
      throw Error(Exit::data, checkpoint.string(), "belongs to another scene or call", "--force begins anew");
    if (header.first_pass + header.passes > range_.end)
      throw Error(Exit::data, checkpoint.string(), "holds more samples than are asked for",
                  "raise --spp, or begin anew with --force");
    spent_s = header.spent_s;
    return read_sums(checkpoint);
  }
  return PassSums(identity, range_.first);
}

Rendered Session::render(std::size_t view, const fs::path& path) const {
  const auto paths = integrator(view);
  const PictureIdentity identity =
      picture_identity(scene_, view, *paths, options_.seed, range_.samples_per_pass, hash_);
  if (const std::string lacking = missing_light(scene_, view, *caster_).sentence(); !lacking.empty())
    log(LogLevel::warning, identity.image + ": " + lacking);
  const fs::path checkpoint = checkpoint_path(path);
  double spent_s = 0;
  PassSums sums = start(identity, checkpoint, spent_s);
  const io::Image geometry = options_.geometry ? geometry_layers(scene_, view, *caster_, *paths) : io::Image();
  Checkpoints checkpoints(checkpoint, options_.checkpoint_s, spent_s);
  Watch watch;
  watch.spent_s = spent_s;
  watch.on_round = [&](const PassSums& now, double seconds) { checkpoints.after_round(now, seconds); };
  try {
    render_until(*paths, sums,
                 {.end_pass = range_.end, .time_s = options_.time_s, .relative_error = options_.relative_error}, watch);
  } catch (const Error& e) {
    if (e.code() != Exit::try_again || !fs::exists(checkpoint)) throw;
    throw Error(Exit::try_again, identity.image, "was interrupted by a signal",
                "--resume goes on from " + checkpoint.string());
  }
  Rendered rendered{.picture = develop(sums, geometry), .sums = {}, .facts = facts_of(sums)};
  rendered.sums = std::move(sums);
  return rendered;
}

std::optional<Facts> Session::finished(std::size_t view, const fs::path& path) const {
  if (!options_.resume || options_.force || !fs::exists(path) || fs::exists(checkpoint_path(path))) return {};
  const auto facts = facts_in(io::exr_attributes(read_file(path), path.string()));
  const auto n = std::int64_t{range_.samples_per_pass};
  const bool reached = facts && (facts->end_sample == range_.end * n || options_.time_s ||
                                 (options_.relative_error && facts->relative_error <= *options_.relative_error));
  if (!reached || facts->scene != hash_ || facts->seed != options_.seed || facts->first_sample != range_.first * n)
    throw Error(Exit::cannot_create, path.string(),
                "is not the picture of " + scene_.views[view].image + " that this call makes", "--force replaces it");
  return facts;
}

void Session::remove_checkpoint(const fs::path& path) {
  std::error_code ignored;
  fs::remove(checkpoint_path(path), ignored);
}

}  // namespace gonio::render
