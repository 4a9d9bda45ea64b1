// NRRD, versions 1 to 6: http://teem.sourceforge.net/nrrd/format.html. A text head, an empty line, samples; or a head
// alone (.nhdr) that names files of samples, by name, by a pattern or by a LIST.
//
// What the page says and readers get wrong: names of types have many spellings; lines are skipped before, bytes after
// inflating, and -1 bytes means that the samples end the file; a vector of `space directions` is a step from a sample
// to the next, in columns of our axes.
//
// Units: `space units` goes with `space directions`, `units` with `spacings`. Without them the page says none. ITK,
// Slicer and what builds on them write millimetres in a patient's frame and leave the units out, so there a spacing
// counts as stated in millimetres, unless it is 1, 1, 1, which they write where nobody told them a spacing.
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

constexpr std::size_t longest_nrrd_head = 1 << 20;

struct NrrdHead {
  std::map<std::string, std::string> fields{};  // lower case without blanks -> text
  std::map<std::string, std::string> pairs{};   // key:=value
  std::vector<std::string> list{};              // lines behind "data file: LIST"
  std::uint64_t bytes = 0;                      // of the head with its empty line
  std::string place;

  const std::string* find(const char* name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? nullptr : &found->second;
  }
  const std::string& need(const char* name) const {
    const std::string* text = find(name);
    if (text == nullptr) refuse_volume(place, std::string("has no ") + name + " in its head");
    return *text;
  }
};

bool begins_as_nrrd(const std::filesystem::path&, std::string_view beginning, const VolumeWish&) {
  return beginning.starts_with("NRRD");
}

// "axis mins" and "axismins" are one field.
std::string field_name(std::string_view text) {
  std::string name = lower(trimmed(text));
  std::erase(name, ' ');
  if (name == "centers") return "centerings";
  return name;
}

NrrdHead parse_nrrd_head(std::string_view text, bool all_of_file, const std::string& place) {
  NrrdHead head{.place = place};
  bool listing = false;
  for (std::size_t at = 0, line_number = 0; at < text.size(); ++line_number) {
    const auto end = text.find('\n', at);
    if (end == std::string_view::npos && !all_of_file) break;
    std::string_view line = text.substr(at, end == std::string_view::npos ? end : end - at);
    at = end == std::string_view::npos ? text.size() : end + 1;
    head.bytes = at;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line_number == 0) {
      if (line.size() != 8 || line.substr(0, 7) != "NRRD000" || line[7] < '1' || line[7] > '6')
        refuse_volume(place, "begins with \"" + shown(line) + "\", and NRRD0001 to NRRD0006 are known");
      continue;
    }
    if (line.empty()) return head;
    if (listing) {
      head.list.emplace_back(line);
      continue;
    }
    if (line.front() == '#') continue;
    const auto colon = line.find(':');
    if (colon == std::string_view::npos)
      refuse_volume(place, "has a line in its head that is no \"field: value\": \"" + shown(line) + "\"");
    const std::string_view value = line.substr(colon + 1);
    if (value.starts_with('=')) {
      head.pairs.emplace(trimmed(line.substr(0, colon)), value.substr(1));
      continue;
    }
    const std::string name = field_name(line.substr(0, colon));
    if (!head.fields.emplace(name, trimmed(value)).second)
      refuse_volume(place, "has the field \"" + shown(name) + "\" twice in its head");
    listing = name == "datafile" && lower(trimmed(value)).starts_with("list");
  }
  if (!all_of_file) refuse_volume(place, "has a head that does not end within 1 MiB");
  return head;
}

VoxelType nrrd_type(const NrrdHead& head) {
  static const std::map<std::string, VoxelType> types = {{"signed char", VoxelType::i8},
                                                         {"int8", VoxelType::i8},
                                                         {"int8_t", VoxelType::i8},
                                                         {"uchar", VoxelType::u8},
                                                         {"unsigned char", VoxelType::u8},
                                                         {"uint8", VoxelType::u8},
                                                         {"uint8_t", VoxelType::u8},
                                                         {"short", VoxelType::i16},
                                                         {"short int", VoxelType::i16},
                                                         {"signed short", VoxelType::i16},
                                                         {"signed short int", VoxelType::i16},
                                                         {"int16", VoxelType::i16},
                                                         {"int16_t", VoxelType::i16},
                                                         {"ushort", VoxelType::u16},
                                                         {"unsigned short", VoxelType::u16},
                                                         {"unsigned short int", VoxelType::u16},
                                                         {"uint16", VoxelType::u16},
                                                         {"uint16_t", VoxelType::u16},
                                                         {"int", VoxelType::i32},
                                                         {"signed int", VoxelType::i32},
                                                         {"int32", VoxelType::i32},
                                                         {"int32_t", VoxelType::i32},
                                                         {"uint", VoxelType::u32},
                                                         {"unsigned int", VoxelType::u32},
                                                         {"uint32", VoxelType::u32},
                                                         {"uint32_t", VoxelType::u32},
                                                         {"float", VoxelType::f32},
                                                         {"double", VoxelType::f64}};
  std::string type;
  for (const std::string& word : words(lower(head.need("type")))) type += (type.empty() ? "" : " ") + word;
  const auto found = types.find(type);
  if (found == types.end())
    refuse_volume(head.place, "has samples of type \"" + shown(type) + "\"",
                  "integers of 8, 16 and 32 bits, float and double are read");
  return found->second;
}

void read_nrrd_size(const NrrdHead& head, VolumeHead& out) {
  const std::int64_t dimension = integers_of(head.need("dimension"), 1, "numbers of dimensions", head.place)[0];
  if (dimension != 3)
    refuse_volume(head.place, "has " + std::to_string(dimension) + " axes, and a volume has 3",
                  "write one channel and one moment to a file of its own");
  const auto sizes = integers_of(head.need("sizes"), 3, "sizes", head.place);
  for (std::size_t a = 0; a < 3; ++a) out.size[a] = checked_side(sizes[a], head.place);
}

// "(1,0,0) (0,1,0) (0,0,1)": columns of three numbers.
std::vector<Vec3> nrrd_vectors(std::string_view text, std::size_t count, const char* field, const std::string& place) {
  std::vector<Vec3> vectors;
  while (!(text = trimmed(text)).empty()) {
    const auto close = text.find(')');
    if (text.front() != '(' || close == std::string_view::npos)
      refuse_volume(place, std::string("has \"") + shown(text) + "\" among its " + field + ", where vectors belong");
    const auto n = numbers_of(text.substr(1, close - 1), 3, field, place);
    vectors.push_back({n[0], n[1], n[2]});
    text.remove_prefix(close + 1);
  }
  if (vectors.size() != count)
    refuse_volume(place, "has " + std::to_string(vectors.size()) + " " + field + ", and " + std::to_string(count) +
                             " belong there");
  return vectors;
}

// Metres of three units in quotation marks, 0 where they are empty, unknown ("???") or missing.
double nrrd_unit(const NrrdHead& head, const char* field) {
  const std::string* text = head.find(field);
  if (text == nullptr) return 0;
  std::vector<std::string> units;
  for (std::size_t at = 0; (at = text->find('"', at)) != std::string::npos;) {
    const auto end = text->find('"', at + 1);
    if (end == std::string::npos) break;
    units.push_back(text->substr(at + 1, end - at - 1));
    at = end + 1;
  }
  double metres = 0;
  for (std::size_t a = 0; a < units.size(); ++a) {
    const std::string unit = lower(trimmed(units[a]));
    if (unit.empty() || unit == "???" || unit == "none") return 0;
    const auto known = metres_of_unit(unit);
    if (!known)
      refuse_volume(head.place, "has its lengths in \"" + shown(units[a]) + "\"", "mm, um, m, cm, nm are known");
    if (a > 0 && *known != metres) refuse_volume(head.place, "has lengths in different units");
    metres = *known;
  }
  return units.size() == 3 ? metres : 0;
}

bool is_patients(const std::string& space) {
  return space == "left-posterior-superior" || space == "lps" || space == "right-anterior-superior" || space == "ras" ||
         space == "left-anterior-superior" || space == "las" || space == "scanner-xyz";
}

StatedGrid nrrd_grid(const NrrdHead& head) {
  StatedGrid grid;
  const std::string* space = head.find("space");
  if (const std::string* directions = head.find("spacedirections")) {
    if (head.find("spacings") != nullptr)
      refuse_volume(head.place, "has both spacings and space directions, and either says it all");
    const auto steps = nrrd_vectors(*directions, 3, "space directions", head.place);
    Mat3 columns;
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) columns(r, c) = steps[static_cast<std::size_t>(c)][r];
    set_steps(grid, columns);
    grid.unit_m = nrrd_unit(head, "spaceunits");
  } else if (const std::string* spacings = head.find("spacings")) {
    const auto n = numbers_of(*spacings, 3, "spacings", head.place);
    // The page: NaN where it is not known or has no meaning.
    if (std::none_of(n.begin(), n.end(), [](double x) { return std::isnan(x); })) grid.spacing = Vec3{n[0], n[1], n[2]};
    grid.unit_m = nrrd_unit(head, head.find("units") != nullptr ? "units" : "spaceunits");
  }
  const bool ones = grid.spacing && *grid.spacing == Vec3{1, 1, 1};
  if (grid.unit_m == 0 && grid.spacing && !ones && space != nullptr && is_patients(lower(*space)) &&
      head.find("spaceunits") == nullptr)
    grid.unit_m = 1e-3;
  if (const std::string* origin = head.find("spaceorigin"))
    grid.origin = nrrd_vectors(*origin, 1, "space origins", head.place)[0];
  return grid;
}

std::vector<std::string> nrrd_data_files(const NrrdHead& head, const std::string& text) {
  std::vector<std::string> names;
  const auto said = words(text);
  if (!said.empty() && lower(said[0]) == "list") {
    names = head.list;
    if (names.empty()) refuse_volume(head.place, "has an empty LIST of data files");
    return names;
  }
  if (text.find('%') == std::string::npos || said.size() < 4) return {text};
  const auto row = integers_of(said[1] + " " + said[2] + " " + said[3], 3, "numbers of data files", head.place);
  return names_of_pattern(said[0], row[0], row[1], row[2], head.place);
}

// Where the line behind `lines` lines begins.
std::uint64_t behind_lines(const std::filesystem::path& path, std::uint64_t from, std::int64_t lines) {
  constexpr std::size_t most = 1 << 20;
  const std::string bytes =
      beginning_of_file(path, static_cast<std::size_t>(std::min<std::uint64_t>(from, most)) + most);
  std::size_t at = static_cast<std::size_t>(std::min<std::uint64_t>(from, bytes.size()));
  for (; lines > 0; --lines) {
    at = bytes.find('\n', at);
    if (at == std::string::npos)
      refuse_volume(path.string(), "has fewer lines within its first MiB than are to be skipped");
    ++at;
  }
  return at;
}

std::int64_t nrrd_skip(const NrrdHead& head, const char* field, std::int64_t least) {
  const std::string* text = head.find(field);
  if (text == nullptr) return 0;
  const std::int64_t skip = integers_of(*text, 1, field, head.place)[0];
  if (skip < least || skip > std::int64_t{1} << 46)
    refuse_volume(head.place, std::string("has a ") + field + " of " + std::to_string(skip));
  return skip;
}

bool nrrd_is_big(const NrrdHead& head, VoxelType type) {
  if (bytes_of(type) == 1) return false;
  const std::string endian = lower(head.need("endian"));
  if (endian != "little" && endian != "big")
    refuse_volume(head.place, "has the endian \"" + shown(endian) + "\", and little and big are known");
  return endian == "big";
}

std::unique_ptr<VolumeSource> open_nrrd(const std::filesystem::path& path, const VolumeWish& wish) {
  const std::string place = path.string(), text = beginning_of_file(path, longest_nrrd_head);
  const NrrdHead stated = parse_nrrd_head(text, text.size() < longest_nrrd_head, place);
  VolumeHead head{.type = nrrd_type(stated), .files = {path}};
  read_nrrd_size(stated, head);
  const std::uint64_t bytes = checked_volume_bytes(head, place);
  const std::string encoding = lower(stated.need("encoding"));
  const bool gzip = encoding == "gzip" || encoding == "gz";
  const bool ascii = encoding == "ascii" || encoding == "text" || encoding == "txt";
  if (!gzip && !ascii && encoding != "raw")
    refuse_volume(place, "is encoded as \"" + shown(encoding) + "\"", "write it as raw, gzip or ascii");
  head.format = gzip ? "NRRD, gzip" : ascii ? "NRRD, ascii" : "NRRD";
  if (const auto value = stated.pairs.find("value"); value != stated.pairs.end()) head.value = value->second;
  check_wish_of_described(head, wish, place);
  settle_grid(nrrd_grid(stated), wish, head, place);

  std::vector<DataFile> files;
  if (const std::string* data = stated.find("datafile"))
    for (const std::string& name : nrrd_data_files(stated, *data)) {
      files.push_back({.path = beside(path, name)});
      head.files.push_back(files.back().path);
    }
  else
    files.push_back({.path = path, .first = stated.bytes});
  if (bytes % files.size() != 0)
    refuse_volume(place, "parts " + std::to_string(bytes) + " bytes over " + std::to_string(files.size()) +
                             " data files, which cannot be equal");
  const std::int64_t lines = nrrd_skip(stated, "lineskip", 0), skip = nrrd_skip(stated, "byteskip", -1);
  const std::uint64_t each = bytes / files.size();
  for (DataFile& file : files) {
    file.deflated = gzip;
    if (lines > 0) file.first = behind_lines(file.path, file.first, lines);
    if (skip == -1) {
      if (encoding != "raw") refuse_volume(place, "skips -1 bytes, which only raw samples can");
      const std::uint64_t length = length_of_file(file.path);
      if (length < file.first + each)
        refuse_volume(file.path.string(), "has " + std::to_string(length) + " bytes where " + std::to_string(each) +
                                              " are promised at its end: truncated");
      file.first = length - each;
    } else if (!ascii) {
      file.skip = static_cast<std::uint64_t>(skip);
    }
  }
  if (ascii) {
    if (files.size() > 1) refuse_volume(place, "has samples as text in several files", "write it as raw");
    return text_volume(std::move(head), files[0].path, files[0].first + static_cast<std::uint64_t>(skip));
  }
  const bool big = nrrd_is_big(stated, head.type);
  return linear_volume(std::move(head), bytes_of_files(std::move(files), each), big);
}

}  // namespace

const VolumeFormat& nrrd() {
  static const VolumeFormat format{
      .name = "NRRD",
      .sentence =
          ".nrrd and .nhdr, raw, gzip or ascii: lengths in the file's units, in mm in a patient's frame; a "
          "spacing without either, or of all ones, must be said with --voxel",
      .mine = begins_as_nrrd,
      .open = open_nrrd,
      .order = 10};
  return format;
}

}  // namespace gonio::io::volumes
