// The bytes of a volume's samples, wherever they lie: after a head, in files of their own, deflated or not. Opened and
// checked against the files' lengths before anything is read; one file is open at a time.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gonio::io {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  // Bytes from `at` on, counted from the first sample. Error(data) where there are not as many, Error(io).
  virtual void read(std::uint64_t at, std::span<char> to) = 0;
};

struct DataFile {
  std::filesystem::path path{};
  std::uint64_t first = 0;  // bytes of the file before its data
  bool deflated = false;    // gzip or zlib, which their beginnings tell apart; several members follow each other
  std::uint64_t skip = 0;   // bytes of the inflated data before the first sample
};

// Length of a plain file: Error(no_input) where it is missing, Error(data) for a folder, pipe or device.
std::uint64_t length_of_file(const std::filesystem::path& path);

// `each` bytes of each file, one after the other. Error(data) where a file cannot hold them: a plain one is shorter, a
// deflated one has less than 1/1032 of them (the most that deflate squeezes). Of a deflated one no more than `each`
// bytes are inflated; where they end early, or the checksum behind them is wrong, reading the last is Error(data).
std::unique_ptr<ByteSource> bytes_of_files(std::vector<DataFile> files, std::uint64_t each);

// The beginning of a file, at most `most` bytes.
std::string beginning_of_file(const std::filesystem::path& path, std::size_t most);
// What the beginning of a deflated file inflates to, at most `most` bytes; empty where it is none.
std::string beginning_inflated(std::string_view deflated, std::size_t most);

}  // namespace gonio::io
