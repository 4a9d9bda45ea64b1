#include "render/share.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "manifest/value.h"

namespace gonio::render {
namespace {

namespace fs = std::filesystem;
using manifest::Value;

static_assert(std::endian::native == std::endian::little, "sums lie in files as they lie in memory");

constexpr std::string_view magic = "gonio sums 1";
constexpr std::size_t longest_header = 1 << 20;
constexpr std::int64_t longest_side_px = 1 << 17, most_planes = 4096;

// FNV-1a's step on words of eight bytes, with a shift that brings high bits down.
class Checksum {
 public:
  void add(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      std::uint64_t word = 0;
      const std::size_t n = std::min(bytes.size(), sizeof word);
      std::memcpy(&word, bytes.data(), n);
      value_ = (value_ ^ word ^ (n << 56)) * 0x100000001b3u;
      value_ ^= value_ >> 29;
      bytes = bytes.subspan(n);
    }
  }
  void add(std::string_view text) { add(std::as_bytes(std::span(text))); }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

Value to_value(const PassSums& sums, double spent_s) {
  const PictureIdentity& what = sums.identity();
  return Value::object({{"image", what.image},
                        {"scene", what.scene},
                        {"seed", std::to_string(what.seed)},
                        {"width_px", what.width_px},
                        {"height_px", what.height_px},
                        {"samples_per_pass", what.samples_per_pass},
                        {"planes", what.planes},
                        {"lights", what.lights},
                        {"first_pass", std::int64_t{sums.first_pass()}},
                        {"passes", std::int64_t{sums.passes()}},
                        {"spent_s", spent_s}});
}

[[noreturn]] void refuse(const fs::path& path, const std::string& what) {
  throw Error(Exit::data, path.string(), what, "render this share anew");
}

// Reads members of the header; what is missing or of another kind is a fault of the file.
class HeaderReader {
 public:
  HeaderReader(const std::string& line, const fs::path& path) : path_(path) {
    try {
      value_ = manifest::parse_json(line, path.string());
    } catch (const Error&) {
      refuse(path, "its header is damaged");
    }
  }
  std::int64_t whole(const char* key, std::int64_t least, std::int64_t most) const {
    const Value* v = value_.find(key);
    if (v == nullptr || !v->is_integer() || v->as_integer() < least || v->as_integer() > most) damaged(key);
    return v->as_integer();
  }
  double number(const char* key) const {
    const Value* v = value_.find(key);
    if (v == nullptr || !v->is_number()) damaged(key);
    return v->as_number();
  }
  std::string text(const char* key) const {
    const Value* v = value_.find(key);
    if (v == nullptr || !v->is_string()) damaged(key);
    return v->as_string();
  }
  std::vector<std::string> texts(const char* key) const {
    const Value* v = value_.find(key);
    if (v == nullptr || !v->is_array() || v->as_array().size() > most_planes) damaged(key);
    std::vector<std::string> all;
    for (const Value& element : v->as_array()) {
      if (!element.is_string()) damaged(key);
      all.push_back(element.as_string());
    }
    return all;
  }

 private:
  [[noreturn]] void damaged(const char* key) const { refuse(path_, std::string("its header is damaged at ") + key); }
  const fs::path& path_;
  Value value_;
};

std::uint64_t seed_in(const std::string& text, const fs::path& path) {
  try {
    return std::stoull(text);
  } catch (const std::exception&) {
    refuse(path, "its header is damaged at seed");
  }
}

SumsHeader header_of(const std::string& line, const fs::path& path) {
  const HeaderReader read(line, path);
  SumsHeader header;
  header.identity = {.image = read.text("image"),
                     .scene = read.text("scene"),
                     .seed = seed_in(read.text("seed"), path),
                     .width_px = static_cast<int>(read.whole("width_px", 1, longest_side_px)),
                     .height_px = static_cast<int>(read.whole("height_px", 1, longest_side_px)),
                     .samples_per_pass = static_cast<int>(read.whole("samples_per_pass", 1, 1 << 20)),
                     .planes = read.texts("planes"),
                     .lights = read.texts("lights")};
  header.first_pass = static_cast<std::uint32_t>(read.whole("first_pass", 0, most_passes));
  header.passes = static_cast<std::uint32_t>(read.whole("passes", 0, most_passes - header.first_pass));
  header.spent_s = read.number("spent_s");
  return header;
}

std::uint64_t payload_bytes(const PictureIdentity& what) {
  std::uint64_t per_pixel = sizeof(std::uint32_t) * (1 + what.lights.size());
  for (const std::string& plane : what.planes)
    per_pixel += 3 * (sizeof(ExactSum) + (keeps_variance(plane) ? sizeof(ExactSquares) : 0));
  return per_pixel * static_cast<std::uint64_t>(what.width_px) * static_cast<std::uint64_t>(what.height_px);
}

struct Opened {
  std::ifstream stream;
  std::string line;
  SumsHeader header;
};

Opened open(const fs::path& path) {
  Opened opened;
  opened.stream.open(path, std::ios::binary);
  if (!opened.stream)
    throw Error(Exit::no_input, path.string(), "cannot be read", "sums are written by render --samples or --sums");
  std::string first(magic.size() + 1, '\0');
  opened.stream.read(first.data(), static_cast<std::streamsize>(first.size()));
  if (!opened.stream || first != std::string(magic) + "\n") refuse(path, "holds no sums of this version of render");
  char c = 0;
  while (opened.line.size() < longest_header && opened.stream.get(c) && c != '\n') opened.line += c;
  opened.header = header_of(opened.line, path);
  const std::uint64_t wanted =
      first.size() + opened.line.size() + 1 + payload_bytes(opened.header.identity) + sizeof(std::uint64_t);
  std::error_code failure;
  if (const auto size = fs::file_size(path, failure); failure || size != wanted)
    refuse(path, "is cut off or too long: " + std::to_string(size) + " bytes, " + std::to_string(wanted) + " expected");
  return opened;
}

std::string samples_text(std::int64_t first, std::int64_t end) {
  return std::to_string(first) + " to " + std::to_string(end - 1);
}

struct Found {
  fs::path path;
  SumsHeader header;
};

void check_same_picture(const Found& one, const Found& other) {
  const PictureIdentity &a = one.header.identity, &b = other.header.identity;
  const auto differ = [&](const std::string& what, const char* remedy) {
    throw Error(Exit::data, other.path.string(), what + " (compared with " + one.path.string() + ")", remedy);
  };
  if (a.image != b.image) differ("is a share of image " + b.image + ", not of " + a.image, "join each image by itself");
  if (a.seed != b.seed)
    differ("has seed " + std::to_string(b.seed) + ", not " + std::to_string(a.seed), "render all with one --seed");
  if (a.samples_per_pass != b.samples_per_pass)
    differ(
        "has passes of " + std::to_string(b.samples_per_pass) + " samples, not " + std::to_string(a.samples_per_pass),
        "give every share the same --spp");
  if (!(a == b)) differ("was rendered from another scene, or with other options", "render all from one manifest");
}

}  // namespace

void write_sums(const fs::path& path, const PassSums& sums, double spent_s) {
  write_file_through(path, [&](const fs::path& temporary) {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    Checksum checksum;
    const std::string head = std::string(magic) + "\n" + manifest::print_json(to_value(sums, spent_s), -1) + "\n";
    checksum.add(head);
    out << head;
    for (const auto part : sums.parts()) {
      checksum.add(part);
      out.write(reinterpret_cast<const char*>(part.data()), static_cast<std::streamsize>(part.size()));
    }
    const std::uint64_t value = checksum.value();
    out.write(reinterpret_cast<const char*>(&value), sizeof value);
    out.close();
    if (!out) throw Error(Exit::io, path.string(), "writing failed", "is the disk full?");
  });
}

SumsHeader read_sums_header(const fs::path& path) {
  return open(path).header;
}

PassSums read_sums(const fs::path& path) {
  Opened opened = open(path);
  PassSums sums(opened.header.identity, opened.header.first_pass);
  Checksum checksum;
  checksum.add(std::string(magic) + "\n" + opened.line + "\n");
  for (const auto part : sums.parts()) {
    opened.stream.read(reinterpret_cast<char*>(part.data()), static_cast<std::streamsize>(part.size()));
    checksum.add(part);
  }
  std::uint64_t value = 0;
  opened.stream.read(reinterpret_cast<char*>(&value), sizeof value);
  if (!opened.stream || value != checksum.value()) refuse(path, "is damaged: its checksum does not fit");
  sums.count_passes(opened.header.passes);
  return sums;
}

std::vector<fs::path> ordered_shares(const std::vector<fs::path>& paths) {
  std::vector<Found> found;
  for (const fs::path& path : paths) found.push_back({path, read_sums_header(path)});
  std::ranges::stable_sort(found, {}, [](const Found& f) { return f.header.first_pass; });
  std::vector<fs::path> ordered;
  for (std::size_t i = 0; i < found.size(); ++i) {
    ordered.push_back(found[i].path);
    if (i == 0) continue;
    check_same_picture(found[0], found[i]);
    const SumsHeader &before = found[i - 1].header, &now = found[i].header;
    if (now.first_sample() < before.end_sample())
      throw Error(Exit::data, found[i].path.string(),
                  "holds samples " + samples_text(now.first_sample(), now.end_sample()) + ", of which " +
                      found[i - 1].path.string() + " holds some, too",
                  "leave one of them out");
    if (now.first_sample() > before.end_sample())
      throw Error(Exit::data, found[i].path.string(),
                  "begins at sample " + std::to_string(now.first_sample()) + ", and samples " +
                      samples_text(before.end_sample(), now.first_sample()) + " are missing before it",
                  "render them with --samples " + std::to_string(before.end_sample()) + ":" +
                      std::to_string(now.first_sample()));
  }
  return ordered;
}

PassSums joined_shares(const std::vector<fs::path>& ordered) {
  PassSums sums = read_sums(ordered.at(0));
  for (std::size_t i = 1; i < ordered.size(); ++i) sums.append(read_sums(ordered[i]));
  return sums;
}

}  // namespace gonio::render
