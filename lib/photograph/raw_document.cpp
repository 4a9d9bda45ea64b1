// See raw_document.h.
#include "photograph/raw_document.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/text.h"
#include "io/codes.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/section_tables.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "photograph/developed.h"
#include "photograph/finished_view.h"
#include "photograph/response.h"

namespace gonio::photograph {
namespace {

constexpr double same_gain = 1e-6;  // of it
constexpr double same_code = 0.01;
constexpr double straight = 1e-5;  // of full scale

std::string words_of(const RawView& view, const DevelopedView& d) {
  std::string text =
      view.name + ": " + (view.frames.size() == 1 ? "one exposure" : format("%zu exposures", view.frames.size()));
  if (view.frames.size() > 1) {
    double most = 0;
    std::size_t off = 0;
    for (std::size_t k = 0; k < view.frames.size(); ++k) {
      if (d.merged.exposures_sigma[k] == 0) continue;
      const double change = d.merged.exposures_s[k] / d.stated_s[k] - 1;
      if (std::abs(change) > std::abs(most)) most = change, off = k;
    }
    if (most != 0)
      text += format("; the shutter farthest from its time: %g s, %+.2f(%.0f) %%", d.stated_s[off], 100 * most,
                     1e4 * d.merged.exposures_sigma[off] / d.stated_s[off]);
    text += format("; chi-square per degree of freedom %.3f", d.merged.chi_square_per_freedom);
  }
  if (d.noise_from_exposures)
    text += format("; %.3g electrons per code, read noise %.3g codes", d.noise.gain, d.noise.read);
  for (const auto& [share, what] :
       {std::pair{d.share_too_bright, "too bright"}, {d.share_moved, "moved"}, {d.share_unusable, "unusable"}})
    if (share > 0) text += format("; %.2g %% %s", 100 * share, what);
  return text;
}

// From a scene's radiance to codes per second, where every image of the view says what it is for its own codes.
std::optional<manifest::Parameter> gain_of_view(const manifest::Document& document,
                                                const std::vector<std::size_t>& images) {
  std::optional<manifest::Parameter> gain;
  for (const std::size_t i : images) {
    const manifest::ImageEntry& image = document.images[i];
    if (!image.gain || !image.exposure_s) return std::nullopt;
    const double per_second =
        image.gain->scalar() * full_code_of(manifest::picture_path(document, i)) / *image.exposure_s;
    if (!gain) gain = image.gain, gain->value = {per_second};
    if (std::abs(per_second - gain->scalar()) > same_gain * gain->scalar()) return std::nullopt;
  }
  return gain;
}

// The code without light and the code at which the sensor is full, as the image says them: a raw frame's response is a
// straight line of slope 1, above black.
RawStated stated_by_image(const manifest::Document& document, std::size_t i) {
  const manifest::ImageEntry& image = document.images[i];
  const auto full = [&] { return full_code_of(manifest::picture_path(document, i)); };
  RawStated stated;
  if (image.saturation) stated.white = *image.saturation * full() + 0.5;
  if (image.response.is_null() || image.response == manifest::Value("linear")) return stated;
  const std::string place = manifest::place(document, "/images/" + std::to_string(i) + "/response");
  const Response response(image.response, place);
  response.check_invertible(place);
  const double black = response.code(0);
  for (const double share : {0.0, 0.25, 0.5, 1.0})
    if (std::abs(response(static_cast<float>(black + share * (1 - black))) - share * (1 - black)) > straight)
      throw Error(Exit::data, place, "bends: these are no codes of a raw frame",
                  "merge frames whose codes rise evenly with light, above black");
  stated.black = black * full();
  return stated;
}

// What all images agree on takes the place of what nobody stated on the command line.
void take_stated(const manifest::Document& document, std::size_t i, bool first, const RawStated& by_user,
                 RawStated& stated) {
  const RawStated own = stated_by_image(document, i);
  const auto take = [&](std::optional<double> RawStated::*member, const char* what) {
    if (by_user.*member) return;
    if (!first && (own.*member).has_value() != (stated.*member).has_value())
      throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(i)),
                  format("and the images before it do not both state %s", what), "state it for all, or for none");
    if (!first && own.*member && std::abs(*(own.*member) - *(stated.*member)) > same_code)
      throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(i)),
                  format("states %s at code %g, images before it %g", what, *(own.*member), *(stated.*member)),
                  "develop cameras apart (--camera)");
    stated.*member = own.*member;
  };
  take(&RawStated::black, "black");
  take(&RawStated::white, "full scale");
}

manifest::ImageEntry entry_of(const manifest::Document& document, const RawRequest& request, std::size_t view) {
  manifest::ImageEntry entry;
  if (!request.images.empty()) entry = document.images[request.images[view][0]];
  entry.id = request.views[view].name;
  if (!request.camera.empty()) entry.camera = request.camera;
  entry.exposure_s.reset(), entry.saturation.reset(), entry.noise.reset();
  entry.response = {};
  entry.gain = request.images.empty() ? std::nullopt : gain_of_view(document, request.images[view]);
  entry.group.clear();
  return entry;
}

// Light before the polarizers is what a camera without them sees: the like of it, beside the one that has them.
void take_polarizers_off(manifest::Document& document, manifest::ImageEntry& entry) {
  const auto found = document.cameras.find(entry.camera);
  if (found == document.cameras.end() || found->second.mosaic.empty()) return;
  manifest::Camera bare = found->second;
  bare.mosaic.clear();
  entry.camera += "-stokes";
  document.cameras[entry.camera] = std::move(bare);
}

// In codes, of images that all say the same of files with the same codes.
std::optional<manifest::Noise> noise_of_images(const manifest::Document& document, const RawRequest& request) {
  std::optional<manifest::Noise> noise;
  for (const auto& view : request.images)
    for (const std::size_t i : view) {
      const auto& stated = document.images[i].noise;
      if (!stated) return std::nullopt;
      const double full = full_code_of(manifest::picture_path(document, i));
      const manifest::Noise codes{stated->gain / full, stated->read * full};
      if (noise && (noise->gain != codes.gain || noise->read != codes.read)) return std::nullopt;
      noise = codes;
    }
  return noise;
}

// Views of two cameras may be of one group.
std::string free_name(const std::vector<RawView>& views, const manifest::ImageEntry& image) {
  const auto taken = [&](const std::string& name) {
    return std::ranges::find(views, name, &RawView::name) != views.end();
  };
  const std::string wanted = image.group.empty() ? image.id : image.group;
  std::string name = taken(wanted) && !image.camera.empty() ? wanted + "-" + image.camera : wanted;
  for (int k = 2; taken(name); ++k) name = wanted + "-" + std::to_string(k);
  return name;
}

}  // namespace

void refuse_other_aperture(const manifest::Document& document, std::size_t first, std::size_t image) {
  const double own = document.images[image].f_number.value_or(0), other = document.images[first].f_number.value_or(own);
  if (own == other) return;
  throw Error(Exit::data, manifest::place(document, format("/images/%zu/f_number", image)),
              own > 0 ? format("is %g, and that of its view's first image, %s, is %g", own,
                               document.images[first].id.c_str(), other)
                      : format("is missing, and that of its view's first image, %s, is %g",
                               document.images[first].id.c_str(), other),
              "make views of one aperture: exposure times alone do not say how much light that is");
}

void views_of_images(const manifest::Document& document, const std::string& camera, RawRequest& request,
                     std::vector<std::filesystem::path>& dark_frames) {
  const RawStated by_user = request.recipe.stated;
  std::vector<std::string> groups;
  bool first = true;
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const manifest::ImageEntry& image = document.images[i];
    if (image.file.empty() || (!camera.empty() && image.camera != camera)) continue;
    refuse_developed(document, i, "leave it out, or give the frames that it was made of");
    const auto path = manifest::picture_path(document, i);
    take_stated(document, i, first, by_user, request.recipe.stated);
    first = false;
    if (image.dark == true) {
      dark_frames.push_back(path), request.spent.push_back(i);
      continue;
    }
    if (const auto found = document.cameras.find(image.camera); found != document.cameras.end())
      if (request.recipe.stated.mosaic.empty()) request.recipe.stated.mosaic = found->second.mosaic;
    const std::string group = image.group.empty() ? "" : image.camera + "/" + image.group;
    auto at = static_cast<std::size_t>(std::ranges::find(groups, group) - groups.begin());
    if (group.empty() || at == groups.size()) {
      at = groups.size();
      groups.push_back(group.empty() ? image.camera + "//" + image.id : group);
      request.views.push_back({free_name(request.views, image), {}, {}});
      request.images.emplace_back();
    }
    if (!request.images[at].empty()) refuse_other_aperture(document, request.images[at][0], i);
    request.views[at].frames.push_back(path);
    request.views[at].exposures_s.push_back(image.exposure_s);
    request.images[at].push_back(i);
  }
  request.recipe.noise = noise_of_images(document, request);
}

namespace {

constexpr std::size_t bytes_per_sample = 100;  // of a view while it is made, without its decoded frames

struct Made {
  ViewFiles files;
  std::optional<manifest::Value> steps{};  // nothing: not yet
};
using Steps = std::vector<manifest::DevelopedStep>;

Steps steps_of(const RawRecipe& recipe, const DevelopedView& d) {
  namespace step = manifest::develop_step;
  const auto count = [](std::size_t frames) { return static_cast<std::int64_t>(frames); };
  Steps steps;
  steps.push_back({step::black});
  if (recipe.stated.linearity) steps.push_back({step::linearity});
  if (recipe.dark) steps.push_back({step::dark, {}, count(recipe.dark->frames)});
  if (recipe.dark || recipe.flat) steps.push_back({step::defects});
  const bool refined = std::ranges::any_of(d.merged.exposures_sigma, [](double sigma) { return sigma > 0; });
  if (refined) steps.push_back({step::exposure_times});
  steps.push_back({step::merge, {}, count(d.stated_s.size()), d.merged.exposures_s});
  if (refined) steps.back().sigma = {{"exposures_s", d.merged.exposures_sigma}};
  if (recipe.flat) steps.push_back({step::flat, {}, count(recipe.flat->frames)});
  if (d.picture.channel("Y") < 0 || d.picture.channel("s1.Y") >= 0)
    steps.push_back({step::demosaic, demosaicing_names[static_cast<std::size_t>(recipe.demosaicing)]});
  return steps;
}

// A view's planes come first; what they leave of the memory is for decoded frames.
struct Share {
  std::size_t views = 1, frame_bytes = 0;
};
Share share_of(const RawRequest& request) {
  Share share{1, request.memory_bytes / 2};
  const std::size_t most = std::min(request.views.size(), static_cast<std::size_t>(threads()));
  if (most < 2) return share;
  const std::size_t planes =
      bytes_per_sample * read_raw_frame(request.views[0].frames.at(0), request.recipe.stated).codes.size();
  share.views = std::clamp<std::size_t>(request.memory_bytes / std::max<std::size_t>(1, planes), 1, most);
  const std::size_t each = request.memory_bytes / share.views;
  share.frame_bytes = each - std::min(each, planes);
  return share;
}

void make(const RawView& view, const RawRecipe& recipe, const std::string& identity, bool resume, Made& made) {
  if (resume) made.steps = finished_view(view, identity, made.files);
  if (made.steps) {
    log(LogLevel::info, view.name + ": is there already");
    return;
  }
  const DevelopedView d = develop_view(view, recipe);
  manifest::Value steps = manifest::Codec<Steps>::write(steps_of(recipe, d));
  write_view(d, steps, identity, made.files);
  log(LogLevel::info, words_of(view, d));
  made.steps = std::move(steps);
}

void make_all(const RawRequest& request, std::vector<Made>& made) {
  const Share share = share_of(request);
  RawRecipe recipe = request.recipe;
  recipe.frame_memory_bytes = share.frame_bytes;
  const std::string common = identity_of(recipe);
  Progress progress("develop", made.size());
  try {
    for (std::size_t first = 0; first < made.size(); first += share.views)
      parallel_for(first, std::min(made.size(), first + share.views), [&](std::size_t v) {
        const RawView& view = request.views[v];
        make(view, recipe, identity_of(view, common), request.resume, made[v]);
        progress.advance();
      });
  } catch (const Error& error) {
    if (error.code() != Exit::try_again) throw;
    const auto done = std::ranges::count_if(made, [](const Made& m) { return m.steps.has_value(); });
    throw Error(
        Exit::try_again, "",
        format("interrupted by a signal, with %zu of %zu views written", static_cast<std::size_t>(done), made.size()),
        "--resume makes the rest");
  }
}

}  // namespace

void develop_raw(manifest::Document& document, const RawRequest& request) {
  std::vector<Made> made;  // asked for before the work begins: an existing file is an error at once
  std::set<std::string> taken;
  for (const RawView& view : request.views) {
    std::string stem = file_stem(view.name);
    for (int k = 2; !taken.insert(stem).second; ++k) stem = file_stem(view.name) + "-" + std::to_string(k);
    made.push_back({{request.output_path(stem + ".exr"), request.output_path(stem + "-mask.png")}, {}});
    for (const auto& path : view.frames) request.note_input(path);
  }
  make_all(request, made);
  std::vector<manifest::ImageEntry> developed;
  std::vector<bool> replaced(document.images.size());
  for (std::size_t v = 0; v < request.views.size(); ++v) {
    manifest::ImageEntry entry = entry_of(document, request, v);
    if (request.recipe.stated.mosaic == "polarizers") take_polarizers_off(document, entry);
    entry.developed = manifest::Codec<Steps>::read(*made[v].steps, made[v].files.picture.string());
    entry.file = manifest::add_file(document, made[v].files.picture, entry.id);
    entry.mask = manifest::add_file(document, made[v].files.mask, entry.id + "-mask");
    developed.push_back(std::move(entry));
    if (!request.images.empty())
      for (const std::size_t i : request.images[v]) replaced[i] = true;
  }
  for (const std::size_t i : request.spent) replaced[i] = true;
  std::vector<manifest::ImageEntry> images;
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    if (!replaced[i]) images.push_back(document.images[i]);
    for (std::size_t v = 0; v < request.images.size(); ++v)
      if (request.images[v][0] == i) images.push_back(developed[v]);
  }
  if (request.images.empty()) images.insert(images.end(), developed.begin(), developed.end());
  document.images = std::move(images);
}

}  // namespace gonio::photograph
