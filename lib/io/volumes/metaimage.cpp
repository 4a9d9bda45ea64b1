// MetaImage (.mha, .mhd): lines "Key = Value" up to ElementDataFile, then the samples (LOCAL), or names of files of
// samples: one, a LIST, or a pattern with its numbers. MetaIO, github.com/Kitware/MetaIO, is what defines it.
//
// Units: its documentation has millimetres for ElementSpacing and Offset; DistanceUnits says another. A spacing of
// 1, 1, 1 is its default, written where nobody told a spacing, and counts as none unless DistanceUnits stands there.
// Row a of TransformMatrix is the direction of axis a: a column of ours.
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "base/error.h"
#include "io/volume_grid.h"
#include "io/volume_header.h"
#include "io/volume_samples.h"

namespace gonio::io::volumes {
namespace {

constexpr std::size_t longest_meta_head = 1 << 20;

struct MetaHead {
  std::map<std::string, std::string> fields{};  // keys in lower case
  std::vector<std::string> list{};
  std::uint64_t bytes = 0;
  std::string place;

  const std::string* find(const char* key) const {
    const auto found = fields.find(key);
    return found == fields.end() ? nullptr : &found->second;
  }
  const std::string* find_any(std::initializer_list<const char*> keys) const {
    for (const char* key : keys)
      if (const std::string* text = find(key); text != nullptr) return text;
    return nullptr;
  }
  const std::string& need(const char* key, const char* name) const {
    const std::string* text = find(key);
    if (text == nullptr) refuse_volume(place, std::string("has no ") + name + " in its head");
    return *text;
  }
  bool is_true(std::initializer_list<const char*> keys, bool otherwise) const {
    const std::string* text = find_any(keys);
    if (text == nullptr || text->empty()) return otherwise;
    const char c = (*text)[0];
    return c == 'T' || c == 't' || c == '1' || c == 'Y' || c == 'y';
  }
};

// Text whose first lines have one of the keys that every image has.
bool begins_as_meta(const std::filesystem::path&, std::string_view beginning, const VolumeWish&) {
  bool known = false;
  for (std::size_t at = 0; at < beginning.size() && !known;) {
    const auto end = std::min(beginning.find('\n', at), beginning.size());
    const auto line = beginning.substr(at, end - at);
    const auto equals = line.find('=');
    if (equals == std::string_view::npos) return false;
    const std::string key = lower(trimmed(line.substr(0, equals)));
    for (const char c : key)
      if (c <= ' ' || c > '~') return false;
    known = key == "objecttype" || key == "ndims";
    at = end + 1;
  }
  return known;
}

MetaHead parse_meta_head(std::string_view text, const std::string& place) {
  MetaHead head{.place = place};
  for (std::size_t at = 0; at < text.size();) {
    const auto end = std::min(text.find('\n', at), text.size());
    const std::string_view line = trimmed(text.substr(at, end - at));
    at = std::min(end + 1, text.size());
    head.bytes = at;
    if (line.empty()) continue;
    const auto equals = line.find('=');
    if (equals == std::string_view::npos)
      refuse_volume(place, "has a line in its head that is no \"Key = Value\": \"" + shown(line) + "\"");
    const std::string key = lower(trimmed(line.substr(0, equals)));
    head.fields[key] = trimmed(line.substr(equals + 1));
    if (key != "elementdatafile") continue;
    if (lower(head.fields[key]).starts_with("list"))
      while (at < text.size()) {
        const auto stop = std::min(text.find('\n', at), text.size());
        if (const auto name = trimmed(text.substr(at, stop - at)); !name.empty()) head.list.emplace_back(name);
        at = std::min(stop + 1, text.size());
      }
    return head;
  }
  refuse_volume(place, "has no ElementDataFile in its head");
}

VoxelType meta_type(const MetaHead& head) {
  static const std::map<std::string, VoxelType> types = {{"met_char", VoxelType::i8},   {"met_uchar", VoxelType::u8},
                                                         {"met_short", VoxelType::i16}, {"met_ushort", VoxelType::u16},
                                                         {"met_int", VoxelType::i32},   {"met_uint", VoxelType::u32},
                                                         {"met_float", VoxelType::f32}, {"met_double", VoxelType::f64}};
  const std::string& type = head.need("elementtype", "ElementType");
  const auto found = types.find(lower(type));
  if (found == types.end())
    refuse_volume(head.place, "has samples of type \"" + shown(type) + "\"",
                  "MET_CHAR, MET_SHORT, MET_INT and their U, MET_FLOAT and MET_DOUBLE are read");
  return found->second;
}

void check_meta_kind(const MetaHead& head) {
  if (const std::string* kind = head.find("objecttype"); kind != nullptr && lower(*kind) != "image")
    refuse_volume(head.place, "is a MetaIO object of type \"" + shown(*kind) + "\", and volumes are Images");
  const auto dimensions = integers_of(head.need("ndims", "NDims"), 1, "NDims", head.place)[0];
  if (dimensions != 3)
    refuse_volume(head.place, "has " + std::to_string(dimensions) + " axes, and a volume has 3",
                  "write one channel and one moment to a file of its own");
  if (const std::string* channels = head.find("elementnumberofchannels");
      channels != nullptr && integers_of(*channels, 1, "ElementNumberOfChannels", head.place)[0] != 1)
    refuse_volume(head.place, "has " + shown(*channels) + " channels a voxel, and a volume has 1");
}

Mat3 meta_axes(const std::string& text, const std::string& place) {
  const auto n = numbers_of(text, 9, "numbers in TransformMatrix", place);
  Mat3 axes;
  for (int a = 0; a < 3; ++a) {
    const auto row = static_cast<std::size_t>(3 * a);
    const double length = std::hypot(n[row], n[row + 1], n[row + 2]);
    if (!(std::abs(length - 1) < 1e-3))
      refuse_volume(place, "has an axis of length " + std::to_string(length) + " in its TransformMatrix, not 1");
    for (int r = 0; r < 3; ++r) axes(r, a) = n[row + static_cast<std::size_t>(r)] / length;
  }
  return axes;
}

StatedGrid meta_grid(const MetaHead& head) {
  StatedGrid grid;
  if (const std::string* text = head.find_any({"elementspacing", "elementsize"})) {
    const auto n = numbers_of(*text, 3, "spacings", head.place);
    grid.spacing = Vec3{n[0], n[1], n[2]};
    grid.unit_m = *grid.spacing == Vec3{1, 1, 1} ? 0 : 1e-3;
  }
  if (const std::string* unit = head.find("distanceunits"); unit != nullptr && !unit->empty() && *unit != "?") {
    const auto metres = metres_of_unit(*unit);
    if (!metres)
      refuse_volume(head.place, "has its lengths in \"" + shown(*unit) + "\"", "mm, um, m, cm, nm are known");
    grid.unit_m = *metres;
  }
  if (const std::string* text = head.find_any({"offset", "position", "origin"})) {
    const auto n = numbers_of(*text, 3, "numbers in Offset", head.place);
    grid.origin = Vec3{n[0], n[1], n[2]};
  }
  if (const std::string* text = head.find_any({"transformmatrix", "rotation", "orientation"}))
    grid.axes = meta_axes(*text, head.place);
  return grid;
}

void read_meta_scale(const MetaHead& head, VolumeHead& out) {
  if (const std::string* text = head.find("elementtointensityfunctionslope"))
    out.slope = numbers_of(*text, 1, "slopes", head.place)[0];
  if (const std::string* text = head.find("elementtointensityfunctionoffset"))
    out.intercept = numbers_of(*text, 1, "intercepts", head.place)[0];
  if (!std::isfinite(out.slope) || out.slope == 0 || !std::isfinite(out.intercept))
    refuse_volume(head.place, "states a slope or intercept of its values that is none");
}

// The samples' files; empty where they stand behind the head.
std::vector<std::string> meta_data_files(const MetaHead& head) {
  const std::string& text = head.need("elementdatafile", "ElementDataFile");
  const auto said = words(text);
  if (said.empty()) refuse_volume(head.place, "names no file for its samples");
  if (lower(said[0]) == "local") return {};
  if (lower(said[0]) == "list") {
    if (head.list.empty()) refuse_volume(head.place, "has an empty LIST of data files");
    return head.list;
  }
  if (text.find('%') == std::string::npos || said.size() < 3) return {text};
  const std::string step = said.size() > 3 ? said[3] : "1";
  const auto row = integers_of(said[1] + " " + said[2] + " " + step, 3, "numbers of data files", head.place);
  return names_of_pattern(said[0], row[0], row[1], row[2], head.place);
}

std::unique_ptr<VolumeSource> open_meta(const std::filesystem::path& path, const VolumeWish& wish) {
  const std::string place = path.string(), text = beginning_of_file(path, longest_meta_head);
  const MetaHead stated = parse_meta_head(text, place);
  check_meta_kind(stated);
  VolumeHead head{.type = meta_type(stated), .files = {path}};
  const auto sizes = integers_of(stated.need("dimsize", "DimSize"), 3, "sizes in DimSize", place);
  for (std::size_t a = 0; a < 3; ++a) head.size[a] = checked_side(sizes[a], place);
  const std::uint64_t bytes = checked_volume_bytes(head, place);
  const bool deflated = stated.is_true({"compresseddata"}, false), binary = stated.is_true({"binarydata"}, true);
  head.format = !binary ? "MetaImage, ascii" : deflated ? "MetaImage, deflated" : "MetaImage";
  read_meta_scale(stated, head);
  check_wish_of_described(head, wish, place);
  settle_grid(meta_grid(stated), wish, head, place);

  const auto names = meta_data_files(stated);
  std::vector<DataFile> files;
  if (names.empty()) files.push_back({.path = path, .first = stated.bytes});
  for (const std::string& name : names) {
    files.push_back({.path = beside(path, name)});
    head.files.push_back(files.back().path);
  }
  if (bytes % files.size() != 0 || (files.size() > 1 && head.size[2] % files.size() != 0))
    refuse_volume(place, "parts " + std::to_string(head.size[2]) + " slices over " + std::to_string(files.size()) +
                             " data files, which cannot be equal");
  const std::uint64_t each = bytes / files.size();
  const std::string* skip = stated.find("headersize");
  const std::int64_t before = skip == nullptr ? 0 : integers_of(*skip, 1, "HeaderSize", place)[0];
  for (DataFile& file : files) {
    file.deflated = deflated;
    if (before == -1) {
      if (deflated || !binary) refuse_volume(place, "has a HeaderSize of -1, which only raw samples can");
      const std::uint64_t length = length_of_file(file.path);
      if (length < file.first + each)
        refuse_volume(file.path.string(), "has " + std::to_string(length) + " bytes where " + std::to_string(each) +
                                              " are promised at its end: truncated");
      file.first = length - each;
    } else if (before > 0 && !names.empty()) {
      file.first = static_cast<std::uint64_t>(before);
    } else if (before < -1) {
      refuse_volume(place, "has a HeaderSize of " + std::to_string(before));
    }
  }
  if (!binary) {
    if (files.size() > 1 || deflated) refuse_volume(place, "has samples as text in several or deflated files");
    return text_volume(std::move(head), files[0].path, files[0].first);
  }
  const bool big = stated.is_true({"binarydatabyteordermsb", "elementbyteordermsb"}, false);
  return linear_volume(std::move(head), bytes_of_files(std::move(files), each), big);
}

}  // namespace

const VolumeFormat& metaimage() {
  static const VolumeFormat format{
      .name = "MetaImage",
      .sentence =
          ".mha and .mhd, raw, deflated or ascii: lengths in mm or in DistanceUnits; a spacing of all ones "
          "without these must be said with --voxel",
      .mine = begins_as_meta,
      .open = open_meta,
      .order = 50};
  return format;
}

}  // namespace gonio::io::volumes
