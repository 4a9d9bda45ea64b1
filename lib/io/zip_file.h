// Zip archives (PKWARE APPNOTE 6.3.10): written entry by entry, in bounded memory and the same bytes whenever, and read
// entry by entry.
//
// Written here, and not by libzip, which keeps every entry until it closes: entries are stored as they are, for what
// goes in is packed already, with times of 1 January 1980, names in UTF-8 and zip64 where sizes, places or their number
// ask for it. Read by libzip.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/growing_file.h"

namespace gonio::io {

class ZipWriter {
 public:
  // `zip64_from`: sizes and places from here on take 64 bits; less than the format's own limit only in tests.
  explicit ZipWriter(const std::filesystem::path& path, std::uint64_t zip64_from = 0xffffffffu);
  void add(const std::string& name, std::string_view bytes);
  std::size_t entries() const { return entries_.size(); }
  void commit();  // the file is in its place

 private:
  struct Entry {
    std::string name;
    std::uint32_t crc = 0;
    std::uint64_t size = 0, at = 0;
  };
  std::string local_head(const Entry& entry) const;
  std::string central_head(const Entry& entry) const;
  std::string end(std::uint64_t directory, std::uint64_t length) const;

  GrowingFile file_;
  std::uint64_t zip64_from_;
  std::vector<Entry> entries_;
};

struct ZipEntry {
  std::string name;
  std::uint64_t bytes = 0;  // unpacked, as the archive claims
};

class ZipReader {
 public:
  // Error(no_input), Error(data) for what is no zip, names an entry that leaves the archive ("..", "/", "\"), names one
  // twice, or claims more than its length can hold.
  explicit ZipReader(const std::filesystem::path& path);
  ~ZipReader();
  ZipReader(const ZipReader&) = delete;
  ZipReader& operator=(const ZipReader&) = delete;
  const std::vector<ZipEntry>& entries() const { return entries_; }  // files alone, in the archive's order
  bool has(const std::string& name) const { return find(name) < entries_.size(); }
  std::size_t find(const std::string& name) const;  // entries().size(): none
  // A whole entry. Error(data) where it is longer than `most`, damaged or locked. Not from two threads at once.
  std::string read(std::size_t entry, std::uint64_t most) const;
  std::string beginning(std::size_t entry, std::size_t most) const;  // the first bytes, unchecked
  std::string place(std::size_t entry) const;                        // "file.zip#name"

 private:
  struct Archive;
  std::string place_;
  std::vector<ZipEntry> entries_;
  std::vector<std::uint64_t> numbers_;  // libzip's
  std::unique_ptr<Archive> archive_;
};

bool begins_as_zip(std::string_view beginning);

}  // namespace gonio::io
