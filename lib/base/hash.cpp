// SHA-256 (FIPS 180-4) by OpenSSL's EVP interface.
#include "base/hash.h"

#include <openssl/evp.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <compare>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "base/error.h"

namespace gonio {
namespace {

class Digest {
 public:
  Digest() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    require(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
  }
  void add(std::string_view bytes) { require(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1); }
  std::string hexadecimal() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> sum{};
    unsigned length = 0;
    require(EVP_DigestFinal_ex(context_.get(), sum.data(), &length) == 1);
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (unsigned i = 0; i < length; ++i) text += {digits[sum[i] >> 4], digits[sum[i] & 15]};
    return text;
  }

 private:
  static void require(bool worked) {
    if (!worked) throw Error(Exit::internal, "SHA-256", "the OpenSSL library refused to compute it");
  }
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

// One state of one file: whoever writes to it, or puts another in its place, makes another of it.
struct FileState {
  std::uint64_t device = 0, inode = 0, bytes = 0;
  std::int64_t changed_s = 0, changed_ns = 0;
  auto operator<=>(const FileState&) const = default;
};

// Nothing where the clock that changes are stamped by may not tell the next one from the last: a second after one.
std::optional<FileState> settled_state(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  if (const std::int64_t since = std::time(nullptr) - status.st_ctim.tv_sec; since < 2) return std::nullopt;
  return FileState{status.st_dev, status.st_ino, static_cast<std::uint64_t>(status.st_size), status.st_ctim.tv_sec,
                   status.st_ctim.tv_nsec};
}

// What was read once is not read again to be hashed: a program asks when it resolves a file, and for its provenance.
struct Known {
  std::mutex mutex;
  std::map<FileState, std::string> hashes;
};
Known& known() {
  static auto* const all = new Known;  // threads may outlive other statics
  return *all;
}

std::string hash_of_contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(Exit::no_input, path.string(), std::strerror(errno), "check the path and its permissions");
  Digest digest;
  std::array<char, 1 << 16> block{};
  while (file.read(block.data(), block.size()) || file.gcount() > 0)
    digest.add({block.data(), static_cast<std::size_t>(file.gcount())});
  if (file.bad()) throw Error(Exit::io, path.string(), "reading failed midway");
  return digest.hexadecimal();
}

}  // namespace

std::string sha256(std::string_view bytes) {
  Digest digest;
  digest.add(bytes);
  return digest.hexadecimal();
}

std::string sha256_of_file(const std::filesystem::path& path) {
  const std::optional<FileState> before = settled_state(path);
  Known& all = known();
  if (before) {
    const std::lock_guard lock(all.mutex);
    if (const auto found = all.hashes.find(*before); found != all.hashes.end()) return found->second;
  }
  std::string hash = hash_of_contents(path);
  if (before && settled_state(path) == before) {
    const std::lock_guard lock(all.mutex);
    all.hashes[*before] = hash;
  }
  return hash;
}

}  // namespace gonio
