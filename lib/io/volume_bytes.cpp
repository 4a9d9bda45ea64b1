#include "io/volume_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/volume_grid.h"

namespace gonio::io {
namespace {

constexpr std::uint64_t most_inflated_by = 1032;  // zlib's documentation: "the maximum compression factor is 1030:1"
constexpr int either_head = 15 + 32;              // windowBits: gzip's or zlib's head
constexpr std::size_t block_bytes = 1 << 16;

// A plain file, open for reading.
class OpenFile {
 public:
  explicit OpenFile(const std::filesystem::path& path) : path_(path), fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (fd_ < 0) throw Error(Exit::no_input, path.string(), std::strerror(errno), "check the path and its permissions");
  }
  ~OpenFile() { ::close(fd_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  std::size_t read_some(std::uint64_t at, std::span<char> to) const {
    while (true) {
      const auto got = ::pread(fd_, to.data(), to.size(), static_cast<off_t>(at));
      if (got >= 0) return static_cast<std::size_t>(got);
      if (errno != EINTR) throw Error(Exit::io, path_.string(), "reading failed: " + std::string(std::strerror(errno)));
      throw_if_interrupted();
    }
  }
  void read(std::uint64_t at, std::span<char> to) const {
    while (!to.empty()) {
      const std::size_t got = read_some(at, to);
      if (got == 0) refuse_volume(path_.string(), "became shorter while it was read");
      at += got;
      to = to.subspan(got);
    }
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int fd_;
};

class PlainBytes : public ByteSource {
 public:
  explicit PlainBytes(const DataFile& data) : file_(data.path), first_(data.first + data.skip) {}
  void read(std::uint64_t at, std::span<char> to) override { file_.read(first_ + at, to); }

 private:
  OpenFile file_;
  std::uint64_t first_;
};

// Forwards through a deflated file; going back begins anew.
class InflatedBytes : public ByteSource {
 public:
  InflatedBytes(const DataFile& data, std::uint64_t count)
      : file_(data.path), first_(data.first), skip_(data.skip), end_(data.skip + count), input_(block_bytes) {
    stream_ = {};
    if (inflateInit2(&stream_, either_head) != Z_OK)
      throw Error(Exit::internal, data.path.string(), "zlib cannot be started");
  }
  ~InflatedBytes() override { inflateEnd(&stream_); }

  void read(std::uint64_t at, std::span<char> to) override {
    at += skip_;
    if (at < position_) restart();
    std::array<char, 1 << 14> passed_over;
    while (position_ < at)
      inflate_to(
          {passed_over.data(), static_cast<std::size_t>(std::min<std::uint64_t>(passed_over.size(), at - position_))});
    inflate_to(to);
    if (position_ == end_) check_end();
  }

 private:
  void restart() {
    inflateReset2(&stream_, either_head);
    stream_.avail_in = 0;
    from_ = position_ = 0;
    member_ended_ = false;
  }

  bool refill() {
    if (stream_.avail_in > 0) return true;
    const std::size_t got = file_.read_some(first_ + from_, input_);
    from_ += got;
    stream_.next_in = reinterpret_cast<Bytef*>(input_.data());
    stream_.avail_in = static_cast<uInt>(got);
    return got > 0;
  }

  [[noreturn]] void refuse_end() const {
    refuse_volume(file_.path().string(), "ends after " + std::to_string(position_) +
                                             " inflated bytes where its head promises " + std::to_string(end_));
  }
  [[noreturn]] void refuse_damage() const {
    refuse_volume(file_.path().string(),
                  "is damaged after " + std::to_string(position_) + " inflated bytes (" +
                      (stream_.msg != nullptr ? stream_.msg : "no deflated data") + ")",
                  "copy it again");
  }

  void inflate_to(std::span<char> to) {
    while (!to.empty()) {
      if (!refill()) refuse_end();
      if (member_ended_) {  // another member follows (bgzip, files put one behind the other)
        if (inflateReset2(&stream_, either_head) != Z_OK) refuse_damage();
        member_ended_ = false;
      }
      const auto some = static_cast<uInt>(std::min<std::size_t>(to.size(), 1u << 30));
      stream_.next_out = reinterpret_cast<Bytef*>(to.data());
      stream_.avail_out = some;
      const int result = inflate(&stream_, Z_NO_FLUSH);
      const std::size_t made = some - stream_.avail_out;
      position_ += made;
      to = to.subspan(made);
      if (result == Z_STREAM_END)
        member_ended_ = true;
      else if (result != Z_OK && result != Z_BUF_ERROR)
        refuse_damage();
    }
  }

  // The checksum stands behind the last byte: inflated until it is compared, or something else follows.
  void check_end() {
    while (!member_ended_ && refill()) {
      char beyond = 0;
      stream_.next_out = reinterpret_cast<Bytef*>(&beyond);
      stream_.avail_out = 1;
      const int result = inflate(&stream_, Z_NO_FLUSH);
      if (result == Z_STREAM_END) member_ended_ = true;
      if (stream_.avail_out == 0) {  // more than the head promises: none of ours
        position_ = end_ + 1;        // the next read begins anew
        return;
      }
      if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR) refuse_damage();
    }
    if (!member_ended_) refuse_end();
  }

  OpenFile file_;
  std::uint64_t first_, skip_, end_;
  std::vector<char> input_;
  z_stream stream_;
  std::uint64_t from_ = 0, position_ = 0;  // bytes taken from the file; inflated bytes given
  bool member_ended_ = false;
};

class JoinedBytes : public ByteSource {
 public:
  JoinedBytes(std::vector<DataFile> files, std::uint64_t each) : files_(std::move(files)), each_(each) {}
  void read(std::uint64_t at, std::span<char> to) override {
    while (!to.empty()) {
      const std::size_t part = static_cast<std::size_t>(at / each_);
      if (part >= files_.size()) throw Error(Exit::internal, files_.back().path.string(), "is read beyond its end");
      if (!open_ || part != part_) {
        open_.reset();
        if (files_[part].deflated)
          open_ = std::make_unique<InflatedBytes>(files_[part], each_);
        else
          open_ = std::make_unique<PlainBytes>(files_[part]);
        part_ = part;
      }
      const auto some = static_cast<std::size_t>(std::min<std::uint64_t>(to.size(), each_ - at % each_));
      open_->read(at % each_, to.first(some));
      to = to.subspan(some);
      at += some;
    }
  }

 private:
  std::vector<DataFile> files_;
  std::uint64_t each_;
  std::unique_ptr<ByteSource> open_;
  std::size_t part_ = 0;
};

}  // namespace

std::uint64_t length_of_file(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0)
    throw Error(Exit::no_input, path.string(), std::strerror(errno), "check the path and its permissions");
  if (!S_ISREG(status.st_mode)) refuse_volume(path.string(), "is no plain file", "name a file");
  return static_cast<std::uint64_t>(status.st_size);
}

std::unique_ptr<ByteSource> bytes_of_files(std::vector<DataFile> files, std::uint64_t each) {
  for (const DataFile& data : files) {
    const std::uint64_t length = length_of_file(data.path), own = length > data.first ? length - data.first : 0;
    const std::uint64_t holds = data.deflated ? std::min(own, std::uint64_t{1} << 50) * most_inflated_by : own;
    if (holds < data.skip || holds - data.skip < each)
      refuse_volume(data.path.string(), "has " + std::to_string(own) + (data.deflated ? " deflated" : "") +
                                            " bytes of data where " + std::to_string(each) + " are promised" +
                                            (data.deflated ? ", more than they can hold" : ": truncated"));
  }
  return std::make_unique<JoinedBytes>(std::move(files), each);
}

std::string beginning_of_file(const std::filesystem::path& path, std::size_t most) {
  const OpenFile file(path);
  std::string bytes(most, '\0');
  std::size_t got = 0;
  while (got < most) {
    const std::size_t more = file.read_some(got, std::span(bytes).subspan(got));
    if (more == 0) break;
    got += more;
  }
  bytes.resize(got);
  return bytes;
}

std::string beginning_inflated(std::string_view deflated, std::size_t most) {
  if (!deflated.starts_with("\x1f\x8b")) return {};
  z_stream stream{};
  if (inflateInit2(&stream, either_head) != Z_OK) return {};
  std::string bytes(most, '\0');
  std::string input(deflated);
  stream.next_in = reinterpret_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(input.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(most);
  inflate(&stream, Z_SYNC_FLUSH);
  bytes.resize(most - stream.avail_out);
  inflateEnd(&stream);
  return bytes;
}

}  // namespace gonio::io
