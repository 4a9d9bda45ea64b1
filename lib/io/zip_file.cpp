// See zip_file.h.
#include "io/zip_file.h"

#include <zip.h>

#include <set>

#include "base/error.h"
#include "io/png_grey.h"

namespace gonio::io {
namespace {

constexpr std::uint64_t most_squeezed = 1032;  // of a byte, by deflate
constexpr std::uint64_t most_entries = 1000000;
constexpr std::uint16_t utf8_names = 1 << 11, new_year_1980 = 0x21;
constexpr std::uint32_t in_zip64 = 0xffffffffu;

// Little endian, one after the other.
class Record {
 public:
  Record& u16(std::uint64_t v) { return number(v, 2); }
  Record& u32(std::uint64_t v) { return number(v, 4); }
  Record& u64(std::uint64_t v) { return number(v, 8); }
  Record& text(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  std::size_t size() const { return bytes_.size(); }
  const std::string& bytes() const { return bytes_; }

 private:
  Record& number(std::uint64_t v, int length) {
    for (int i = 0; i < length; ++i) bytes_ += static_cast<char>(v >> (8 * i) & 0xff);
    return *this;
  }
  std::string bytes_;
};

[[noreturn]] void refuse(const std::string& place, const std::string& problem) {
  throw Error(Exit::data, place, problem, "write or copy it again");
}

bool leaves(std::string_view name) {
  if (name.starts_with('/') || name.find('\\') != std::string_view::npos || name.find('\0') != std::string_view::npos)
    return true;
  for (std::size_t at = 0; at <= name.size();) {
    const std::size_t end = std::min(name.find('/', at), name.size());
    if (name.substr(at, end - at) == "..") return true;
    at = end + 1;
  }
  return false;
}

}  // namespace

ZipWriter::ZipWriter(const std::filesystem::path& path, std::uint64_t zip64_from)
    : file_(path), zip64_from_(zip64_from) {}

std::string ZipWriter::local_head(const Entry& entry) const {
  const bool wide = entry.size >= zip64_from_;
  Record extra;
  if (wide) extra.u16(1).u16(16).u64(entry.size).u64(entry.size);
  const std::uint64_t size = wide ? in_zip64 : entry.size;
  return Record()
      .u32(0x04034b50)
      .u16(wide ? 45 : 20)
      .u16(utf8_names)
      .u16(0)  // stored
      .u16(0)  // midnight
      .u16(new_year_1980)
      .u32(entry.crc)
      .u32(size)
      .u32(size)
      .u16(entry.name.size())
      .u16(extra.size())
      .text(entry.name)
      .text(extra.bytes())
      .bytes();
}

std::string ZipWriter::central_head(const Entry& entry) const {
  const bool wide = entry.size >= zip64_from_, far = entry.at >= zip64_from_;
  Record fields;
  if (wide) fields.u64(entry.size).u64(entry.size);
  if (far) fields.u64(entry.at);
  Record extra;
  if (fields.size() > 0) extra.u16(1).u16(fields.size()).text(fields.bytes());
  const std::uint64_t size = wide ? in_zip64 : entry.size;
  const int version = wide || far ? 45 : 20;
  return Record()
      .u32(0x02014b50)
      .u16(version)
      .u16(version)
      .u16(utf8_names)
      .u16(0)
      .u16(0)
      .u16(new_year_1980)
      .u32(entry.crc)
      .u32(size)
      .u32(size)
      .u16(entry.name.size())
      .u16(extra.size())
      .u16(0)  // comment
      .u16(0)  // disk
      .u16(0)  // text or binary
      .u32(0)  // attributes
      .u32(far ? in_zip64 : entry.at)
      .text(entry.name)
      .text(extra.bytes())
      .bytes();
}

std::string ZipWriter::end(std::uint64_t directory, std::uint64_t length) const {
  const std::uint64_t count = entries_.size();
  const bool many = count >= 0xffff, wide = length >= zip64_from_, far = directory >= zip64_from_;
  Record record;
  if (many || wide || far) {
    record.u32(0x06064b50).u64(44).u16(45).u16(45).u32(0).u32(0).u64(count).u64(count).u64(length).u64(directory);
    record.u32(0x07064b50).u32(0).u64(directory + length).u32(1);
  }
  record.u32(0x06054b50).u16(0).u16(0).u16(many ? 0xffff : count).u16(many ? 0xffff : count);
  record.u32(wide ? in_zip64 : length).u32(far ? in_zip64 : directory).u16(0);
  return record.bytes();
}

void ZipWriter::add(const std::string& name, std::string_view bytes) {
  entries_.push_back({name, crc32_of(bytes), bytes.size(), file_.size()});
  file_.append(local_head(entries_.back()));
  file_.append(bytes);
}

void ZipWriter::commit() {
  const std::uint64_t directory = file_.size();
  std::string heads;
  for (const Entry& entry : entries_) heads += central_head(entry);
  file_.append(heads);
  file_.append(end(directory, heads.size()));
  file_.commit();
}

struct ZipReader::Archive {
  explicit Archive(zip_t* opened) : zip(opened) {}
  ~Archive() { zip_discard(zip); }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;
  zip_t* zip;
};

ZipReader::ZipReader(const std::filesystem::path& path) : place_(path.string()) {
  int code = 0;
  std::error_code failure;
  const std::uint64_t length = std::filesystem::file_size(path, failure);
  if (failure)
    throw Error(Exit::no_input, place_, "cannot be read: " + failure.message(), "check the path and its permissions");
  archive_ = std::make_unique<Archive>(zip_open(path.c_str(), ZIP_RDONLY, &code));
  if (archive_->zip == nullptr) {
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    const std::string why = zip_error_strerror(&error);
    zip_error_fini(&error);
    refuse(place_, "is no whole zip archive (" + why + ")");
  }
  const auto count = static_cast<std::uint64_t>(zip_get_num_entries(archive_->zip, 0));
  if (count > most_entries) refuse(place_, "has " + std::to_string(count) + " entries, more than a million");
  std::set<std::string> names;
  for (std::uint64_t i = 0; i < count; ++i) {
    zip_stat_t stat;
    zip_stat_init(&stat);
    if (zip_stat_index(archive_->zip, i, 0, &stat) != 0 || (stat.valid & ZIP_STAT_NAME) == 0 ||
        (stat.valid & ZIP_STAT_SIZE) == 0)
      refuse(place_, "has an entry without a name or a length");
    const std::string name = stat.name;
    if (leaves(name)) refuse(place_, "has an entry \"" + name.substr(0, 60) + "\", which leaves the archive");
    if (name.ends_with('/')) continue;
    if (!names.insert(name).second) refuse(place_, "has two entries \"" + name.substr(0, 60) + "\"");
    if (stat.size / most_squeezed > length)
      refuse(place_ + "#" + name,
             "claims " + std::to_string(stat.size) + " bytes, more than " + std::to_string(length) + " can hold");
    entries_.push_back({name, stat.size});
    numbers_.push_back(i);
  }
}

ZipReader::~ZipReader() = default;

std::size_t ZipReader::find(const std::string& name) const {
  std::size_t i = 0;
  while (i < entries_.size() && entries_[i].name != name) ++i;
  return i;
}

std::string ZipReader::place(std::size_t entry) const {
  return place_ + "#" + entries_[entry].name;
}

std::string ZipReader::read(std::size_t entry, std::uint64_t most) const {
  if (entries_[entry].bytes > most)
    refuse(place(entry), "has " + std::to_string(entries_[entry].bytes) + " bytes, more than " + std::to_string(most));
  std::string bytes(entries_[entry].bytes, '\0');
  zip_file_t* file = zip_fopen_index(archive_->zip, numbers_[entry], 0);
  const zip_int64_t got = file == nullptr ? -1 : zip_fread(file, bytes.data(), bytes.size());
  char beyond;  // the checksum is compared where the entry ends
  const bool ends = got == static_cast<zip_int64_t>(bytes.size()) && zip_fread(file, &beyond, 1) == 0;
  if (file == nullptr || zip_fclose(file) != 0 || !ends)
    refuse(place(entry), "is damaged or locked: its checksum or length is wrong");
  return bytes;
}

std::string ZipReader::beginning(std::size_t entry, std::size_t most) const {
  std::string bytes(std::min<std::uint64_t>(entries_[entry].bytes, most), '\0');
  zip_file_t* file = zip_fopen_index(archive_->zip, numbers_[entry], 0);
  const zip_int64_t got = file == nullptr ? -1 : zip_fread(file, bytes.data(), bytes.size());
  if (file != nullptr) zip_fclose(file);
  if (got < 0) refuse(place(entry), "is damaged or locked");
  bytes.resize(static_cast<std::size_t>(got));
  return bytes;
}

bool begins_as_zip(std::string_view beginning) {
  return beginning.starts_with("PK\x03\x04") || beginning.starts_with("PK\x05\x06");
}

}  // namespace gonio::io
