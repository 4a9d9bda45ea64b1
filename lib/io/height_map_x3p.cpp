// ISO 25178-72:2017 (before: ISO 5436-2): a zip archive with main.xml, which says how large the matrix is, how far its
// points lie apart (metres) and how they are stored, and the matrix itself. z = number * increment + offset. Types: I
// and L are integers of 16 and 32 bits, F and D floats of 32 and 64. What was not measured is NaN, or has a zero in a
// mask of one bit per point, the lowest bit of a byte first. Numbers are little-endian, x runs fastest. Checksums are
// compared where there are any; the archive's own are compared always.
//
// What writers do besides: all files in one folder of the archive; any prefix of names and any name of the root
// element; names with backslashes, links from the root; an increment of 0 where the heights are absolute, which have
// none.
#include <zip.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <memory>
#include <pugixml.hpp>

#include "base/atomic_file.h"
#include "io/height_map.h"
#include "io/height_map_checks.h"
#include "io/little_endian.h"
#include "io/md5.h"

namespace gonio::io {
namespace {

constexpr std::uint64_t most_xml_bytes = 1 << 24;
constexpr std::uint64_t most_squeezed = 1032;  // of a byte, by deflate

struct CloseArchive {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
using Archive = std::unique_ptr<zip_t, CloseArchive>;

Archive opened(std::string_view file, const std::string& place) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(file.data(), file.size(), 0, &error);
  zip_t* archive = source == nullptr ? nullptr : zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, &error);
  if (archive == nullptr) {
    const std::string why = zip_error_strerror(&error);
    zip_error_fini(&error);
    zip_source_free(source);
    refuse_map(place, "is no whole zip archive (" + why + ")");
  }
  zip_error_fini(&error);
  return Archive(archive);
}

constexpr const char* description = "main.xml";

// The folder that main.xml lies in, "" or "name/": the outermost one.
std::string top_folder(const Archive& archive, const std::string& place) {
  std::string found;
  bool any = false;
  for (zip_int64_t i = 0; i < zip_get_num_entries(archive.get(), 0); ++i) {
    const char* raw = zip_get_name(archive.get(), static_cast<zip_uint64_t>(i), 0);
    std::string_view name = raw == nullptr ? "" : raw;
    if (!name.ends_with(description)) continue;
    name.remove_suffix(std::string_view(description).size());
    if (!name.empty() && name.back() != '/' && name.back() != '\\') continue;  // an other-main.xml
    if (any && name.size() >= found.size()) continue;
    found = name, any = true;
  }
  if (!any) refuse_map(place, std::string("has no file \"") + description + "\" in it");
  return found;
}

// The entry that main.xml, or a link in it, calls `name`; negative: none.
zip_int64_t entry_of(const Archive& archive, const std::string& folder, std::string name) {
  std::ranges::replace(name, '\\', '/');
  while (name.starts_with("./") || name.starts_with("/")) name.erase(0, name.find('/') + 1);
  std::string backward = name;
  std::ranges::replace(backward, '/', '\\');
  for (const zip_flags_t flags : {zip_flags_t{0}, zip_flags_t{ZIP_FL_NOCASE}})
    for (const std::string& path : {folder + name, folder + backward, name, backward})
      if (const zip_int64_t at = zip_name_locate(archive.get(), path.c_str(), flags); at >= 0) return at;
  return -1;
}

// One file of the archive, of exactly `bytes` where that is not 0.
std::string content(const Archive& archive, const std::string& folder, const std::string& name, std::uint64_t bytes,
                    std::uint64_t file_bytes, const std::string& place) {
  const zip_int64_t at = entry_of(archive, folder, name);
  const auto index = static_cast<zip_uint64_t>(at);
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (at < 0 || zip_stat_index(archive.get(), index, 0, &stat) != 0 || (stat.valid & ZIP_STAT_SIZE) == 0)
    refuse_map(place, "has no file \"" + name + "\" in it");
  if (bytes > 0 && stat.size != bytes)
    refuse_map(place, "has " + std::to_string(stat.size) + " bytes in " + name + " where its points are " +
                          std::to_string(bytes));
  if (stat.size > most_squeezed * file_bytes || (bytes == 0 && stat.size > most_xml_bytes))
    refuse_map(place, "claims " + std::to_string(stat.size) + " bytes in " + name + ", more than it can hold");
  std::string text(stat.size, '\0');
  zip_file_t* entry = zip_fopen_index(archive.get(), index, 0);
  const zip_int64_t read = entry == nullptr ? -1 : zip_fread(entry, text.data(), text.size());
  char beyond;  // the checksum is compared where the file ends
  const bool ends = read == static_cast<zip_int64_t>(text.size()) && zip_fread(entry, &beyond, 1) == 0;
  const bool sound = (entry == nullptr || zip_fclose(entry) == 0) && ends;
  if (!sound) refuse_map(place, "has a damaged file \"" + name + "\"");
  return text;
}

std::string_view without_prefix(std::string_view name) {
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

// The element at a path of names, prefixes left out; an empty one where there is none.
pugi::xml_node element(pugi::xml_node from, std::initializer_list<std::string_view> path) {
  for (const std::string_view name : path) {
    pugi::xml_node found;
    for (const pugi::xml_node child : from.children())
      if (without_prefix(child.name()) == name) {
        found = child;
        break;
      }
    from = found;
  }
  return from;
}

std::string text_of(pugi::xml_node node) {
  const std::string_view text = node.text().get();
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1));
}

double number_of(pugi::xml_node node, double otherwise, const char* what, const std::string& place) {
  const std::string text = text_of(node);
  if (text.empty()) return otherwise;
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end != text.c_str() + text.size() || !std::isfinite(value))
    refuse_map(place, std::string("states \"") + text.substr(0, 40) + "\" as its " + what);
  return value;
}

std::int64_t count_of(pugi::xml_node node, const char* what, const std::string& place) {
  const double value = number_of(node, 0, what, place);
  return value >= 0 && value < 1e9 && value == std::floor(value) ? static_cast<std::int64_t>(value) : -1;
}

void check_sum(const std::string& bytes, pugi::xml_node stated, const char* what, const std::string& place) {
  std::string sum = text_of(stated);
  for (char& c : sum) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (!sum.empty() && sum != md5(bytes)) refuse_map(place, std::string("has ") + what + " whose checksum is another");
}

struct Coding {
  char type;
  std::size_t bytes;
};
Coding coding_of(pugi::xml_node cz, const std::string& place) {
  const std::string type = text_of(element(cz, {"DataType"}));
  if (type == "I") return {'I', 2};
  if (type == "L") return {'L', 4};
  if (type == "F") return {'F', 4};
  if (type == "D") return {'D', 8};
  refuse_map(place, "stores its heights as \"" + type.substr(0, 20) + "\", and I, L, F and D are known");
}

void check_feature(const std::string& type, const std::string& place) {
  if (type == "PRF") refuse_map(place, "holds a profile, not an area");
  if (type == "PCL") refuse_map(place, "holds a cloud of points, not a map");
}

double stored(std::string_view points, std::size_t i, char type) {
  switch (type) {
    case 'I': return stored_at<std::int16_t>(points, 2 * i);
    case 'L': return stored_at<std::int32_t>(points, 4 * i);
    case 'F': return static_cast<double>(stored_at<float>(points, 4 * i));
    default: return stored_at<double>(points, 8 * i);
  }
}

}  // namespace

HeightMap parse_x3p(std::string_view file, const std::string& place) {
  const Archive archive = opened(file, place);
  const std::string folder = top_folder(archive, place),
                    xml = content(archive, folder, description, 0, file.size(), place);
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(xml.data(), xml.size());
  if (!parsed) refuse_map(place, std::string("has a main.xml that is no XML (") + parsed.description() + ")");
  const pugi::xml_node root = document.document_element(), axes = element(root, {"Record1", "Axes"}),
                       size = element(root, {"Record3", "MatrixDimension"}),
                       link = element(root, {"Record3", "DataLink"});
  if (axes.empty())
    refuse_map(place, std::string("has no Record1/Axes in its main.xml, whose root is \"") +
                          std::string(root.name()).substr(0, 40) + "\"");
  check_feature(text_of(element(root, {"Record1", "FeatureType"})), place);
  if (size.empty() || link.empty())
    refuse_map(place, element(root, {"Record3", "DataList"}).empty() ? "holds no matrix in a file of its own"
                                                                     : "holds its points in main.xml, one by one");
  for (const char* axis : {"CX", "CY"})
    if (text_of(element(axes, {axis, "AxisType"})) == "A")
      refuse_map(place, "states every place of its points by itself; only even steps are read");
  if (count_of(element(size, {"SizeZ"}), "SizeZ", place) > 1) refuse_map(place, "holds several layers");
  const std::int64_t width = count_of(element(size, {"SizeX"}), "SizeX", place),
                     height = count_of(element(size, {"SizeY"}), "SizeY", place);
  check_map_size(width, height, place);
  HeightMap map{static_cast<std::size_t>(width), static_cast<std::size_t>(height), 0, 0, {}};
  map.step_x_m = checked_step(number_of(element(axes, {"CX", "Increment"}), 0, "increment", place), "x", place);
  map.step_y_m = checked_step(number_of(element(axes, {"CY", "Increment"}), 0, "increment", place), "y", place);
  const pugi::xml_node cz = element(axes, {"CZ"});
  const Coding coding = coding_of(cz, place);
  const double stated = number_of(element(cz, {"Increment"}), 1, "increment", place),
               increment = stated == 0 && text_of(element(cz, {"AxisType"})) == "A" ? 1 : stated,
               offset = number_of(element(cz, {"Offset"}), 0, "offset", place);
  if (increment == 0) refuse_map(place, "states a step of height of 0");
  const std::size_t count = map.width * map.height;
  const std::string points =
      content(archive, folder, text_of(element(link, {"PointDataLink"})), count * coding.bytes, file.size(), place);
  check_sum(points, element(link, {"MD5ChecksumPointData"}), "points", place);
  const std::string mask_name = text_of(element(link, {"ValidPointsLink"}));
  const std::string mask =
      mask_name.empty() ? std::string() : content(archive, folder, mask_name, (count + 7) / 8, file.size(), place);
  if (!mask.empty()) check_sum(mask, element(link, {"MD5ChecksumValidPoints"}), "a mask", place);
  map.z_m.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double z = stored(points, i, coding.type) * increment + offset;
    const bool valid = mask.empty() || (static_cast<unsigned char>(mask[i / 8]) >> (i % 8) & 1) != 0;
    map.z_m[i] = valid && std::abs(z) < 1e3 ? z : std::numeric_limits<double>::quiet_NaN();
  }
  return map;
}

namespace {

void add_file(zip_t* archive, const std::string& name, const std::string& bytes, const std::string& place) {
  zip_source_t* source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
  const zip_int64_t index = source == nullptr ? -1 : zip_file_add(archive, name.c_str(), source, ZIP_FL_ENC_UTF_8);
  if (index < 0) throw Error(Exit::io, place, "cannot be put together: " + name);
  // the same bytes whenever it is written: 1 January 1980
  zip_file_set_dostime(archive, static_cast<zip_uint64_t>(index), 0, 0x21, 0);
}

std::string main_xml(const HeightMap& map, const std::string& points) {
  char text[1600];
  std::snprintf(text, sizeof text,
                "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                "<p:ISO5436_2 xmlns:p=\"http://www.opengps.eu/2008/ISO5436_2\">\n"
                "<Record1><Revision>ISO5436 - 2000</Revision><FeatureType>SUR</FeatureType><Axes>\n"
                "<CX><AxisType>I</AxisType><DataType>D</DataType><Increment>%.17g</Increment><Offset>0</Offset></CX>\n"
                "<CY><AxisType>I</AxisType><DataType>D</DataType><Increment>%.17g</Increment><Offset>0</Offset></CY>\n"
                "<CZ><AxisType>A</AxisType><DataType>D</DataType><Increment>1</Increment><Offset>0</Offset></CZ>\n"
                "</Axes></Record1>\n"
                "<Record3><MatrixDimension><SizeX>%zu</SizeX><SizeY>%zu</SizeY><SizeZ>1</SizeZ></MatrixDimension>\n"
                "<DataLink><PointDataLink>bindata/data.bin</PointDataLink><MD5ChecksumPointData>%s"
                "</MD5ChecksumPointData></DataLink></Record3>\n"
                "<Record4><ChecksumFile>md5checksum.hex</ChecksumFile></Record4>\n"
                "</p:ISO5436_2>\n",
                map.step_x_m, map.step_y_m, map.width, map.height, md5(points).c_str());
  return text;
}

}  // namespace

void write_x3p(const std::filesystem::path& path, const HeightMap& map) {
  std::string points(8 * map.z_m.size(), '\0');
  for (std::size_t i = 0; i < map.z_m.size(); ++i) store_at(points, 8 * i, map.z_m[i]);
  const std::string xml = main_xml(map, points), sum = md5(xml) + " *main.xml\n";
  write_file_through(path, [&](const std::filesystem::path& temporary) {
    int error = 0;
    zip_t* archive = zip_open(temporary.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &error);
    if (archive == nullptr) throw Error(Exit::cannot_create, path.string(), "cannot be created");
    add_file(archive, "main.xml", xml, path.string());
    add_file(archive, "bindata/data.bin", points, path.string());
    add_file(archive, "md5checksum.hex", sum, path.string());
    if (zip_close(archive) != 0) {
      zip_discard(archive);
      throw Error(Exit::io, path.string(), "cannot be written");
    }
  });
}

}  // namespace gonio::io
