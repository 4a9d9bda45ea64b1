// Files that appear whole or not at all, on POSIX calls.
//
// write_file() fills a nameless file (O_TMPFILE), which vanishes by itself however the program ends; it receives a name
// beside the target only when it is complete and on the disk, and rename() puts it in the target's place. Where the
// file system has no nameless files, a named temporary does the same, and the signal handlers remove it.
//
// Invariant: between `open` and `rename` every named temporary stands in `temporaries`, a fixed table that a signal
// handler may read (no allocation, no lock).
#include "base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "base/error.h"
#include "base/growing_file.h"
#include "base/temporaries.h"

namespace gonio {
namespace {

constexpr std::size_t longest_path = 4096;

struct Temporary {
  enum State : int { vacant, being_filled, live };
  std::atomic<int> state{vacant};
  std::array<char, longest_path> path{};
};
std::array<Temporary, 64> temporaries;
std::atomic<int> signals_seen{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

extern "C" void on_signal(int) {
  const int saved = errno;
  remove_temporaries();
  if (signals_seen.fetch_add(1) > 0) ::_exit(static_cast<int>(Exit::try_again));
  errno = saved;
}

// Enters a path into the table for as long as this object lives.
class Registered {
 public:
  explicit Registered(const std::string& path) {
    if (path.size() >= longest_path)
      throw Error(Exit::cannot_create, path, "the path is too long", "use a shorter one");
    for (auto& t : temporaries) {
      int expected = Temporary::vacant;
      if (!t.state.compare_exchange_strong(expected, Temporary::being_filled)) continue;
      std::memcpy(t.path.data(), path.c_str(), path.size() + 1);
      t.state = Temporary::live;
      slot_ = &t;
      return;
    }
    throw Error(Exit::internal, path, "too many files are being written at once");
  }
  ~Registered() {
    if (slot_->state.load() == Temporary::live) ::unlink(slot_->path.data());
    slot_->state = Temporary::vacant;
  }
  Registered(const Registered&) = delete;
  Registered& operator=(const Registered&) = delete;

 private:
  Temporary* slot_ = nullptr;
};

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  bool valid() const { return fd_ >= 0; }
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_;
};

bool full(int error) {
  return error == ENOSPC || error == EDQUOT || error == EFBIG;
}

[[noreturn]] void throw_write_error(const std::filesystem::path& path, int error) {
  throw_if_interrupted();
  if (full(error))
    throw Error(Exit::io, path.string(), "writing failed: " + std::string(std::strerror(error)),
                "free some space or choose another folder; nothing was left behind");
  throw Error(Exit::io, path.string(), "writing failed: " + std::string(std::strerror(error)));
}

[[noreturn]] void throw_create_error(const std::filesystem::path& path, int error) {
  if (full(error)) throw_write_error(path, error);
  throw Error(Exit::cannot_create, path.string(), "cannot be created: " + std::string(std::strerror(error)),
              error == ENOENT ? "create the folder first" : "choose a folder that you may write to");
}

void write_all(int fd, std::string_view bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const auto written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) {
      throw_if_interrupted();
      continue;
    }
    if (written < 0) throw_write_error(path, errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void flush(int fd, const std::filesystem::path& path) {
  while (::fsync(fd) != 0) {
    if (errno == EINVAL || errno == EROFS) return;  // not a kind of file that can be flushed
    if (errno != EINTR) throw_write_error(path, errno);
  }
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

// Where the bytes really go: symbolic links are followed, so that a link is not replaced by a file.
std::filesystem::path resolved(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_symlink(path, ignored)) return path;
  const auto target = std::filesystem::weakly_canonical(path, ignored);
  return target.empty() ? path : target;
}

// A device is anything that one can only write into: a pipe, a terminal, /dev/null.
enum class Kind { file, folder, device };

Kind kind_of(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || S_ISREG(status.st_mode)) return Kind::file;
  return S_ISDIR(status.st_mode) ? Kind::folder : Kind::device;
}

void refuse_folder(const std::filesystem::path& path) {
  throw Error(Exit::cannot_create, path.string(), "is a folder", "name a file");
}

void refuse_all_but_files(const std::filesystem::path& path, const std::filesystem::path& target) {
  const Kind kind = kind_of(target);
  if (kind == Kind::folder) refuse_folder(path);
  if (kind == Kind::device) throw Error(Exit::cannot_create, path.string(), "is not a plain file", "name a plain file");
}

void rename_into_place(const std::filesystem::path& temporary, const std::filesystem::path& target) {
  if (::rename(temporary.c_str(), target.c_str()) != 0) throw_write_error(target, errno);
  const Descriptor folder(::open(folder_of(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.valid()) flush(folder.get(), target);
}

void close_checked(Descriptor& file, const std::filesystem::path& target) {
  if (::close(file.release()) != 0 && errno != EINTR) throw_write_error(target, errno);
}

// True where the file system knows nameless files; then the target is in place.
bool write_nameless(const std::filesystem::path& target, std::string_view bytes) {
  Descriptor file(::open(folder_of(target).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666));
  if (!file.valid()) {
    if (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL) return false;
    throw_create_error(target, errno);
  }
  write_all(file.get(), bytes, target);
  flush(file.get(), target);
  const auto temporary = temporary_for(target);
  const Registered registered(temporary.string());
  const std::string name = "/proc/self/fd/" + std::to_string(file.get());
  if (::linkat(AT_FDCWD, name.c_str(), AT_FDCWD, temporary.c_str(), AT_SYMLINK_FOLLOW) != 0) {
    if (full(errno)) throw_write_error(target, errno);
    return false;  // no /proc here
  }
  close_checked(file, target);
  rename_into_place(temporary, target);
  return true;
}

void write_named(const std::filesystem::path& target, std::string_view bytes) {
  const auto temporary = temporary_for(target);
  const Registered registered(temporary.string());
  Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file.valid()) throw_create_error(target, errno);
  write_all(file.get(), bytes, target);
  flush(file.get(), target);
  close_checked(file, target);
  rename_into_place(temporary, target);
}

}  // namespace

std::filesystem::path temporary_for(const std::filesystem::path& target) {
  static std::atomic<unsigned> counter{0};
  const std::string stem = target.stem().string().substr(0, 160);
  const std::string unique = std::to_string(::getpid()) + "-" + std::to_string(counter++);
  return folder_of(target) / ("." + stem + "." + unique + target.extension().string());
}

void remove_temporaries() noexcept {
  for (auto& t : temporaries)
    if (t.state.load() == Temporary::live) ::unlink(t.path.data());
}

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  throw_if_interrupted();
  const auto target = resolved(path);
  const Kind kind = kind_of(target);
  if (kind == Kind::folder) refuse_folder(path);
  if (kind == Kind::device) {
    const Descriptor device(::open(target.c_str(), O_WRONLY | O_CLOEXEC));
    if (!device.valid()) throw_create_error(path, errno);
    return write_all(device.get(), bytes, path);
  }
  if (!write_nameless(target, bytes)) write_named(target, bytes);
}

void write_file_through(const std::filesystem::path& path,
                        const std::function<void(const std::filesystem::path& temporary)>& write) {
  throw_if_interrupted();
  const auto target = resolved(path);
  refuse_all_but_files(path, target);
  const auto temporary = temporary_for(target);
  const Registered registered(temporary.string());
  Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file.valid()) throw_create_error(path, errno);
  write(temporary);
  const Descriptor written(::open(temporary.c_str(), O_WRONLY | O_CLOEXEC));  // `write` may have replaced the file
  if (!written.valid()) throw_write_error(path, errno);
  flush(written.get(), path);
  rename_into_place(temporary, target);
}

struct GrowingFile::Temporary {
  explicit Temporary(const std::filesystem::path& where)
      : path(where),
        registered(where.string()),
        file(::open(where.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)) {}
  std::filesystem::path path;
  Registered registered;
  Descriptor file;
};

GrowingFile::GrowingFile(const std::filesystem::path& path) : path_(path), target_(resolved(path)) {
  throw_if_interrupted();
  refuse_all_but_files(path, target_);
  temporary_ = std::make_unique<Temporary>(temporary_for(target_));
  if (!temporary_->file.valid()) throw_create_error(path, errno);
}

GrowingFile::~GrowingFile() = default;

void GrowingFile::append(std::string_view bytes) {
  throw_if_interrupted();
  write_all(temporary_->file.get(), bytes, path_);
  size_ += bytes.size();
}

void GrowingFile::overwrite(std::uint64_t at, std::string_view bytes) {
  const int file = temporary_->file.get();
  if (::lseek(file, static_cast<off_t>(at), SEEK_SET) < 0) throw_write_error(path_, errno);
  write_all(file, bytes, path_);
  if (::lseek(file, 0, SEEK_END) < 0) throw_write_error(path_, errno);
}

void GrowingFile::commit() {
  flush(temporary_->file.get(), path_);
  close_checked(temporary_->file, path_);
  rename_into_place(temporary_->path, target_);
  temporary_.reset();
}

std::string read_file(const std::filesystem::path& path, std::uint64_t limit) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat status {};
  if (!file.valid() || ::fstat(file.get(), &status) != 0)
    throw Error(Exit::no_input, path.string(), std::strerror(errno), "check the path and its permissions");
  if (S_ISDIR(status.st_mode)) throw Error(Exit::no_input, path.string(), "is a folder", "name a file");
  const auto refuse_size = [&] {
    throw Error(Exit::data, path.string(), "is longer than the limit of " + std::to_string(limit) + " bytes");
  };
  std::string bytes;
  if (S_ISREG(status.st_mode)) {
    if (static_cast<std::uint64_t>(status.st_size) > limit) refuse_size();
    bytes.reserve(static_cast<std::size_t>(status.st_size));
  }
  std::array<char, 1 << 16> block{};
  while (true) {
    const auto got = ::read(file.get(), block.data(), block.size());
    if (got == 0) return bytes;
    if (got < 0 && errno == EINTR) {
      throw_if_interrupted();
      continue;
    }
    if (got < 0) throw Error(Exit::io, path.string(), "reading failed: " + std::string(std::strerror(errno)));
    bytes.append(block.data(), static_cast<std::size_t>(got));
    if (bytes.size() > limit) refuse_size();
  }
}

void check_writable(const std::filesystem::path& path) {
  const auto target = resolved(path);
  const Kind kind = kind_of(target);
  if (kind == Kind::folder) refuse_folder(path);
  const int failed =
      kind == Kind::device ? ::access(target.c_str(), W_OK) : ::access(folder_of(target).c_str(), W_OK | X_OK);
  if (failed != 0) throw_create_error(path, errno);
}

void make_folder(const std::filesystem::path& path) {
  std::error_code failure;
  std::filesystem::create_directories(path, failure);
  if (!failure && std::filesystem::is_directory(path)) return;
  const int error = failure ? failure.value() : ENOTDIR;
  if (error == ENOTDIR || error == EEXIST)
    throw Error(Exit::cannot_create, path.string(), "is not a folder", "choose another name");
  throw_create_error(path, error);
}

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    ::sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) ::sigaction(signal, &action, nullptr);  // under nohup, SIGHUP stays ignored
  }
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);  // a file-size limit surfaces as EFBIG
}

bool interrupted() {
  return signals_seen.load(std::memory_order_relaxed) > 0;
}

void throw_if_interrupted() {
  if (interrupted())
    throw Error(Exit::try_again, "", "interrupted by a signal", "nothing is half-written; run it again");
}

}  // namespace gonio
