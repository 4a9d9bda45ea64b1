// See stack_input.h.
#include "explain/stacks/stack_input.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/error.h"
#include "camera/intrinsics.h"
#include "camera/mosaic.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/object.h"
#include "photograph/linear_picture.h"
#include "photograph/mask.h"
#include "photograph/response.h"

namespace gonio::explain::stacks {
namespace {

using manifest::Document;
using manifest::ImageEntry;

constexpr std::size_t fewest_exposures = 3, fewest_lights = 6;

std::string pointer(std::size_t entry, const std::string& key) {
  return "/images/" + std::to_string(entry) + key;
}

bool may_be_stacked(const ImageEntry& e) {
  const bool dropped = e.weight && *e.weight == 0;
  const bool of_boards = !e.board.empty() || !e.boards.empty() || !e.robot.empty();
  return !e.file.empty() && !dropped && !of_boards;
}

// The lamp of an image in a stack of lights, or empty.
std::string distant_lamp(const Document& document, const ImageEntry& e) {
  if (e.light.size() != 1) return "";
  const auto light = document.lights.find(e.light[0]);
  return light != document.lights.end() && light->second.model == "directional" ? e.light[0] : "";
}

std::string place_of_camera(const ImageEntry& e) {
  std::string key = e.camera + "|" + e.group;
  if (!e.world_from_camera) return key;
  const auto& pose = *e.world_from_camera;
  for (const double v : {pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z, pose.translation_m.x,
                         pose.translation_m.y, pose.translation_m.z})
    key += "|" + std::to_string(v);
  return key;
}

bool large_enough(const Document& document, const std::vector<std::size_t>& entries, Kind kind) {
  std::set<std::pair<double, double>> times;  // and f-numbers
  std::set<std::string> lamps;
  for (const std::size_t i : entries) {
    times.insert({document.images[i].exposure_s.value_or(0), document.images[i].f_number.value_or(0)});
    lamps.insert(distant_lamp(document, document.images[i]));
  }
  return kind == Kind::exposures ? times.size() >= fewest_exposures
                                 : lamps.size() >= fewest_lights && lamps.size() == entries.size();
}

// Charge and light spill over from a clipped pixel, and resampling mixes it in: pixels around it do not count, whatever
// their filter or channel.
void drop_neighbours_of_clipped(const std::vector<std::uint8_t>& clipped, int reach, StackImage& image) {
  const int width = image.picture.width, height = image.picture.height;
  const auto channels = static_cast<int>(image.picture.channels.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!clipped[static_cast<std::size_t>(y * width + x)]) continue;
      for (int v = std::max(0, y - reach); v <= std::min(height - 1, y + reach); ++v)
        for (int u = std::max(0, x - reach); u <= std::min(width - 1, x + reach); ++u)
          for (int c = 0; c < channels; ++c) image.counts[image.picture.index(u, v, c)] = 0;
    }
}

// Is it a table, or one for each channel, that has an inverse?
bool is_rising_table(const manifest::Value& response, const std::string& at) {
  if (response.is_array()) return photograph::Response(response, at).is_rising_table();
  return response.is_object() && std::ranges::all_of(response.as_object(), [&](const auto& own) {
           return photograph::Response(own.second, at).is_rising_table();
         });
}

// Have all images one such table as their response, and none a noise, which would be one of linear readings?
bool share_a_table(const Document& document, const std::vector<std::size_t>& entries) {
  const manifest::Value& first = document.images[entries[0]].response;
  if (!is_rising_table(first, manifest::place(document, pointer(entries[0], "/response")))) return false;
  return std::ranges::all_of(entries, [&](std::size_t i) {
    const ImageEntry& e = document.images[i];
    return !(e.noise && (e.noise->gain > 0 || e.noise->read > 0)) && e.response == first;
  });
}

// The table of each channel, where readings are codes.
void state_table(const ImageEntry& entry, const std::string& at, const std::vector<std::string>& channels,
                 Stack& stack) {
  if (!stack.stated.empty()) return;
  for (const std::string& channel : channels)
    stack.stated.emplace_back(photograph::response_of_channel(entry.response, channel, at), at);
}

// Readings, and which of them count; `codes`: they are the codes of files.
void read_image(const Document& document, bool codes, StackImage& image, Stack& stack) {
  const ImageEntry& entry = document.images[image.entry];
  const std::string at = manifest::place(document, pointer(image.entry, "/response"));
  const manifest::Value undone = codes ? manifest::Value("linear") : entry.response;
  photograph::LinearPicture read =
      photograph::read_linear(manifest::picture_path(document, image.entry), undone, at, entry.saturation);
  stack.integer = read.integer_codes();
  if (codes) state_table(entry, at, read.colour.channels, stack);
  if (stack.integer && undone.is_string() && undone.as_string() == "linear")
    stack.quantum = std::max(stack.quantum, 1 / (std::pow(2.0, read.code_bits) - 1));
  for (const std::string& channel : read.colour.channels) {
    const photograph::Response response(photograph::response_of_channel(undone, channel, at), at);
    const bool first = stack.images.empty() && &channel == &read.colour.channels[0];
    stack.lowest = std::max(response(0), first ? response(0) : static_cast<float>(stack.lowest));
    const float full = response(static_cast<float>(entry.saturation.value_or(1)));
    stack.highest = std::min(full, first ? full : static_cast<float>(stack.highest));
  }
  image.picture = std::move(read.colour);
  image.counts.resize(image.picture.data.size());
  for (std::size_t i = 0; i < image.counts.size(); ++i)
    image.counts[i] = std::isfinite(image.picture.data[i]) && !read.dark[i];
  image.at_least = read.clipped;
  image.at_least.resize(image.counts.size() / image.picture.channels.size());
  drop_neighbours_of_clipped(read.clipped, stack.step, image);
}

void leave_out_masked(const Document& document, StackImage& image) {
  const std::filesystem::path path = manifest::mask_path(document, image.entry);
  if (path.empty()) return;
  const std::vector<std::uint8_t> counts =
      photograph::read_mask_of(image.picture, path, manifest::place(document, pointer(image.entry, "/mask")));
  const std::size_t channels = image.picture.channels.size();
  for (std::size_t i = 0; i < image.counts.size(); ++i) image.counts[i] = image.counts[i] && counts[i / channels];
  for (std::size_t i = 0; i < counts.size(); ++i) image.at_least[i] = image.at_least[i] && counts[i];
}

void check_alike(const Document& document, const StackImage& image, const Stack& stack) {
  const io::Image& first = stack.images[0].picture;
  if (image.picture.width == first.width && image.picture.height == first.height &&
      image.picture.channels == first.channels)
    return;
  throw Error(Exit::data, manifest::place(document, pointer(image.entry, "/file")),
              "has another size or other channels than the stack's first picture", "give pictures of one kind");
}

// What each aperture lets in, where nothing else is said of the light: as areas go, the widest is the unit. All state
// one, or none does.
void set_apertures(const Document& document, Stack& stack) {
  double widest = std::numeric_limits<double>::infinity();
  for (StackImage& image : stack.images) {
    const std::optional<double>& own = document.images[image.entry].f_number;
    if (own.has_value() != document.images[stack.images[0].entry].f_number.has_value())
      throw Error(Exit::data, manifest::place(document, pointer(image.entry, own ? "/f_number" : "")),
                  own ? "is said, and of the stack's first picture none is"
                      : "states no f_number, as the stack's first picture does",
                  "state it of all pictures of a stack, or of none");
    image.f_number = own.value_or(0);
    widest = std::min(widest, image.f_number);
  }
  for (StackImage& image : stack.images)
    if (widest > 0 && !document.images[image.entry].gain) image.gain *= std::pow(widest / image.f_number, 2);
}

void set_scale(Stack& stack) {
  if (stack.integer && stack.quantum > 0) return;
  double largest = 0;
  for (const StackImage& image : stack.images)
    for (std::size_t i = 0; i < image.counts.size(); ++i)
      if (image.counts[i]) largest = std::max(largest, double{image.picture.data[i]});
  if (largest > 0) stack.full_scale = largest;
}

}  // namespace

std::vector<std::vector<std::size_t>> stacks_of(const Document& document, Kind kind) {
  std::map<std::string, std::vector<std::size_t>> found;
  if (!document.objects.empty()) return {};
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const ImageEntry& e = document.images[i];
    if (!may_be_stacked(e)) continue;
    std::string key = place_of_camera(e);
    if (kind == Kind::exposures) {
      if (!e.exposure_s) continue;
      for (const std::string& light : e.light) key += "|" + light;
    } else {
      if (distant_lamp(document, e).empty()) continue;
      key += "|" + std::to_string(e.exposure_s.value_or(0));
    }
    found[key].push_back(i);
  }
  std::vector<std::vector<std::size_t>> result;
  for (auto& [key, entries] : found)
    if (large_enough(document, entries, kind)) result.push_back(std::move(entries));
  std::sort(result.begin(), result.end());
  return result;
}

Stack read_stack(const Document& document, const std::vector<std::size_t>& entries, Kind kind) {
  Stack stack;
  stack.camera = document.images[entries[0]].camera;
  if (has_entry(document, "cameras", stack.camera))
    stack.step = camera::filter_pitch(camera::mosaic_of(document, stack.camera),
                                      manifest::place(document, "/cameras/" + stack.camera + "/mosaic"));
  const bool codes = kind == Kind::exposures && share_a_table(document, entries);
  for (const std::size_t i : entries) {
    const ImageEntry& e = document.images[i];
    StackImage image;
    image.id = e.id;
    image.entry = i;
    image.exposure_s = e.exposure_s.value_or(1);
    if (e.gain && e.gain->given()) image.gain = e.gain->scalar();
    image.time_s = e.time_s;
    image.temperature_K = e.temperature_K;
    if (e.world_from_camera) image.world_from_camera = *e.world_from_camera;
    if (kind == Kind::lights) image.light = e.light[0];
    if (e.noise) image.noise = *e.noise;
    image.noise_stated = e.noise && (e.noise->gain > 0 || e.noise->read > 0);
    read_image(document, codes, image, stack);
    leave_out_masked(document, image);
    if (!stack.images.empty()) check_alike(document, image, stack);
    stack.images.push_back(std::move(image));
  }
  if (kind == Kind::exposures)
    for (const std::string& light : document.images[entries[0]].light)
      stack.name += (stack.name.empty() ? "" : ", ") + light;
  stack.channels = stack.images[0].picture.channels;
  set_apertures(document, stack);
  set_scale(stack);
  return stack;
}

}  // namespace gonio::explain::stacks
