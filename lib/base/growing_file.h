// Files (atomic_file.h) that are written piece by piece, for what is too large to be held: what was appended takes the
// target's place with commit(), and vanishes without. Written in atomic_file.cpp, which knows the temporaries.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>

namespace gonio {

class GrowingFile {
 public:
  explicit GrowingFile(const std::filesystem::path& path);  // errors as write_file()
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;
  void append(std::string_view bytes);
  void overwrite(std::uint64_t at, std::string_view bytes);  // of what was appended
  std::uint64_t size() const { return size_; }
  void commit();

 private:
  struct Temporary;
  std::filesystem::path path_, target_;
  std::unique_ptr<Temporary> temporary_;
  std::uint64_t size_ = 0;
};

}  // namespace gonio
